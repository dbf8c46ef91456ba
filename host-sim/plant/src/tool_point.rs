//! From table to tool point: offsets that depend on accelerations, positions and time, and a structural resonance.

use nalgebra::Matrix3;

use model::effects::{Crosstalk, Resonance, Straightness, ThermalDrift, Yaw};
use model::position_curve::PositionCurve;

use super::tool_parameters::ToolParameters;

/// The tables of all axes at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Tables<'a> {
    /// Axis names, in the order of the values.
    pub names: &'a [String],
    /// Positions, m.
    pub position_m: &'a [f64],
    /// Accelerations, m/s².
    pub acceleration: &'a [f64],
}

impl Tables<'_> {
    fn index(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }
}

/// What the probe reads less the table of one axis, m, without the modes of the tool, at a time of the session (s).
#[must_use]
pub fn offset_m(tool: &ToolParameters, axis: usize, tables: &Tables<'_>, time_s: f64) -> f64 {
    let other = (0..tables.names.len()).find(|&i| i != axis);
    let from = |name: &str, values: &[f64]| tables.index(name).map_or(0.0, |i| values[i]);
    let crosstalk = |c: &Crosstalk| c.offset_m(from(&c.source, tables.acceleration));
    let straightness = |s: &Straightness| s.offset_m(from(&s.source, tables.position_m));
    let map = |(source, curve): &(String, PositionCurve)| curve.value(from(source, tables.position_m));
    let yaw = |yaw: &Yaw| yaw.offset_m(tables.position_m[axis], from(&yaw.source, tables.position_m));
    tool.intalk.offset_m(tables.acceleration[axis])
        + tool.crosstalk.iter().map(crosstalk).sum::<f64>()
        + other.map_or(0.0, |i| tool.squareness.offset_m(tables.position_m[i]))
        + tool.straightness.iter().map(straightness).sum::<f64>()
        + tool.straightness_maps.iter().map(map).sum::<f64>()
        + tool.yaws.iter().map(yaw).sum::<f64>()
        + tool.drifts.iter().map(|drift: &ThermalDrift| drift.offset_m(time_s)).sum::<f64>()
        + tool.rate.offset_m(time_s)
        + tool.probe.gain.offset_m(tables.position_m[axis])
        + other.map_or(0.0, |i| tool.probe.rotation.offset_m(axis, tables.position_m[i]))
}

/// The modes in which the tool of one axis oscillates against its table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Modes {
    /// Each with its participation.
    modes: Vec<(f64, Oscillation, OscillationStep)>,
}

impl Modes {
    /// The modes at rest, with steps of a length (s).
    #[must_use]
    pub fn at_rest(resonances: &[Resonance], step_s: f64) -> Self {
        let mode = |resonance: &Resonance| {
            (resonance.participation, Oscillation::default(), OscillationStep::new(resonance, step_s))
        };
        Self { modes: resonances.iter().map(mode).collect() }
    }

    /// One step under the table's acceleration (m/s²), at whose end the table has a velocity (m/s).
    pub fn step(&mut self, acceleration: f64, velocity: f64) {
        for (_, oscillation, step) in &mut self.modes {
            oscillation.step(step, acceleration, velocity);
        }
    }

    /// Tool − table by all modes, m.
    #[must_use]
    pub fn offset_m(&self) -> f64 {
        self.modes.iter().map(|(participation, oscillation, _)| participation * oscillation.offset_m).sum()
    }

    /// Whether the tool is rigid.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.modes.is_empty()
    }
}

/// The oscillation of the tool of one axis against its table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Oscillation {
    /// Tool − table, m.
    pub offset_m: f64,
    /// m/s.
    rate: f64,
}

/// Steps of an [`Oscillation`], exact for an acceleration that is constant over the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OscillationStep {
    /// Offset and rate at the end per offset, per rate, and per constant force per mass.
    columns: [[f64; 2]; 3],
    /// Force of the damper per mass and per velocity of the table, 1/s: 2ζω where it acts against the ground, 0 against the table.
    ground_damping_per_s: f64,
    half_s: f64,
}

impl OscillationStep {
    /// Steps of a length (s) of a resonance.
    #[must_use]
    pub fn new(resonance: &Resonance, step_s: f64) -> Self {
        let omega = std::f64::consts::TAU * resonance.frequency_hz;
        let damping_per_s = 2.0 * resonance.damping_ratio * omega;
        let rates = Matrix3::new(0.0, 1.0, 0.0, -omega * omega, -damping_per_s, 1.0, 0.0, 0.0, 0.0);
        let exponential = (rates * step_s).exp();
        Self {
            columns: [0, 1, 2].map(|cause| [exponential[(0, cause)], exponential[(1, cause)]]),
            ground_damping_per_s: damping_per_s * (1.0 - resonance.damped_against.share_of_table()),
            half_s: 0.5 * step_s,
        }
    }
}

