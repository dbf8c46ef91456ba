//! A residual that no effect describes, as a law: a constant and a sum of terms.
//!
//! A law is an equation in measured variables. It says how a residual depends on the motion, and not what causes it.

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

use crate::effects::Stage;
use crate::residual_table::{TableChannel, TableVariable};

/// `[[axis.NAME.law]]`: a residual as a sum of terms.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResidualLaw {
    /// The channel whose residual it describes.
    pub channel: TableChannel,
    /// Added to the terms; µm, or N for the force.
    #[serde(default)]
    pub constant: f64,
    /// The terms.
    pub term: Vec<Term>,
}

/// A position over which a residual may have a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WavePosition {
    /// Position of the axis.
    PositionMm,
    /// Position of the first other axis of the machine.
    OtherPositionMm,
}

impl WavePosition {
    /// The position as a variable.
    #[must_use]
    pub const fn variable(self) -> TableVariable {
        match self {
            Self::PositionMm => TableVariable::PositionMm,
            Self::OtherPositionMm => TableVariable::OtherPositionMm,
        }
    }
}

/// One term of a law; coefficients in µm, or in N for the force, per unit of the variables.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Term {
    /// A coefficient times the product of variables, each in its unit.
    Product {
        /// The variables; a power contains one several times.
        of: Vec<TableVariable>,
        /// The coefficient.
        coefficient: f64,
    },
    /// A wave over a position: cosine·cos(2π·position/period) + sine·sin(2π·position/period).
    Wave {
        /// The position.
        over: WavePosition,
        /// The period, mm.
        period_mm: f64,
        /// Amplitude of the cosine.
        cosine: f64,
        /// Amplitude of the sine.
        sine: f64,
    },
    /// A coefficient times the direction of motion, which decays from each reversal on: exp(−travel since the reversal/distance).
    /// Zero before the first reversal.
    Reversal {
        /// Travel in which it decays to 1/e, mm.
        distance_mm: f64,
        /// The coefficient.
        coefficient: f64,
    },
}

/// What the terms of a law depend on, at one instant.
pub trait Variables {
    /// The value of a variable in its unit.
    fn value(&self, variable: TableVariable) -> f64;
    /// Travel and direction since the last reversal.
    fn since_reversal(&self) -> SinceReversal;
}

/// Travel and direction of an axis since its last reversal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SinceReversal {
    /// Direction, −1 or 1; 0 before the first motion.
    direction: f64,
    /// Position of the last reversal, mm; `None` before the first one.
    reversal_mm: Option<f64>,
    /// Position now, mm.
    position_mm: f64,
}

impl SinceReversal {
    /// Moves the axis to a position, where it has a velocity.
    pub fn advance(&mut self, position_mm: f64, velocity_m_per_s: f64) {
        let direction = TableVariable::direction(velocity_m_per_s);
        if direction * self.direction < 0.0 {
            self.reversal_mm = Some(position_mm);
        }
        if direction != 0.0 {
            self.direction = direction;
        }
        self.position_mm = position_mm;
    }

    /// The direction, decayed over a distance.
    #[must_use]
    pub fn decayed(&self, distance_mm: f64) -> f64 {
        let decay = |reversal_mm: f64| libm::exp(-(self.position_mm - reversal_mm).abs() / distance_mm);
        self.reversal_mm.map_or(0.0, |reversal_mm| self.direction * decay(reversal_mm))
    }
}

impl Term {
    /// The parts of which the term is a linear combination: one, or cosine and sine of a wave.
    pub fn parts(&self, at: &impl Variables) -> [f64; 2] {
        match self {
            Self::Product { of, .. } => [of.iter().map(|variable| at.value(*variable)).product(), 0.0],
            Self::Wave { over, period_mm, .. } => {
                let phase = TAU * at.value(over.variable()) / period_mm;
                [libm::cos(phase), libm::sin(phase)]
            }
            Self::Reversal { distance_mm, .. } => [at.since_reversal().decayed(*distance_mm), 0.0],
        }
    }

