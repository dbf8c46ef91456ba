//! Sizes of the undeclared effects, and what each changes in the true values of an axis.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::draw::{Drawn, one_of};
use super::machine::{AXES, Axis};
use super::plant::{LocalDefect, Sinusoid};
use super::truth::{CONTROLLER, OUTSIDE, Truth, axis_index};

/// Draws the size of one of [`super::truth::NAMES`] on an axis. It is within about a factor of two of that in the blind
/// cases, if they contain the effect. The order of the draws determines the result of a seed.
pub fn draw(name: &'static str, index: usize, machine: &Drawn, random: &mut ChaCha8Rng) -> Truth {
    let declared = &machine.declared[index];
    let (lead_mm, pole_pairs) = (declared.lead_mm, f64::from(declared.pole_pairs));
    let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
    let phase_rad = random.random_range(0.0..TAU);
    let channel = one_of(&["table", "tool"], random);
    let order = f64::from(random.random_range(1..=6_u32));
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let parameters = match name {
        "backlash" => vec![("width_um", between(5.0, 20.0))],
        "pitch_progressive" => vec![("slope_um_per_m", sign * between(20.0, 100.0))],
        "pitch_cyclic" => vec![("amplitude_um", between(2.6, 10.0)), ("period_mm", lead_mm)],
        "resolver_dividing" => {
            vec![("amplitude_um", between(1.7, 6.8)), ("period_mm", lead_mm / pole_pairs)]
        }
        "windup" => vec![("stiffness_n_per_um", declared.stiffness_n_per_um * between(0.45, 0.72))],
        "stribeck" => {
            vec![("static_excess_n", between(53.0, 210.0)), ("velocity_mm_s", between(3.0, 12.0))]
        }
        "friction_asymmetry" => {
            // Friction must oppose motion in both directions.
            let most = 0.8 * machine.axes[index].mechanics.viscous_n_s_per_m;
            vec![("half_difference_n_s_per_m", sign * between(115.0, 460.0).min(most))]
        }
        "torque_ripple" => vec![("amplitude_n", between(26.0, 105.0)), ("period_mm", lead_mm / order)],
        "constant_load" => vec![("force_n", sign * between(95.0, 380.0))],
        "servo_mismatch" => vec![("percent", sign * between(2.8, 11.0))],
        "intalk" => vec![("um_s2_per_m", sign * between(1.0, 4.0))],
        "crosstalk" => vec![("um_s2_per_m", sign * between(0.7, 2.8))],
        "squareness" => vec![("um_per_m", sign * between(36.0, 144.0))],
        "straightness" => vec![("um_per_m2", sign * between(124.0, 494.0))],
        "thermal_drift" => {
            vec![("amplitude_um", sign * between(4.6, 18.0)), ("time_constant_s", between(15.0, 60.0))]
        }
        "latency" => vec![("ms", between(0.2, 2.0))],
        _ => vec![("frequency_hz", between(20.0, 80.0)), ("damping_ratio", between(0.03, 0.1))],
    };
    let reference = match name {
        "crosstalk" | "straightness" => Some(("source", AXES[1 - index])),
        "latency" => Some(("channel", channel)),
        "resonance" => Some(("channel", "tool")),
        _ => None,
    };
    Truth { name, axis: AXES[index], parameters, reference, phase_rad }
}

/// Draws one of [`CONTROLLER`] on an axis.
pub fn draw_controller(index: usize, random: &mut ChaCha8Rng) -> Truth {
    let name = one_of(&CONTROLLER, random);
    let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let parameters = match name {
        "feedforward_mismatch" => vec![("percent", sign * between(2.0, 20.0))],
        "velocity_gain_mismatch" => vec![("percent", sign * between(4.0, 15.0))],
        "integral_time_mismatch" => vec![("percent", sign * between(8.0, 35.0))],
        _ => vec![("ms", between(0.1, 0.8))],
    };
    Truth { name, axis: AXES[index], parameters, reference: None, phase_rad: 0.0 }
}

