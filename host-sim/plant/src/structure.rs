//! From table to tool point: what leans, drifts, bends or swings between them.

use nalgebra::Matrix3;

use model::effects::{Crosstalk, Resonance, Straightness};

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

/// What a step makes of a swing: exactly, for an acceleration that stays over the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwingStep {
    /// Columns: of the offset, of its rate, and of a force per mass that stays.
    columns: [[f64; 2]; 3],
    /// 2ζω, 1/s.
    drag: f64,
    half_s: f64,
}

impl SwingStep {
    /// Steps of one length.
    #[must_use]
    pub fn new(resonance: &Resonance, step_s: f64) -> Self {
        let omega = std::f64::consts::TAU * resonance.frequency_hz;
        let drag = 2.0 * resonance.damping_ratio * omega;
        let rates = Matrix3::new(0.0, 1.0, 0.0, -omega * omega, -drag, 1.0, 0.0, 0.0, 0.0);
        let whole = (rates * step_s).exp();
        Self {
            columns: [0, 1, 2].map(|cause| [whole[(0, cause)], whole[(1, cause)]]),
            drag,
            half_s: 0.5 * step_s,
        }
    }
}

impl Swing {
    /// One step under the table's acceleration (m/s²), at whose end the table has a velocity (m/s).
    ///
    /// With d = tool − table, ω²/(s² + 2ζωs + ω²) reads d″ + 2ζω·d′ + ω²·d = −(table″ + 2ζω·table′)
    /// when the damper stands on the ground; the damper of a structure stands on the table, and the
    /// transfer function is then met through the velocity, too.
    pub fn step(&mut self, step: &SwingStep, acceleration: f64, velocity: f64) {
        let force = -acceleration - step.drag * (velocity - step.half_s * acceleration);
        let [of_offset, of_rate, of_force] = step.columns;
        let end = |part: usize| {
            of_offset[part] * self.offset_m + of_rate[part] * self.rate + of_force[part] * force
        };
        (self.offset_m, self.rate) = (end(0), end(1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::Channel;

    /// Under an acceleration a that stays, d = −a/ω² less a swing of that size: in closed form, at any step, for the
    /// damper of the transfer function without damping.
    #[test]
    fn swings_about_where_the_acceleration_holds_it() {
        let resonance = Resonance { channel: Channel::Tool, frequency_hz: 300.0, damping_ratio: 0.0 };
        let omega = std::f64::consts::TAU * 300.0;
        for step_s in [2e-5, 1e-3, 7e-3] {
            let (step, mut swing) = (SwingStep::new(&resonance, step_s), Swing::default());
            for i in 1..50 {
                swing.step(&step, 2.0, f64::from(i) * step_s * 2.0);
                let expected = -2.0 / omega.powi(2) * (1.0 - (omega * step_s * f64::from(i)).cos());
                assert!((swing.offset_m - expected).abs() < 1e-15, "{step_s}: {} {expected}", swing.offset_m);
            }
        }
    }

    /// At a steady speed the tool is 2ζ/ω behind: the transfer function's slope at zero.
    #[test]
    fn damping_leaves_the_tool_behind() {
        for damping_ratio in [0.02, 0.7, 30.0] {
            let resonance = Resonance { channel: Channel::Tool, frequency_hz: 60.0, damping_ratio };
            let (step, mut swing) = (SwingStep::new(&resonance, 1e-3), Swing::default());
            (0..100_000).for_each(|_| swing.step(&step, 0.0, 0.1));
            let behind_m = 0.1 * 2.0 * damping_ratio / (std::f64::consts::TAU * 60.0);
            assert!((swing.offset_m / -behind_m - 1.0).abs() < 1e-9, "{damping_ratio}: {}", swing.offset_m);
        }
    }
}
