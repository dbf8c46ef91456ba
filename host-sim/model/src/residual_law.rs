//! A residual that no effect describes, as a law: a constant and a sum of terms.
//!
//! A law is an equation in measured variables. It says how a residual depends on the motion, and not what causes it.

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

use crate::effects::Stage;
use crate::residual_table::{TableChannel, TableVariable};
use files::format::significant;

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
    /// A coefficient times the [`Hysteresis`] of the position.
    Hysteresis {
        /// Travel after a reversal in which all but 1/e of the way to the other end is gone, mm.
        distance_mm: f64,
        /// The coefficient.
        coefficient: f64,
    },
}

/// What the terms of a law depend on, at one instant.
pub trait Variables {
    /// The value of a variable in its unit.
    fn value(&self, variable: TableVariable) -> f64;
}

/// A memory of the direction of travel: after a reversal it approaches the new direction, −1 or 1, by dz = (direction − z)·|dx|/distance
/// (Dahl, 1968). It neither jumps at a reversal nor changes at rest. Zero before the first motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hysteresis {
    value: f64,
    position_mm: Option<f64>,
}

impl Hysteresis {
    /// Moves the axis to a position; gives the value there.
    pub fn advance(&mut self, position_mm: f64, distance_mm: f64) -> f64 {
        let moved_mm = position_mm - self.position_mm.unwrap_or(position_mm);
        let direction = if moved_mm == 0.0 { 0.0 } else { moved_mm.signum() };
        self.value = direction + (self.value - direction) * libm::exp(-moved_mm.abs() / distance_mm);
        self.position_mm = Some(position_mm);
        self.value
    }
}

impl Term {
    /// The parts of which the term is a linear combination: one, or cosine and sine of a wave. `hysteresis` is that of this term.
    pub fn parts(&self, at: &impl Variables, hysteresis: &mut Hysteresis) -> [f64; 2] {
        match self {
            Self::Product { of, .. } => [of.iter().map(|variable| at.value(*variable)).product(), 0.0],
            Self::Wave { over, period_mm, .. } => {
                let phase = TAU * at.value(over.variable()) / period_mm;
                [libm::cos(phase), libm::sin(phase)]
            }
            Self::Hysteresis { distance_mm, .. } => {
                [hysteresis.advance(at.value(TableVariable::PositionMm), *distance_mm), 0.0]
            }
        }
    }

    /// Whether the form of the term is that of its cause to the noise of the logs: of positions, velocities, the force and the time. A direction turns over
    /// within some speed, a speed is rounded at a reversal, an acceleration is a filtered difference, and a hysteresis may have another curve.
    #[must_use]
    pub fn has_exact_form(&self) -> bool {
        let is_exact = |variable: &TableVariable| match variable {
            TableVariable::PositionMm
            | TableVariable::OtherPositionMm
            | TableVariable::VelocityMPerS
            | TableVariable::OtherVelocityMPerS
            | TableVariable::ForceN
            | TableVariable::TimeS => true,
            TableVariable::SpeedMPerS
            | TableVariable::Direction
            | TableVariable::OtherDirection
            | TableVariable::AccelerationMPerS2
            | TableVariable::OtherAccelerationMPerS2 => false,
        };
        match self {
            Self::Product { of, .. } => of.iter().all(is_exact),
            Self::Wave { .. } => true,
            Self::Hysteresis { .. } => false,
        }
    }

    /// The coefficients of [`Self::parts`]; the second one is zero if the term has one part.
    #[must_use]
    pub const fn coefficients(&self) -> [f64; 2] {
        match *self {
            Self::Product { coefficient, .. } | Self::Hysteresis { coefficient, .. } => [coefficient, 0.0],
            Self::Wave { cosine, sine, .. } => [cosine, sine],
        }
    }

    /// This term with other coefficients.
    #[must_use]
    pub fn with(&self, [first, second]: [f64; 2]) -> Self {
        let mut term = self.clone();
        match &mut term {
            Self::Product { coefficient, .. } | Self::Hysteresis { coefficient, .. } => *coefficient = first,
            Self::Wave { cosine, sine, .. } => [*cosine, *sine] = [first, second],
        }
        term
    }

    /// Its form, with the names of the axis and of the first other one: `x · v_y`.
    #[must_use]
    pub fn form(&self, own: &str, other: &str) -> String {
        let digits = if matches!(self, Self::Hysteresis { .. }) { 2 } else { 3 };
        let length = self.length_mm().map(|mm| significant(mm, digits));
        self.form_with_length(own, other, &length.unwrap_or_default())
    }

    /// Its form, with its period or distance as a text.
    #[must_use]
    pub fn form_with_length(&self, own: &str, other: &str, length: &str) -> String {
        match self {
            Self::Product { of, .. } => {
                of.iter().map(|variable| symbol(*variable, own, other)).collect::<Vec<_>>().join(" · ")
            }
            Self::Wave { over, .. } => {
                format!("wave over {} with a period of {length} mm", symbol(over.variable(), own, other))
            }
            Self::Hysteresis { .. } => format!("hysteresis of {own} over {length} mm"),
        }
    }

