//! The machine file's controller keys as settings of `shared`.

use shared::config::{AxisSettings, Law, Rates, Sensors};

use crate::machine::{Axis, Controller, Feedback, Machine};
use crate::plant::parameters::ServoParameters;

/// Following error at which the simulated controller gives up, m.
const FOLLOWING_ERROR_LIMIT_M: f64 = 0.2;

/// Force limit of an axis that declares none, N.
const UNLIMITED_N: f64 = 1e5;

/// Settings of the controller for an axis of a machine file, with the effects that sit in it.
///
/// # Errors
/// The key that the file lacks.
pub fn settings(axis: &Axis, effects: &ServoParameters) -> Result<AxisSettings, &'static str> {
    let law = match axis.controller.ok_or("controller")? {
        Controller::P => Law::P,
        Controller::Hpc => Law::Hpc,
    };
    let sensors = match axis.feedback {
        Feedback::Motor => Sensors::Motor,
        Feedback::Table => Sensors::Table,
        Feedback::Dual => Sensors::Dual {
            time_constant_s: axis.dual_feedback_time_constant_s.ok_or("dual_feedback_time_constant_s")?,
        },
    };
    let factor = effects.mismatch.factor();
    Ok(AxisSettings {
        law,
        position_gain_per_s: factor * axis.position_gain_per_s.ok_or("position_gain_per_s")?,
        // Velocity feed-forward passes the same gain: the lead is Kf over the true Kp.
        feedforward_percent: axis.feedforward_percent.unwrap_or(0.0),
        velocity_gain_n_s_per_m: axis.velocity_gain_n_s_per_m.ok_or("velocity_gain_n_s_per_m")?,
        velocity_integral_time_s: axis.velocity_integral_time_s,
        velocity_lag_s: 1e-3 * effects.lag.ms,
        force_limit_n: axis.force_limit_n.unwrap_or(UNLIMITED_N),
        sensors,
        following_error_limit_m: FOLLOWING_ERROR_LIMIT_M,
        // What only a scale that comes and goes needs.
        ..AxisSettings::default()
    })
}

/// Loop rates of a machine file.
#[must_use]
pub fn rates(machine: &Machine) -> Rates {
    let velocity_loop_hz = machine.velocity_rate_hz();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a validated whole multiple")]
    let position_loop_divider = (velocity_loop_hz / machine.sample_rate_hz).round() as u32;
    Rates { velocity_loop_hz, position_loop_divider }
}
