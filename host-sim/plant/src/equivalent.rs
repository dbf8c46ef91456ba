//! Axes of which masses or loops are not known, as axes that can be simulated.
//!
//! A drive whose velocity is commanded has the time constant τ = m/Kv and the friction F/m: its mass itself changes nothing, and any
//! large one serves. A stepper motor follows its command ([`following`]). What of a loop is not known is assumed, and said.

mod complete;
mod effects;
mod following;

use std::borrow::Cow;

use model::axis::{Drive, Law, Mechanics, Pid, Settings};
use model::effects::{Effect, VelocityLag};
use model::machine::nominal::LogOffsets;
use model::machine::{Axis, Machine};
use model::servo::VelocityDrive;

use complete::is_complete;
use effects::equivalent_effects;

/// Mass of the motor of an axis without masses, kg. That of the table is 1 kg: what it does to the motor is below 0.1 %.
pub const MOTOR_KG: f64 = 1000.0;

/// Time constant of a drive of which none is known, s: a bandwidth of 32 Hz.
const USUAL_TIME_CONSTANT_S: f64 = 5e-3;

/// Time constant of the velocity loop of an elastic axis, motor mass / velocity gain, s: three ticks of 4 kHz.
const OF_ELASTIC_S: f64 = 7.5e-4;

/// The controller that is simulated has a proportional gain and feed-forward.
const NO_PID: &str =
    "of its position loop, P and the feed-forward of the velocity are simulated, the keys pid_… are not";

/// A slower integral part does nothing during a motion.
const LEAST_INTEGRAL_PER_S: f64 = 0.1;

/// Ticks of the velocity loop per time constant, and the most per tick of the position loop.
const TICKS: (f64, f64) = (4.0, 8.0);

/// What the simulation of an axis assumes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assumed {
    /// Name of the axis.
    pub axis: String,
    /// What is not known, and what takes its place.
    pub what: &'static str,
}

impl Assumed {
    /// The sentence for a user.
    #[must_use]
    pub fn sentence(&self) -> String {
        format!("{}: {}.", self.axis, self.what)
    }
}

/// The velocity loop that an axis is simulated with.
struct Loop {
    position_gain_per_s: f64,
    feedforward_percent: f64,
    time_constant_s: f64,
    integral_time_s: Option<f64>,
    assumed: Option<&'static str>,
}

/// A loop for masses without gains, or on a scale. It follows its command, in steady motion without an error: its integral part removes the
/// lag of the velocity. With a feed-forward ahead of the command, it would follow a step of a compensation twice as far.
const FOLLOWING: Loop = Loop {
    position_gain_per_s: 50.0,
    feedforward_percent: 100.0,
    time_constant_s: 2.5e-4,
    integral_time_s: Some(0.02),
    assumed: None,
};

impl Loop {
    fn of(axis: &Axis) -> Self {
        let controller = &axis.settings.controller;
        if controller.drive == Drive::Stepper {
            return FOLLOWING;
        }
        let Some(position_gain_per_s) = controller.position_gain_per_s else {
            let what = "its position gain is not known; it is simulated as an axis that follows its command";
            // Above its resonance, a spring separates the table from the motor: the mass of the motor alone limits the velocity gain.
            let time_constant_s = match axis.settings.mechanics {
                Mechanics {
                    motor_mass_kg: Some(motor_kg),
                    table_mass_kg: Some(table_kg),
                    stiffness_n_per_um: Some(_),
                    ..
                } => OF_ELASTIC_S * (motor_kg + table_kg) / motor_kg,
                _ => FOLLOWING.time_constant_s,
            };
            return Self { assumed: Some(what), time_constant_s, ..FOLLOWING };
        };
        let is_velocity = controller.drive == Drive::Velocity;
        let fitted = if is_velocity { axis.fitted_velocity_drive() } else { VelocityDrive::default() };
        let is_fitted = fitted.time_constant_s > 0.0;
        let assumed = match (is_velocity, is_fitted) {
            (true, true) => None,
            (true, false) => {
                Some("the bandwidth of its drive is not known; a time constant of 5 ms is simulated")
            }
            (false, _) => {
                Some("masses or gains are not known; its velocity is simulated with a time constant of 5 ms")
            }
        };
        let integral_time_s =
            (fitted.integral_per_s > LEAST_INTEGRAL_PER_S).then(|| fitted.integral_per_s.recip());
        Self {
            position_gain_per_s,
            feedforward_percent: controller.feedforward_percent.unwrap_or(0.0),
            time_constant_s: if is_fitted { fitted.time_constant_s } else { USUAL_TIME_CONSTANT_S },
            integral_time_s: integral_time_s.or(controller.velocity_integral_time_s),
            assumed,
        }
    }
}

