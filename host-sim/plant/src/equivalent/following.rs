//! Axes that follow their commands exactly, in the place of stepper motors and of axes of which nothing is known.

use model::axis::{Drive, Feedback, Filters, Law, Mechanics, Settings};
use model::effects::{Channel, Effect, Latency};
use model::machine::{Axis, Machine};
use model::servo::ServoParameters;

use super::complete::is_complete;
use super::effects::equivalent_effects;

/// Greatest position gain, 1/s: the controller takes up to 2048 1/s in fixed point.
const MOST_GAIN_PER_S: f64 = 2000.0;

/// Gain of the velocity loop, N·s/m. It is a scale: 1 m/s in one tick is the greatest force of the controller.
const VELOCITY_GAIN_N_S_PER_M: f64 = 1e5;

/// The loops of all axes of a machine that follow their commands.
#[derive(Clone, Copy)]
pub(super) struct Pace {
    position_gain_per_s: f64,
    /// Whether all axes are late by the same time, which is then logged as none.
    is_common: bool,
}

impl Pace {
    /// Of a machine of which not all is known.
    pub fn of(machine: &Machine) -> Self {
        Self {
            position_gain_per_s: machine.sample_rate_hz.min(MOST_GAIN_PER_S),
            is_common: machine.axis.values().all(|axis| !is_complete(axis) && follows(axis)),
        }
    }
}

/// Whether an axis that is not complete follows its command: there is no loop, or none is known. A mass that is declared moves as a mass.
pub(super) fn follows(axis: &Axis) -> bool {
    let controller = &axis.settings.controller;
    let has_no_loop = controller.drive == Drive::Stepper || controller.position_gain_per_s.is_none();
    has_no_loop && !axis.settings.has_mass() && axis.settings.sensors.feedback == Feedback::Motor
}

/// The axis with a motor of infinite mass: see [`crate::following`].
///
/// With the position gain 1/T and without a feed-forward, the motor is one period T later exactly where its command is, also where that
/// turns or a compensation steps. Where all axes do so, the logged command is later by this lag, the inverse of the gain, and the log has
/// none. Beside other axes, it must not be late: with the whole feed-forward the motor is ahead by T/gain times the acceleration, 1 µm per
/// m/s² at 1 kHz.
pub(super) fn axis(axis: &Axis, pace: Pace) -> Axis {
    let Settings { names, mut controller, filters, limits, mechanics, sensors, .. } = axis.settings.clone();
    controller.drive = Drive::Torque;
    controller.law = Some(Law::P);
    controller.position_gain_per_s = Some(pace.position_gain_per_s);
    controller.feedforward_percent = Some(if pace.is_common { 0.0 } else { 100.0 });
    controller.feedforward_ahead_s = None;
    controller.velocity_gain_n_s_per_m = Some(VELOCITY_GAIN_N_S_PER_M);
    controller.velocity_integral_time_s = None;
    controller.force_limit_n = None;
    let mechanics =
        Mechanics { motor_mass_kg: Some(f64::INFINITY), lead_mm: mechanics.lead_mm, ..Mechanics::default() };
    // Filters of the force would be filters of the motion.
    let filters = Filters {
        smoothing_s: filters.smoothing_s,
        smoothing_jerk_s: filters.smoothing_jerk_s,
        smoothing_time_constant_s: filters.smoothing_time_constant_s,
        ..Filters::default()
    };
    let mut effect = equivalent_effects(axis);
    effect.retain(|effect| ServoParameters::of(std::slice::from_ref(effect)) == ServoParameters::default());
    if pace.is_common {
        let ms = 1e3 / pace.position_gain_per_s;
        effect.push(Effect::Latency(Latency { channel: Channel::Command, ms }));
    }
    let settings = Settings { names, controller, filters, limits, mechanics, sensors, ..Settings::default() };
    Axis {
        settings,
        effect,
        empirical: axis.empirical.clone(),
        residual_law: axis.residual_law.clone(),
        ..Axis::default()
    }
}
