//! The position loop of a control that commands the velocity of a drive: LinuxCNC's component pid, of which a P loop with velocity
//! feed-forward is a part.
//!
//! Once a sample, with the error e = command − feedback less its deadband (`pid.c` of LinuxCNC 2.9):
//!
//! ```text
//! output = bias + P·e + I·∫e·dt + D·de/dt + FF0·command + FF1·d(command)/dt + FF2·d²(command)/dt²
//! ```
//!
//! The derivatives are backward differences; the integral stops while the output is at its limit and the error would drive it further.

use model::axis::{Pid, Settings};
use model::servo::ServoParameters;

/// Gains and limits, SI.
#[derive(Clone, Copy, Debug)]
struct Terms {
    p: f64,
    i: f64,
    d: f64,
    feedforward: [f64; 3],
    bias: f64,
    deadband_m: f64,
    max_error_m: f64,
    max_integral_m_s: f64,
    max_derivative: f64,
    max_output: f64,
}

/// The loop with its state.
#[derive(Clone, Debug)]
pub struct PositionLoop {
    terms: Terms,
    sample_s: f64,
    command_m: f64,
    command_velocity: f64,
    error_m: f64,
    integral_m_s: f64,
    /// Direction in which the output is at its limit: −1, 0 or 1.
    at_limit: f64,
}

impl Terms {
    fn of(settings: &Settings, servo: &ServoParameters) -> Option<Self> {
        let (controller, pid) = (&settings.controller, &settings.pid);
        let ff1 = 0.01 * (controller.feedforward_percent.unwrap_or(0.0) + servo.feedforward.percent);
        // The velocity at a time ahead of the command is dx/dt + T·d²x/dt².
        let ff2 = pid.ff2_s.unwrap_or(0.0) + ff1 * controller.feedforward_ahead_s.unwrap_or(0.0);
        let Pid { bias_mm_per_s, deadband_um, .. } = *pid;
        let limit = |mm: Option<f64>| mm.map_or(f64::INFINITY, |mm| 1e-3 * mm);
        Some(Self {
            p: controller.position_gain_per_s? * servo.mismatch.factor(),
            i: pid.i_per_s2.unwrap_or(0.0),
            d: pid.d.unwrap_or(0.0),
            feedforward: [pid.ff0_per_s.unwrap_or(0.0), ff1, ff2],
            bias: 1e-3 * bias_mm_per_s.unwrap_or(0.0),
            deadband_m: 1e-6 * deadband_um.unwrap_or(0.0),
            max_error_m: limit(pid.max_error_mm),
            max_integral_m_s: limit(pid.max_error_i_mm_s),
            max_derivative: limit(pid.max_error_d_mm_per_s),
            max_output: limit(pid.max_output_mm_per_s),
        })
    }

    /// Command − feedback in steady motion, at a position (m) and velocity (m/s), and the integral of the error.
    fn steady(&self, position_m: f64, velocity: f64) -> [f64; 2] {
        let [ff0, ff1, _] = self.feedforward;
        let lacking = velocity - self.bias - ff0 * position_m - ff1 * velocity;
        if self.i > 0.0 { [0.0, lacking / self.i] } else { [lacking / self.p, 0.0] }
    }
}

impl PositionLoop {
    /// The loop in steady motion at the start of a command: at this position, m, with this velocity, m/s. `None` without a gain.
    #[must_use]
    pub fn following(
        settings: &Settings,
        servo: &ServoParameters,
        [position_m, velocity]: [f64; 2],
        sample_s: f64,
    ) -> Option<Self> {
        let terms = Terms::of(settings, servo)?;
        let [error_m, integral_m_s] = terms.steady(position_m, velocity);
        let command_m = position_m - velocity * sample_s;
        Some(Self {
            terms,
            sample_s,
            command_m,
            command_velocity: velocity,
            error_m,
            integral_m_s,
            at_limit: 0.0,
        })
    }

    /// Command − feedback of the steady motion with which the loop began, m.
    #[must_use]
    pub const fn lag_m(&self) -> f64 {
        self.error_m
    }

