//! What is compensated on an axis, in SI, as a person, a file or the tracer gives it.

use core::f64::consts::TAU;

use heapless::Vec;
use serde::{Deserialize, Serialize};

use super::table::POINTS;

/// Compensation of one axis. The default compensates nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CompensationSettings {
    /// Pitch error over the travel.
    pub pitch: Option<Pitch>,
    /// Dead zone between screw and table, total width, m.
    pub backlash_width_m: Option<f64>,
    /// Dividing error of the motor's resolver, m of reading.
    pub dividing: Option<Cycle>,
    /// Friction at reversal.
    pub reversal: Option<Reversal>,
    /// Tool less table, per own table acceleration.
    pub intalk: Option<Talk>,
    /// Tool less table, per another axis's.
    pub crosstalk: Option<(u8, Talk)>,
    /// Tool moves by so much per other axis's position, m/m.
    pub squareness: Option<(u8, f64)>,
    /// Tool moves by a function of another axis's position.
    pub straightness: Option<(u8, Straightness)>,
    /// Periodic force on the motor, N.
    pub ripple: Option<Cycle>,
    /// Greatest correction of the command, and of the motor reading, m.
    pub position_bound_m: f64,
    /// How fast they may change, m/s.
    pub position_rate_m_per_s: f64,
    /// Greatest added force, N.
    pub force_bound_n: f64,
    /// How fast it may change, N/s.
    pub force_rate_n_per_s: f64,
}

impl Default for CompensationSettings {
    fn default() -> Self {
        Self {
            pitch: None,
            backlash_width_m: None,
            dividing: None,
            reversal: None,
            intalk: None,
            crosstalk: None,
            squareness: None,
            straightness: None,
            ripple: None,
            position_bound_m: 1e-3,
            position_rate_m_per_s: 0.01,
            force_bound_n: 1000.0,
            force_rate_n_per_s: 1e5,
        }
    }
}

/// Evenly spaced values over a travel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Points {
    /// Where the first lies, m.
    pub start_m: f64,
    /// From one to the next, m.
    pub spacing_m: f64,
    /// The values; 2 to 64.
    pub values: Vec<f64, POINTS>,
}

/// What a pitch-error table belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Of {
    /// The screw moves the table by the error too far.
    Screw,
    /// The scale reads the error too much.
    Scale,
}

/// Pitch error, m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pitch {
    /// Whose.
    pub of: Of,
    /// While the axis travels in + direction, or in both.
    pub forward: Points,
    /// While it travels in − direction, where that differs.
    pub backward: Option<Points>,
}

/// Evenly spaced values over a period; the first at position zero.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// Length of the period, m.
    pub period_m: f64,
    /// The values; 2 to 64.
    pub values: Vec<f64, POINTS>,
}

impl Cycle {
    /// amplitude·sin(2π·x/period + phase) in 64 points.
    #[must_use]
    pub fn harmonic(amplitude: f64, period_m: f64, phase_rad: f64) -> Self {
        let value = |k: usize| amplitude * libm::sin(TAU * k as f64 / POINTS as f64 + phase_rad);
        Self { period_m, values: (0..POINTS).map(value).collect() }
    }
}

/// A force pulse at each reversal: sign(v)·force·e^(−t/decay)·(1 − |v|/fade), while that is positive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reversal {
    /// At the reversal itself, N.
    pub force_n: f64,
    /// Time constant of the decay, s.
    pub decay_s: f64,
    /// Speed at which nothing is left of it, m/s.
    pub fade_m_per_s: f64,
}

/// Coefficient of an acceleration, m·s²/m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "nothing to allocate a table from")]
pub enum Talk {
    /// The same everywhere.
    Constant(f64),
    /// Over the own position.
    Over(Points),
}

/// Shape of a guideway.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "nothing to allocate a table from")]
pub enum Straightness {
    /// So much per other position squared, m/m².
    Quadratic(f64),
    /// Over the other position, m.
    Over(Points),
}
