//! The machine file's controller keys as settings of `shared`.

use shared::config::{AxisSettings, Law, LowPass, Notch, Rates, Sensors};
use shared::interpolate::Smoothing;

use crate::effects::{Effect, ServoMismatch, VelocityLag};
use crate::machine::{Axis, Controller, Feedback, Machine};

/// Following error at which the controller gives up where the machine file says nothing, m.
pub const FOLLOWING_ERROR_LIMIT_M: f64 = 0.13;

/// Force limit of an axis that declares none, N.
const UNLIMITED_N: f64 = 1e5;

/// Effects that sit in the controller.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ServoParameters {
    /// Of Kp.
    pub mismatch: ServoMismatch,
    /// Of the velocity reading.
    pub lag: VelocityLag,
    /// How much later than the sensors are read the force acts, s; negative: the reading is that of a later instant.
    pub drive_late_s: f64,
    /// Length of the semi-implicit steps that the controller takes its filter in, s; 0: it steps exactly.
    pub filter_step_s: f64,
}

impl ServoParameters {
    /// The effects of an axis that sit in its controller.
    #[must_use]
    pub fn of(axis: &Axis) -> Self {
        let mut parameters = Self::default();
        for effect in &axis.effect {
            match effect {
                Effect::ServoMismatch(mismatch) => parameters.mismatch = mismatch.clone(),
                Effect::VelocityLag(lag) => parameters.lag = lag.clone(),
                _ => {}
            }
        }
        parameters
    }
}

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
    let defaults = AxisSettings::default();
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
        smoothing: smoothing(axis),
        notch: notch(axis),
        low_pass: low_pass(axis),
        following_error_limit_m: axis
            .following_error_limit_mm
            .map_or(FOLLOWING_ERROR_LIMIT_M, |mm| 1e-3 * mm),
        scale_disagreement_limit_m: axis.scale_disagreement_limit_mm.map(|mm| 1e-3 * mm),
        fastest_m_per_s: axis.fastest_mm_per_s.map(|mm_per_s| 1e-3 * mm_per_s),
        frozen_encoder_limit_m: axis.frozen_encoder_limit_mm.map(|mm| 1e-3 * mm),
        saturation_time_s: axis.saturation_time_s.unwrap_or(defaults.saturation_time_s),
        travel_m: axis.travel_mm.map(|ends| ends.map(|mm| 1e-3 * mm)),
        stop_deceleration_m_per_s2: axis
            .stop_deceleration_m_per_s2
            .unwrap_or(defaults.stop_deceleration_m_per_s2),
        ..defaults
    })
}

/// The filter behind the path.
#[must_use]
pub fn smoothing(axis: &Axis) -> Smoothing {
    match (axis.smoothing_s, axis.smoothing_jerk_s, axis.smoothing_time_constant_s) {
        (_, _, Some(time_constant_s)) => Smoothing::Exponential { time_constant_s },
        (Some(time_s), Some(jerk_time_s), None) => Smoothing::SCurve { time_s, jerk_time_s },
        (Some(time_s), None, None) => Smoothing::Trapezoid { time_s },
        (None, _, None) => Smoothing::None,
    }
}

/// The notch on the force, if all of it is declared.
#[must_use]
pub fn notch(axis: &Axis) -> Option<Notch> {
    Some(Notch {
        frequency_hz: axis.notch_frequency_hz?,
        width_hz: axis.notch_width_hz?,
        depth: axis.notch_depth?,
    })
}

/// The low-pass on the force, if all of it is declared.
#[must_use]
pub fn low_pass(axis: &Axis) -> Option<LowPass> {
    Some(LowPass { frequency_hz: axis.low_pass_frequency_hz?, damping_ratio: axis.low_pass_damping_ratio? })
}

/// Loop rates of a machine file.
#[must_use]
pub fn rates(machine: &Machine) -> Rates {
    let velocity_loop_hz = machine.velocity_rate_hz();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a validated whole multiple")]
    let position_loop_divider = (velocity_loop_hz / machine.sample_rate_hz).round() as u32;
    Rates { velocity_loop_hz, position_loop_divider }
}