    /// The velocity command of a sample, m/s, from command and feedback, m.
    pub fn sample(&mut self, command_m: f64, feedback_m: f64) -> f64 {
        let Terms { p, i, d, feedforward: [ff0, ff1, ff2], bias, .. } = self.terms;
        let limited = |value: f64, limit: f64| value.clamp(-limit, limit);
        let raw_m = limited(command_m - feedback_m, self.terms.max_error_m);
        let error_m = raw_m - limited(raw_m, self.terms.deadband_m);
        if error_m * self.at_limit <= 0.0 {
            let integral_m_s = self.integral_m_s + error_m * self.sample_s;
            self.integral_m_s = limited(integral_m_s, self.terms.max_integral_m_s);
        }
        let derivative = limited((error_m - self.error_m) / self.sample_s, self.terms.max_derivative);
        let velocity = (command_m - self.command_m) / self.sample_s;
        let acceleration = (velocity - self.command_velocity) / self.sample_s;
        (self.error_m, self.command_m, self.command_velocity) = (error_m, command_m, velocity);
        let unlimited = p * error_m
            + ff1 * velocity
            + (bias + i * self.integral_m_s + d * derivative + ff0 * command_m + ff2 * acceleration);
        let output = limited(unlimited, self.terms.max_output);
        let is_limited = output.to_bits() != unlimited.to_bits();
        self.at_limit = if is_limited { output.signum() } else { 0.0 };
        output
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::machine::Machine;

    const SAMPLE_S: f64 = 1e-3;

    fn at_rest(keys: &str) -> PositionLoop {
        let text = format!(
            "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ndrive = \"velocity\"\nposition_gain_per_s = 50.0\n{keys}"
        );
        let machine = Machine::parse(&text, "m.toml").unwrap();
        let servo = ServoParameters::default();
        PositionLoop::following(&machine.axis["x"].settings, &servo, [0.0; 2], SAMPLE_S).unwrap()
    }

    /// Outputs, m/s, at a feedback of zero.
    fn outputs(keys: &str, commands_m: &[f64]) -> Vec<f64> {
        let mut position_loop = at_rest(keys);
        commands_m.iter().map(|&command_m| position_loop.sample(command_m, 0.0)).collect()
    }

    fn assert_near(found: &[f64], expected: &[f64]) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {expected:?}");
    }

    /// By hand, for the commands 1 mm, 1 mm, 3 mm with T = 1 ms.
    #[test]
    fn each_term_is_that_of_the_equation() {
        let commands_m = [1e-3, 1e-3, 3e-3];
        assert_near(&outputs("", &commands_m), &[0.05, 0.05, 0.15]);
        // ∫e·dt = 1, 2, 5 µm·s.
        assert_near(&outputs("pid_i_per_s2 = 1000.0\n", &commands_m), &[0.051, 0.052, 0.155]);
        // de/dt = 1, 0, 2 m/s.
        assert_near(&outputs("pid_d = 0.01\n", &commands_m), &[0.06, 0.05, 0.17]);
        assert_near(&outputs("pid_ff0_per_s = 2.0\n", &commands_m), &[0.052, 0.052, 0.156]);
        assert_near(&outputs("feedforward_percent = 50.0\n", &commands_m), &[0.55, 0.05, 1.15]);
        // d²x/dt² = 1000, −1000, 2000 m/s².
        assert_near(&outputs("pid_ff2_s = 1e-4\n", &commands_m), &[0.15, -0.05, 0.35]);
        assert_near(&outputs("pid_bias_mm_per_s = 3.0\n", &commands_m), &[0.053, 0.053, 0.153]);
    }

    /// A deadband of 500 µm leaves 0.5, 0.5 and 2.5 mm; with a largest error of 2 mm, 1.5 mm of the last.
    #[test]
    fn deadband_and_limits_change_the_error_and_the_output() {
        let commands_m = [1e-3, 1e-3, 3e-3];
        assert_near(&outputs("pid_deadband_um = 500.0\n", &commands_m), &[0.025, 0.025, 0.125]);
        let both = "pid_deadband_um = 500.0\npid_max_error_mm = 2.0\n";
        assert_near(&outputs(both, &commands_m), &[0.025, 0.025, 0.075]);
        assert_near(&outputs("pid_max_output_mm_per_s = 100.0\n", &commands_m), &[0.05, 0.05, 0.1]);
        let integral = "pid_i_per_s2 = 1000.0\npid_max_error_i_mm_s = 1.5e-3\n";
        assert_near(&outputs(integral, &commands_m), &[0.051, 0.0515, 0.1515]);
        let derivative = "pid_d = 0.01\npid_max_error_d_mm_per_s = 500.0\n";
        assert_near(&outputs(derivative, &commands_m), &[0.055, 0.05, 0.155]);
    }

    /// At its limit the output does not charge the integral: after a long error, the loop comes back at once.
    #[test]
    fn the_integral_stops_at_the_limit_of_the_output() {
        let keys = "pid_i_per_s2 = 1000.0\npid_max_output_mm_per_s = 60.0\n";
        let mut position_loop = at_rest(keys);
        for _ in 0..1000 {
            position_loop.sample(2e-3, 0.0);
        }
        // One sample of 2 µm·s was added before the limit was known: 2 mm/s of the output.
        let output = position_loop.sample(0.0, 0.0);
        assert!((output - 0.002).abs() < 1e-12, "{output}");
    }

    /// In steady motion the output is the velocity, with an integral part without any error.
    #[test]
    fn a_loop_in_steady_motion_goes_on() {
        for keys in ["feedforward_percent = 80.0\n", "pid_i_per_s2 = 500.0\npid_ff0_per_s = 0.5\n"] {
            let machine = format!(
                "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ndrive = \"velocity\"\nposition_gain_per_s = 50.0\n{keys}"
            );
            let machine = Machine::parse(&machine, "m.toml").unwrap();
            let settings = &machine.axis["x"].settings;
            let servo = ServoParameters::default();
            let mut position_loop = PositionLoop::following(settings, &servo, [0.02, 0.1], SAMPLE_S).unwrap();
            let output = position_loop.sample(0.02, 0.02 - position_loop.lag_m());
            // The integral grows by nothing, and FF0·x is in balance.
            assert!((output - 0.1).abs() < 1e-9, "{keys}: {output}");
        }
    }
}
