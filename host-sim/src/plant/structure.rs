//! From table to tool point: what leans, drifts, bends or swings between them.

use crate::effects::{Crosstalk, Resonance, Straightness};

use super::parameters::ToolParameters;

/// The tables of all axes at one moment: position (m) and acceleration (m/s²).
#[derive(Clone, Copy, Debug)]
pub struct Tables<'a> {
    /// Axis names.
    pub names: &'a [String],
    /// Positions.
    pub position_m: &'a [f64],
    /// Accelerations.
    pub acceleration: &'a [f64],
}

impl Tables<'_> {
    fn index(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }
}

/// Tool − table of one axis, m, without its resonance.
#[must_use]
pub fn offset_m(tool: &ToolParameters, axis: usize, tables: &Tables<'_>, time_s: f64) -> f64 {
    let other = (0..tables.names.len()).find(|&i| i != axis);
    let from = |name: &str, values: &[f64]| tables.index(name).map_or(0.0, |i| values[i]);
    let crosstalk = |c: &Crosstalk| c.offset_m(from(&c.source, tables.acceleration));
    let straightness = |s: &Straightness| s.offset_m(from(&s.source, tables.position_m));
    tool.intalk.offset_m(tables.acceleration[axis])
        + tool.crosstalk.iter().map(crosstalk).sum::<f64>()
        + other.map_or(0.0, |i| tool.squareness.offset_m(tables.position_m[i]))
        + tool.straightness.iter().map(straightness).sum::<f64>()
        + tool.drift.as_ref().map_or(0.0, |drift| drift.offset_m(time_s))
}

/// Tool of a machine whose structure swings: position − table (m) and its rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Swing {
    /// Tool − table.
    pub offset_m: f64,
    rate: f64,
}

impl Swing {
    /// One step under the table's acceleration (m/s²).
    ///
    /// With d = tool − table, ω²/(s² + 2ζωs + ω²) reads d″ + 2ζω·d′ + ω²·d = −(table″ + 2ζω·table′)
    /// when the damper stands on the ground; the damper of a structure stands on the table, and the
    /// transfer function is then met through the velocity (m/s), too.
    pub fn step(&mut self, resonance: &Resonance, acceleration: f64, velocity: f64, step_s: f64) {
        let omega = std::f64::consts::TAU * resonance.frequency_hz;
        let drag = 2.0 * resonance.damping_ratio * omega;
        let force = -acceleration - drag * velocity - drag * self.rate - omega * omega * self.offset_m;
        self.rate += force * step_s;
        self.offset_m += self.rate * step_s;
    }
}