    /// The coefficients of [`Self::parts`]; the second one is zero if the term has one part.
    #[must_use]
    pub const fn coefficients(&self) -> [f64; 2] {
        match *self {
            Self::Product { coefficient, .. } | Self::Reversal { coefficient, .. } => [coefficient, 0.0],
            Self::Wave { cosine, sine, .. } => [cosine, sine],
        }
    }

    /// This term with other coefficients.
    #[must_use]
    pub fn with(&self, [first, second]: [f64; 2]) -> Self {
        let mut term = self.clone();
        match &mut term {
            Self::Product { coefficient, .. } | Self::Reversal { coefficient, .. } => *coefficient = first,
            Self::Wave { cosine, sine, .. } => [*cosine, *sine] = [first, second],
        }
        term
    }

    /// Whether it jumps at a reversal.
    #[must_use]
    pub fn has_jumps(&self) -> bool {
        let jumps = |one: &TableVariable| matches!(one, TableVariable::Direction | TableVariable::OtherDirection);
        self.variables().iter().any(jumps)
    }

    /// The variables on which it depends.
    #[must_use]
    pub fn variables(&self) -> Vec<TableVariable> {
        match self {
            Self::Product { of, .. } => of.clone(),
            Self::Wave { over, .. } => vec![over.variable()],
            Self::Reversal { .. } => vec![TableVariable::Direction],
        }
    }
}

impl ResidualLaw {
    /// The stage whose residual it describes.
    #[must_use]
    pub const fn stage(&self) -> Stage {
        self.channel.stage()
    }

    /// Measured − modelled value, µm or N.
    pub fn value(&self, at: &impl Variables) -> f64 {
        let of_term = |term: &Term| {
            let ([a, b], [x, y]) = (term.coefficients(), term.parts(at));
            a * x + b * y
        };
        self.constant + self.term.iter().map(of_term).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct At(SinceReversal);

    impl Variables for At {
        fn value(&self, variable: TableVariable) -> f64 {
            match variable {
                TableVariable::PositionMm => 3.0,
                TableVariable::OtherPositionMm => -4.0,
                _ => 7.0,
            }
        }
        fn since_reversal(&self) -> SinceReversal {
            self.0
        }
    }

    #[test]
    fn a_law_is_the_sum_of_its_terms() {
        let mut reversed = SinceReversal::default();
        // 2 mm on after a reversal.
        [(1.0, 0.1), (5.0, -0.1), (3.0, -0.1)].iter().for_each(|(mm, v)| reversed.advance(*mm, *v));
        let law: ResidualLaw = toml::from_str(
            r#"channel = "tool"
            constant = 0.25
            [[term]]
            kind = "product"
            of = ["position_mm", "other_position_mm"]
            coefficient = 0.5
            [[term]]
            kind = "wave"
            over = "position_mm"
            period_mm = 12.0
            cosine = 9.0
            sine = 2.0
            [[term]]
            kind = "reversal"
            distance_mm = 4.0
            coefficient = 3.0"#,
        )
        .unwrap();
        // −6 of the product; a quarter of a wave: its sine; the direction −1 decays by half a distance.
        let expected = 0.25 - 6.0 + 2.0 - 3.0 * libm::exp(-0.5);
        assert!((law.value(&At(reversed)) - expected).abs() < 1e-12);
        assert_eq!(law.stage(), Stage::Tool);
    }

    #[test]
    fn nothing_is_known_of_a_reversal_before_the_first_one() {
        let mut reversed = SinceReversal::default();
        // A standstill is no reversal, and a start in the same direction is none either.
        for (mm, velocity) in [(1.0, 0.1), (2.0, 0.0), (3.0, 0.1)] {
            reversed.advance(mm, velocity);
            assert!(reversed.decayed(1.0).abs() < 1e-12);
        }
        reversed.advance(3.0, -0.1);
        assert!((reversed.decayed(1.0) + 1.0).abs() < 1e-12);
    }
}