/// Whether a machine can be simulated as it is declared.
#[must_use]
pub fn is_known(machine: &Machine) -> bool {
    machine.structure.is_some() || machine.axis.values().all(is_complete)
}

/// The machine with a simulated loop and mass for each axis that lacks them, and what is assumed of it. A machine of which all is known
/// is returned as it is.
#[must_use]
pub fn of(machine: &Machine) -> (Cow<'_, Machine>, Vec<Assumed>) {
    if is_known(machine) {
        return (Cow::Borrowed(machine), Vec::new());
    }
    let mut equivalent = machine.clone();
    let mut assumed = Vec::new();
    let pace = following::Pace::of(machine);
    equivalent.velocity_loop_rate_hz = Some(velocity_loop_rate_hz(machine));
    let tick_s = 1.0 / equivalent.velocity_rate_hz();
    for (name, axis) in &mut equivalent.axis {
        if !is_complete(axis) {
            let simulated = Loop::of(axis);
            let further = (axis.settings.pid != Pid::default()).then_some(NO_PID);
            let what = simulated.assumed.into_iter().chain(further);
            assumed.extend(what.map(|what| Assumed { axis: name.clone(), what }));
            let follows = following::follows(axis);
            *axis =
                if follows { following::axis(axis, pace) } else { equivalent_axis(axis, &simulated, tick_s) };
        }
    }
    (Cow::Owned(equivalent), assumed)
}

/// The declared rate of the velocity loop, or one that resolves the time constants.
fn velocity_loop_rate_hz(machine: &Machine) -> f64 {
    let simulated = machine.axis.values().filter(|axis| !is_complete(axis)).map(Loop::of);
    let shortest_s = numerics::min(simulated.map(|simulated| simulated.time_constant_s));
    let steps = (TICKS.0 / (shortest_s * machine.sample_rate_hz)).ceil().clamp(1.0, TICKS.1);
    machine.velocity_loop_rate_hz.unwrap_or(steps * machine.sample_rate_hz)
}

/// An axis without a mass has the fitted drive as it was fitted, in continuous time: a velocity loop of the period T would read a velocity
/// that is T/2 old and hold its force for T, and with its integral part the axis would be ahead by T. Its reading is therefore later than a
/// difference of two readings by −T. The friction turns over with the travel, as in the fit.
fn equivalent_axis(axis: &Axis, simulated: &Loop, tick_s: f64) -> Axis {
    let Settings { names, mut controller, filters, limits, mechanics, sensors, .. } = axis.settings.clone();
    let mechanics = if axis.settings.has_mass() {
        mechanics
    } else {
        Mechanics { motor_mass_kg: Some(MOTOR_KG), lead_mm: mechanics.lead_mm, ..Mechanics::default() }
    };
    let mass_kg = mechanics.motor_mass_kg.unwrap_or(0.0) + mechanics.table_mass_kg.unwrap_or(0.0);
    controller.drive = Drive::Torque;
    controller.law = controller.law.or(Some(Law::P));
    controller.position_gain_per_s = Some(simulated.position_gain_per_s);
    controller.feedforward_percent = Some(simulated.feedforward_percent);
    controller.velocity_gain_n_s_per_m = Some(mass_kg / simulated.time_constant_s);
    controller.velocity_integral_time_s = simulated.integral_time_s;
    controller.force_limit_n = None;
    let settings = Settings { names, controller, filters, limits, mechanics, sensors, ..Settings::default() };
    let equivalent = Axis {
        settings,
        empirical: axis.empirical.clone(),
        residual_law: axis.residual_law.clone(),
        ..Axis::default()
    };
    if axis.settings.has_mass() {
        return Axis { effect: axis.effect.clone(), ..equivalent };
    }
    let mut effect = equivalent_effects(axis);
    if !effect.iter().any(|effect| matches!(effect, Effect::VelocityLag(_))) {
        effect.push(Effect::VelocityLag(VelocityLag { ms: -1e3 * tick_s }));
    }
    let velocity_friction_m_per_s2 = axis.log_offsets.and_then(|offsets| offsets.velocity_friction_m_per_s2);
    let log_offsets = Some(LogOffsets { velocity_friction_m_per_s2, ..LogOffsets::default() });
    Axis { effect, log_offsets, ..equivalent }
}

#[cfg(test)]
mod tests;
