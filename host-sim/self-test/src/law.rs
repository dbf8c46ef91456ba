//! Laws of the tool that are drawn at random: errors that no effect of the catalogue describes.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::plant::State;

/// Speed within which the direction turns over, m/s.
const TURNING_M_PER_S: f64 = 5e-5;

/// A form of a term, of the table's motion on its own axis and on the other one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// Position times other position.
    OwnTimesOther,
    /// Absolute value of the velocity.
    Speed,
    /// Position times direction.
    OwnTimesDirection,
    /// Position squared times direction.
    VelocitySquared,
    /// Other position cubed.
    OtherCubed,
    /// Velocity times other position.
    VelocityTimesOther,
    /// Acceleration times other position.
    AccelerationTimesOther,
    /// Direction of the other axis.
    OtherDirection,
    /// Velocity of the other axis.
    OtherVelocity,
    /// Direction times other position.
    DirectionTimesOther,
    /// Memory of the direction that a reversal turns over within a distance, m.
    Hysteresis(f64),
    /// Wave over the other position with a period (m) and a phase.
    OtherWave(f64, f64),
}

/// A term of a law: what it adds to the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawTerm {
    /// Its form.
    pub form: Form,
    /// Its factor, in m per SI unit of the form.
    pub factor: f64,
}

/// Memories of the direction of an axis, one for each term of its law.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Memories(Vec<f64>);

impl Memories {
    /// Follows the table by a step from a position, m.
    pub fn follow(&mut self, law: &[LawTerm], from_m: f64, to_m: f64) {
        self.0.resize(law.len(), 0.0);
        for (memory, term) in self.0.iter_mut().zip(law) {
            if let Form::Hysteresis(distance_m) = term.form {
                let moved_m = to_m - from_m;
                // A step is some µm, far below the distance.
                *memory += (moved_m - *memory * moved_m.abs()) / distance_m;
            }
        }
    }

    /// That of a term.
    fn of(&self, term: usize) -> f64 {
        self.0.get(term).copied().unwrap_or(0.0)
    }
}

/// What a law adds to the tool, m.
#[must_use]
pub fn displacement_m(law: &[LawTerm], own: &State, other: &State, memories: &Memories) -> f64 {
    law.iter().enumerate().map(|(index, term)| term.at(own, other, memories.of(index))).sum()
}

fn direction(m_per_s: f64) -> f64 {
    m_per_s / (m_per_s.abs() + TURNING_M_PER_S)
}

impl LawTerm {
    /// Its coefficients in the result of a trace, µm per unit of its variables (mm, m/s and m/s²): one, or those of cosine and sine of a wave.
    #[must_use]
    pub fn coefficients_um(&self) -> Vec<f64> {
        let um = 1e6 * self.factor;
        if let Form::OtherWave(_, phase) = self.form {
            return vec![um * libm::sin(phase), um * libm::cos(phase)];
        }
        if let Form::Hysteresis(_) = self.form {
            return vec![um];
        }
        let (_, of) = self.form.described();
        let positions = of.iter().filter(|name| name.ends_with("position_mm")).count();
        vec![(0..positions).fold(um, |um, _| 1e-3 * um)]
    }

    /// What the term adds to the tool, m.
    fn at(&self, own: &State, other: &State, memory: f64) -> f64 {
        self.factor
            * match self.form {
                Form::OwnTimesOther => own.table_m * other.table_m,
                Form::Speed => own.table_m_per_s.abs(),
                Form::OwnTimesDirection => own.table_m * direction(own.table_m_per_s),
                Form::VelocitySquared => own.table_m_per_s * own.table_m_per_s,
                Form::OtherCubed => other.table_m * other.table_m * other.table_m,
                Form::VelocityTimesOther => own.table_m_per_s * other.table_m,
                Form::AccelerationTimesOther => own.table_m_per_s2 * other.table_m,
                Form::OtherDirection => direction(other.table_m_per_s),
                Form::OtherVelocity => other.table_m_per_s,
                Form::DirectionTimesOther => direction(own.table_m_per_s) * other.table_m,
                Form::Hysteresis(_) => memory,
                Form::OtherWave(period_m, phase) => libm::sin(TAU * other.table_m / period_m + phase),
            }
    }
}

impl Form {
    /// Draws a form. The product of both positions is not among them: it is an effect of the catalogue, `yaw`.
    pub fn draw(random: &mut ChaCha8Rng) -> Self {
        let fixed = [
            Self::Speed,
            Self::OwnTimesDirection,
            Self::VelocitySquared,
            Self::OtherCubed,
            Self::VelocityTimesOther,
            Self::AccelerationTimesOther,
            Self::OtherDirection,
            Self::OtherVelocity,
            Self::DirectionTimesOther,
        ];
        match random.random_range(0..12) {
            0 => Self::draw(random),
            10 => Self::Hysteresis(1e-3 * random.random_range(1.0..20.0)),
            11 => Self::OtherWave(1e-3 * random.random_range(8.0..40.0), random.random_range(0.0..TAU)),
            index => fixed[index - 1],
        }
    }

    /// Kind and variables of the term in the result of a trace.
    #[must_use]
    pub fn described(&self) -> (&'static str, &'static [&'static str]) {
        match self {
            Self::OwnTimesOther => ("product", &["position_mm", "other_position_mm"]),
            Self::Speed => ("product", &["speed_m_per_s"]),
            Self::OwnTimesDirection => ("product", &["position_mm", "direction"]),
            Self::VelocitySquared => ("product", &["velocity_m_per_s", "velocity_m_per_s"]),
            Self::OtherCubed => ("product", &["other_position_mm", "other_position_mm", "other_position_mm"]),
            Self::VelocityTimesOther => ("product", &["velocity_m_per_s", "other_position_mm"]),
            Self::AccelerationTimesOther => ("product", &["acceleration_m_per_s2", "other_position_mm"]),
            Self::OtherDirection => ("product", &["other_direction"]),
            Self::OtherVelocity => ("product", &["other_velocity_m_per_s"]),
            Self::DirectionTimesOther => ("product", &["direction", "other_position_mm"]),
            Self::Hysteresis(_) => ("hysteresis", &["position_mm"]),
            Self::OtherWave(..) => ("wave", &["other_position_mm"]),
        }
    }

    /// Its period or distance, mm.
    #[must_use]
    pub fn length_mm(&self) -> Option<f64> {
        match self {
            Self::Hysteresis(m) | Self::OtherWave(m, _) => Some(1e3 * m),
            _ => None,
        }
    }
}