/// Sets an effect of the catalogue in the true values of its axis, which must not have it yet.
pub fn apply(truth: &Truth, axis: &mut Axis) {
    let values: Vec<f64> = truth.parameters.iter().map(|&(_, value)| value).collect();
    let Axis { mechanics, servo, .. } = axis;
    match (truth.name, values.as_slice()) {
        ("backlash", &[width]) => mechanics.backlash_m = 1e-6 * width,
        ("pitch_progressive", &[slope]) => mechanics.pitch_slope = 1e-6 * slope,
        ("pitch_cyclic", &[um, mm]) => mechanics.pitch = sinusoid_um(um, mm, truth.phase_rad),
        ("resolver_dividing", &[um, mm]) => axis.resolver = sinusoid_um(um, mm, truth.phase_rad),
        ("windup", &[stiffness]) => mechanics.stiffness_n_per_m = 1e6 * stiffness,
        ("stribeck", &[excess, speed]) => {
            mechanics.stribeck_n = excess;
            mechanics.stribeck_m_per_s = 1e-3 * speed;
        }
        ("friction_asymmetry", &[half]) => mechanics.asymmetry_n_s_per_m = half,
        ("torque_ripple", &[amplitude, mm]) => {
            mechanics.ripple = Sinusoid { amplitude, period: 1e-3 * mm, phase: truth.phase_rad };
        }
        ("constant_load", &[force]) => mechanics.load_n = force,
        ("servo_mismatch", &[percent]) => servo.position_gain_per_s *= 1.0 + 0.01 * percent,
        ("intalk", &[per_acceleration]) => axis.intalk_s2 = 1e-6 * per_acceleration,
        ("crosstalk", &[per_acceleration]) => axis.crosstalk_s2 = 1e-6 * per_acceleration,
        ("squareness", &[slope]) => axis.squareness = 1e-6 * slope,
        ("straightness", &[bow]) => axis.straightness_per_m = 1e-6 * bow,
        ("thermal_drift", &[um, time_s]) => {
            axis.drift_m = 1e-6 * um;
            axis.drift_s = time_s;
        }
        ("latency", &[ms]) => match truth.reference {
            Some((_, "table")) => axis.table_delay_s = 1e-3 * ms,
            _ => axis.tool_delay_s = 1e-3 * ms,
        },
        ("resonance", &[frequency_hz, zeta]) => axis.resonance = Some([TAU * frequency_hz, zeta]),
        ("feedforward_mismatch", &[points]) => servo.feedforward += 0.01 * points,
        ("velocity_gain_mismatch", &[percent]) => servo.velocity_gain_n_s_per_m *= 1.0 + 0.01 * percent,
        ("integral_time_mismatch", &[percent]) => servo.integral_s *= 1.0 + 0.01 * percent,
        ("drive_lag", &[ms]) => servo.lag_s = 1e-3 * ms,
        _ => {}
    }
}

/// The effect with another size, `strength` times as large in its consequence. It is proportional to the first parameter,
/// except that wind-up is proportional to the compliance beyond that of `stiffness_n_per_um`, and a resonance below its
/// frequency to 1/frequency².
#[must_use]
pub fn scaled(truth: &Truth, strength: f64, stiffness_n_per_um: f64) -> Truth {
    let mut scaled = truth.clone();
    if let Some((_, size)) = scaled.parameters.first_mut() {
        *size = match truth.name {
            "windup" => {
                1.0 / (1.0 / stiffness_n_per_um + strength * (1.0 / *size - 1.0 / stiffness_n_per_um))
            }
            "resonance" => *size / strength.sqrt(),
            _ => *size * strength,
        };
    }
    scaled
}

/// Largest stiffness of the kind `small`, as a fraction of the declared one: more than twice its tolerance below, which is
/// where a wrong declared value becomes a wind-up.
const SMALL_WINDUP: f64 = 0.75;
/// Highest frequency of a resonance of the kind `small`, Hz.
const SMALL_RESONANCE_HZ: f64 = 120.0;

/// The effect with a size of `strength` times that drawn, at least that by which it remains one: a wind-up beyond the
/// tolerance of the stiffness, a resonance well below half the sample rate.
#[must_use]
pub fn small(truth: &Truth, strength: f64, machine: &Drawn) -> Truth {
    let declared = machine.declared[axis_index(truth.axis)].stiffness_n_per_um;
    let mut small = scaled(truth, strength, declared);
    if let Some((_, size)) = small.parameters.first_mut() {
        match truth.name {
            "windup" => *size = size.min(SMALL_WINDUP * declared),
            "resonance" => *size = size.min(SMALL_RESONANCE_HZ),
            _ => {}
        }
    }
    small
}

/// Draws one of [`OUTSIDE`] and sets it in the true values.
pub fn draw_outside(machine: &mut Drawn, random: &mut ChaCha8Rng) -> Truth {
    let name = one_of(&OUTSIDE, random);
    let index = random.random_range(0..AXES.len());
    let axis = &mut machine.axes[index];
    let channel = one_of(&["table", "tool"], random);
    let phase_rad = random.random_range(0.0..TAU);
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let (channel, parameters) = if name == "vibration" {
        let (amplitude, frequency_hz) = (between(1.0, 3.0), between(40.0, 150.0));
        axis.vibration =
            Sinusoid { amplitude: 1e-6 * amplitude, period: 1.0 / frequency_hz, phase: phase_rad };
        ("tool", vec![("amplitude_um", amplitude), ("frequency_hz", frequency_hz)])
    } else {
        let (height, width, centre) = (between(2.0, 6.0), between(3.0, 15.0), between(-30.0, 30.0));
        let defect = LocalDefect { height_m: 1e-6 * height, centre_m: 1e-3 * centre, width_m: 1e-3 * width };
        match channel {
            "table" => axis.mechanics.screw_defect = defect,
            _ => axis.tool_defect = defect,
        }
        (channel, vec![("centre_mm", centre), ("width_mm", width), ("height_um", height)])
    };
    Truth { name, axis: AXES[index], parameters, reference: Some(("channel", channel)), phase_rad }
}

/// amplitude·sin(2πx/period + phase), from µm and mm.
pub(super) fn sinusoid_um(amplitude_um: f64, period_mm: f64, phase: f64) -> Sinusoid {
    Sinusoid { amplitude: 1e-6 * amplitude_um, period: 1e-3 * period_mm, phase }
}