impl Oscillation {
    /// One step under the table's acceleration (m/s²), at whose end the table has a velocity (m/s).
    ///
    /// The tool follows the table by ω²/(s² + 2ζωs + ω²). With d = tool − table that is
    /// d'' + 2ζω·d' + ω²·d = −(table'' + 2ζω·table'). Of a damper that acts against the table, the last term is absent.
    pub fn step(&mut self, step: &OscillationStep, acceleration: f64, velocity: f64) {
        // The velocity in the middle of the step.
        let force = -acceleration - step.ground_damping_per_s * (velocity - step.half_s * acceleration);
        let [per_offset, per_rate, per_force] = step.columns;
        let end = |part: usize| {
            per_offset[part] * self.offset_m + per_rate[part] * self.rate + per_force[part] * force
        };
        (self.offset_m, self.rate) = (end(0), end(1));
    }
}

#[cfg(test)]
mod tests {
    use model::effects::DampedAgainst;
    use nalgebra::Complex;

    use super::*;

    /// Without damping and under a constant acceleration a, d = −a/ω²·(1 − cos ωt), at any step.
    #[test]
    fn oscillates_about_the_static_offset() {
        let resonance = Resonance::of_tool(300.0, 0.0);
        let omega = std::f64::consts::TAU * 300.0;
        for step_s in [2e-5, 1e-3, 7e-3] {
            let (step, mut tool) = (OscillationStep::new(&resonance, step_s), Oscillation::default());
            for i in 1..50 {
                tool.step(&step, 2.0, f64::from(i) * step_s * 2.0);
                let expected = -2.0 / omega.powi(2) * (1.0 - (omega * step_s * f64::from(i)).cos());
                assert!((tool.offset_m - expected).abs() < 1e-15, "{step_s}: {} {expected}", tool.offset_m);
            }
        }
    }

    /// Tool − table against (H − 1)·table of the damper of each kind, below, at and above the frequency of the mode.
    ///
    /// The acceleration of each step is its mean over the step, which reduces a sine of the angular frequency Ω by sinc², 1 − (Ω·h)²/12; its
    /// images at the rate of the steps are by (ω·h/2π)² smaller than that. Of the transient e^(−20) is left. The two kinds differ by 2ζω/Ω
    /// of what the damper of the table leaves.
    #[test]
    fn follows_the_transfer_function_of_its_damper() {
        let (step_s, frequency_hz, zeta) = (1e-4, 60.0, 0.1);
        let omega = std::f64::consts::TAU * frequency_hz;
        for (hz, against) in [20.0, 60.0, 180.0]
            .into_iter()
            .flat_map(|hz| [(hz, DampedAgainst::Ground), (hz, DampedAgainst::Table)])
        {
            let forced = std::f64::consts::TAU * hz;
            let resonance = Resonance { damped_against: against, ..Resonance::of_tool(frequency_hz, zeta) };
            let (step, mut tool) = (OscillationStep::new(&resonance, step_s), Oscillation::default());
            let velocity = |i: u32| forced * (forced * step_s * f64::from(i)).cos();
            let s = Complex::new(0.0, forced);
            let denominator = s * s + 2.0 * zeta * omega * s + omega * omega;
            let of_damper = 2.0 * zeta * omega * s * (1.0 - against.share_of_table());
            let expected = -(s * s + of_damper) / denominator;
            let other = -(s * s + 2.0 * zeta * omega * s - of_damper) / denominator;
            let bound = expected.norm() * 1.1 * ((forced * step_s).powi(2) / 12.0 + 1e-5);
            assert!((expected - other).norm() > 20.0 * bound, "{hz}: {expected} {other} {bound}");
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "some thousand steps"
            )]
            let settling = (20.0 / (zeta * omega * step_s)).round() as u32;
            for i in 1..=settling + 500 {
                tool.step(&step, (velocity(i) - velocity(i - 1)) / step_s, velocity(i));
                let at = (expected * Complex::cis(forced * step_s * f64::from(i))).im;
                assert!(
                    i < settling || (tool.offset_m - at).abs() < bound,
                    "{hz} {i}: {} {at}",
                    tool.offset_m
                );
            }
        }
    }

    /// A damper that acts against the table does not displace the tool at a steady speed.
    #[test]
    fn does_not_lag_at_a_steady_speed_where_it_is_damped_against_the_table() {
        let resonance = Resonance { damped_against: DampedAgainst::Table, ..Resonance::of_tool(60.0, 0.7) };
        let (step, mut tool) = (OscillationStep::new(&resonance, 1e-3), Oscillation::default());
        (0..1000).for_each(|_| tool.step(&step, 0.0, 0.1));
        assert!(tool.offset_m == 0.0, "{}", tool.offset_m);
    }

    /// At a steady speed the tool lags by 2ζ/ω: the slope of the transfer function at zero frequency.
    #[test]
    fn lags_by_its_damping_at_a_steady_speed() {
        for damping_ratio in [0.02, 0.7, 30.0] {
            let resonance = Resonance::of_tool(60.0, damping_ratio);
            let (step, mut tool) = (OscillationStep::new(&resonance, 1e-3), Oscillation::default());
            (0..100_000).for_each(|_| tool.step(&step, 0.0, 0.1));
            let lag_m = 0.1 * 2.0 * damping_ratio / (std::f64::consts::TAU * 60.0);
            assert!((tool.offset_m / -lag_m - 1.0).abs() < 1e-9, "{damping_ratio}: {}", tool.offset_m);
        }
    }
}
