//! The compensation settings of an axis in SI.

use core::f64::consts::TAU;

use heapless::Vec;
use serde::{Deserialize, Serialize};

pub use super::force_settings::{ForceModel, FrictionWarmUp, Stribeck, TableFriction};

/// Greatest number of points of a table.
pub const POINTS: usize = 64;

/// Greatest number of periodic tables of one compensation: two periods.
pub const CYCLES: usize = 2;

/// Greatest number of products of a compensation.
pub const PRODUCTS: usize = 3;

/// Greatest number of factors of a product.
pub const FACTORS: usize = 3;

/// Compensation of one axis. The default compensates nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CompensationSettings {
    /// Pitch error of screw or scale over the travel.
    pub pitch: Option<Pitch>,
    /// Backlash between screw and table: total width, m.
    pub backlash_width_m: Option<f64>,
    /// Periodic error of the screw over the commanded position, m: the table moves too far by the error. The lead and its
    /// harmonics are one table; a second one has another period (belt, gear).
    pub screw: Vec<Cycle, CYCLES>,
    /// Dividing (interpolation) error of the motor resolver, m of reading.
    pub dividing: Vec<Cycle, CYCLES>,
    /// Friction at reversal.
    pub reversal: Option<Reversal>,
    /// In-talk: tool − table per acceleration of the same axis.
    pub intalk: Option<Talk>,
    /// Cross-talk: tool − table per acceleration of another axis (counted from 0).
    pub crosstalk: Option<(u8, Talk)>,
    /// Squareness: displacement of the tool per position of another axis, m/m.
    pub squareness: Option<(u8, f64)>,
    /// Straightness: displacement of the tool as a function of the position of another axis.
    pub straightness: Option<(u8, Straightness)>,
    /// Force ripple of the motor, N.
    pub ripple: Vec<Cycle, CYCLES>,
    /// Force feed-forward from the commanded motion.
    pub force: Option<ForceModel>,
    /// Deflection of the drive between motor and table per force on the table, 1/stiffness, m/N; requires `force`.
    pub stretch_m_per_n: Option<f64>,
    /// Thermal drift: displacement of the tool, m, over the time since this setting.
    pub drift: Option<TimePoints>,
    /// Displacement of the tool by products of commanded quantities.
    pub products: Vec<Product, PRODUCTS>,
    /// Greatest correction of the command, and of the motor reading, m; at most 10 mm.
    pub position_bound_m: f64,
    /// Greatest rate of change of these corrections, m/s.
    pub position_rate_m_per_s: f64,
    /// Greatest added force, N.
    pub force_bound_n: f64,
    /// Greatest rate of change of the added force, N/s.
    pub force_rate_n_per_s: f64,
}

impl Default for CompensationSettings {
    fn default() -> Self {
        Self {
            pitch: None,
            backlash_width_m: None,
            screw: Vec::new(),
            dividing: Vec::new(),
            reversal: None,
            intalk: None,
            crosstalk: None,
            squareness: None,
            straightness: None,
            ripple: Vec::new(),
            force: None,
            stretch_m_per_n: None,
            drift: None,
            products: Vec::new(),
            position_bound_m: 1e-3,
            position_rate_m_per_s: 0.01,
            force_bound_n: 1000.0,
            force_rate_n_per_s: 1e5,
        }
    }
}

/// Evenly spaced values over a travel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Points {
    /// Position of the first value, m.
    pub start_m: f64,
    /// Distance between values, m.
    pub spacing_m: f64,
    /// The values; 2 to 64.
    pub values: Vec<f64, POINTS>,
}

/// Evenly spaced values over the time since the compensation was set. Linear between them; before the first and after the
/// last the value is kept. The clock of an axis starts at 0 whenever its compensation is replaced, and also runs while the
/// drives are off.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimePoints {
    /// Time of the first value, s; negative where the values began before the setting.
    pub start_s: f64,
    /// Time between values, s.
    pub spacing_s: f64,
    /// The values; 2 to 64.
    pub values: Vec<f64, POINTS>,
}

/// The source of a pitch error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PitchSource {
    /// The screw: the table moves too far by the error.
    Screw,
    /// The scale: it reads too much by the error.
    Scale,
}