    /// The period of a wave or the distance of a hysteresis, mm.
    #[must_use]
    pub const fn length_mm(&self) -> Option<f64> {
        match *self {
            Self::Product { .. } => None,
            Self::Wave { period_mm: length_mm, .. } | Self::Hysteresis { distance_mm: length_mm, .. } => {
                Some(length_mm)
            }
        }
    }

    /// This term with another period or distance, mm; a product has none.
    #[must_use]
    pub fn with_length(&self, mm: f64) -> Self {
        let mut term = self.clone();
        match &mut term {
            Self::Product { .. } => {}
            Self::Hysteresis { distance_mm: length, .. } | Self::Wave { period_mm: length, .. } => {
                *length = mm;
            }
        }
        term
    }

    /// Whether it jumps at a reversal.
    #[must_use]
    pub fn has_jumps(&self) -> bool {
        let jumps =
            |one: &TableVariable| matches!(one, TableVariable::Direction | TableVariable::OtherDirection);
        self.variables().iter().any(jumps)
    }

    /// The variables on which it depends.
    #[must_use]
    pub fn variables(&self) -> Vec<TableVariable> {
        match self {
            Self::Product { of, .. } => of.clone(),
            Self::Wave { over, .. } => vec![over.variable()],
            Self::Hysteresis { .. } => vec![TableVariable::PositionMm],
        }
    }
}

fn symbol(variable: TableVariable, own: &str, other: &str) -> String {
    match variable {
        TableVariable::PositionMm => own.to_owned(),
        TableVariable::VelocityMPerS => format!("v_{own}"),
        TableVariable::SpeedMPerS => format!("|v_{own}|"),
        TableVariable::AccelerationMPerS2 => format!("a_{own}"),
        TableVariable::Direction => format!("sign(v_{own})"),
        TableVariable::ForceN => format!("F_{own}"),
        TableVariable::TimeS => "t".to_owned(),
        TableVariable::OtherPositionMm => other.to_owned(),
        TableVariable::OtherVelocityMPerS => format!("v_{other}"),
        TableVariable::OtherAccelerationMPerS2 => format!("a_{other}"),
        TableVariable::OtherDirection => format!("sign(v_{other})"),
    }
}

impl ResidualLaw {
    /// The stage whose residual it describes.
    #[must_use]
    pub const fn stage(&self) -> Stage {
        self.channel.stage()
    }

    /// Measured − modelled value, µm or N. `hystereses` are those of the terms.
    pub fn value(&self, at: &impl Variables, hystereses: &mut [Hysteresis]) -> f64 {
        let of_term = |(term, hysteresis): (&Term, &mut Hysteresis)| {
            let ([a, b], [x, y]) = (term.coefficients(), term.parts(at, hysteresis));
            a * x + b * y
        };
        self.constant + self.term.iter().zip(hystereses).map(of_term).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct At(f64);

    impl Variables for At {
        fn value(&self, variable: TableVariable) -> f64 {
            match variable {
                TableVariable::PositionMm => self.0,
                TableVariable::OtherPositionMm => -4.0,
                _ => 7.0,
            }
        }
    }

    #[test]
    fn a_law_is_the_sum_of_its_terms() {
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
            kind = "hysteresis"
            distance_mm = 4.0
            coefficient = 3.0"#,
        )
        .unwrap();
        let mut hystereses = [Hysteresis::default(); 3];
        for mm in [0.0, 1000.0, 5.0, 3.0] {
            law.value(&At(mm), &mut hystereses);
        }
        // At 3 mm, 997 mm after the reversal: −6 of the product; a quarter of a wave: its sine; all of the hysteresis.
        let value = law.value(&At(3.0), &mut hystereses);
        assert!((value - (0.25 - 6.0 + 2.0 - 3.0)).abs() < 1e-12, "{value}");
        assert_eq!(law.stage(), Stage::Tool);
    }

    #[test]
    fn a_hysteresis_approaches_the_direction_over_its_distance() {
        let mut hysteresis = Hysteresis::default();
        assert!(hysteresis.advance(7.0, 4.0).abs() < 1e-12);
        assert!((hysteresis.advance(407.0, 4.0) - 1.0).abs() < 1e-12);
        assert!((hysteresis.advance(407.0, 4.0) - 1.0).abs() < 1e-12);
        // Back by half a distance, in one step or in two: from 1 to −1 + 2·exp(−1/2).
        let mut steps = hysteresis;
        let there = -1.0 + 2.0 * libm::exp(-0.5);
        assert!((hysteresis.advance(405.0, 4.0) - there).abs() < 1e-12);
        steps.advance(406.3, 4.0);
        assert!((steps.advance(405.0, 4.0) - there).abs() < 1e-12);
    }
}