/// Pitch error, m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pitch {
    /// Source of the error.
    pub of: PitchSource,
    /// Error for travel in the positive direction, or in both.
    pub forward: Points,
    /// Error for travel in the negative direction, if that differs.
    pub backward: Option<Points>,
}

/// Evenly spaced values over a period; the first at position zero.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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

/// A force pulse at each reversal: sign(v)·force·e^(−t/decay)·max(0, 1 − |v|/fade).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reversal {
    /// Force at the reversal, N.
    pub force_n: f64,
    /// Time constant of the decay, s.
    pub decay_s: f64,
    /// Speed at which the pulse is zero, m/s.
    pub fade_m_per_s: f64,
}

/// Displacement per acceleration, m/(m/s²).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "nothing to allocate a table from")]
pub enum Talk {
    /// Constant.
    Constant(f64),
    /// As a function of the position of the compensated axis.
    Over(Points),
}

/// Straightness of a guideway.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "nothing to allocate a table from")]
pub enum Straightness {
    /// Per squared position of the other axis, m/m².
    Quadratic(f64),
    /// As a function of the position of the other axis, m.
    Over(Points),
}

/// An error of the tool that is a product of commanded quantities: amplitude·∏(quantity/full scale), each of these parts from −1 to 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Product {
    /// Error at the full scale of all factors, m; below 16.7 mm in fixed point. The correction is limited by `position_bound_m`.
    pub amplitude_m: f64,
    /// The factors, 1 to 3; a square has one twice.
    pub factors: Vec<Factor, FACTORS>,
}

/// A factor of a product: a quantity of the commanded motion of an axis (counted from 0), with the value at which its part is 1.
/// Beyond its full scale the part keeps the value of 1 or −1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "axis: see above; full scale: the quantity in its unit")]
pub enum Factor {
    /// Position.
    Position { axis: u8, full_scale_m: f64 },
    /// Velocity.
    Velocity { axis: u8, full_scale_m_per_s: f64 },
    /// Absolute value of the velocity.
    Speed { axis: u8, full_scale_m_per_s: f64 },
    /// Acceleration.
    Acceleration { axis: u8, full_scale_m_per_s2: f64 },
    /// Direction of the last motion, −1 or 1.
    Direction { axis: u8 },
}

#[cfg(test)]
impl CompensationSettings {
    /// For tests of messages: every setting present, every table at its capacity, and numbers without a short form.
    pub(crate) fn longest() -> Self {
        let values = || (0..POINTS).map(|k| 1.0 / (3.0 + k as f64)).collect();
        let points = || Points { start_m: -0.1, spacing_m: 0.3, values: values() };
        let cycles = || [0.1, 0.3].map(|period_m| Cycle { period_m, values: values() }).into_iter().collect();
        let factor = Factor::Speed { axis: u8::MAX, full_scale_m_per_s: 0.1 };
        let product = Product { amplitude_m: 0.3, factors: [factor; FACTORS].into_iter().collect() };
        let stribeck = Some(Stribeck { excess_n: 0.1, velocity_m_per_s: 0.3 });
        Self {
            pitch: Some(Pitch { of: PitchSource::Scale, forward: points(), backward: Some(points()) }),
            backlash_width_m: Some(0.1),
            screw: cycles(),
            dividing: cycles(),
            reversal: Some(Reversal { force_n: 0.1, decay_s: 0.3, fade_m_per_s: 0.7 }),
            intalk: Some(Talk::Over(points())),
            crosstalk: Some((u8::MAX, Talk::Over(points()))),
            squareness: Some((u8::MAX, 0.1)),
            straightness: Some((u8::MAX, Straightness::Over(points()))),
            ripple: cycles(),
            force: Some(ForceModel {
                motor_stribeck: stribeck,
                friction: TableFriction {
                    presliding_stiffness_n_per_m: Some(0.1),
                    stribeck,
                    map: Some(points()),
                    warm_up: Some(FrictionWarmUp { force_n: 0.1, time_constant_s: 0.3 }),
                    ..TableFriction::default()
                },
                load: Some(points()),
                ..ForceModel::default()
            }),
            stretch_m_per_n: Some(0.1),
            drift: Some(TimePoints { start_s: 0.1, spacing_s: 0.3, values: values() }),
            products: core::array::from_fn::<_, PRODUCTS, _>(|_| product.clone()).into_iter().collect(),
            ..Self::default()
        }
    }
}
