//! Errors of the measuring chain and of the loop, of the kind `sensors`: what the machine file cannot declare and no effect of the
//! textbook describes.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::chain_size::{Random, of_axis};
use super::draw::{Drawn, in_turn, one_of};
use super::machine::AXES;
use super::truth::Truth;

/// The errors. The number of a case determines the error, in this order.
pub const NAMES: [&str; 24] = [
    "feedback_late",
    "feedback_notch",
    "feedback_low_pass",
    "command_shifted",
    "probe_rotated",
    "probe_gain",
    "probe_mounting",
    "scale_gain",
    "scale_wave",
    "scale_growth",
    "hum_50hz",
    "force_gain",
    "drive_asymmetry",
    "timestamp_jitter",
    "dead_time",
    "loop_delay",
    "velocity_fresh",
    "two_drifts",
    "linear_drift",
    "two_modes",
    "stiffness_varies",
    "encoder_steps",
    "quant",
    "mode_on_table",
];

/// Errors that may come beside another one.
const SECOND: [&str; 7] = [
    "command_shifted",
    "probe_rotated",
    "scale_gain",
    "hum_50hz",
    "force_gain",
    "drive_asymmetry",
    "dead_time",
];
/// Probability of a second error.
const SECOND_PROBABILITY: f64 = 0.15;

/// The error of a case of the kind `sensors`: every 24th has the last one, and the others have those before it in turn, so that they are what they
/// were before it was added.
#[must_use]
pub fn of_case(number: u64) -> &'static str {
    let [others @ .., last] = &NAMES;
    if number.is_multiple_of(NAMES.len() as u64) { last } else { in_turn(others, number) }
}

/// Whether the machine file of a case with this error declares the true mechanical values.
#[must_use]
pub fn is_declared_truly(name: &str) -> bool {
    matches!(name, "encoder_steps" | "quant")
}

/// Draws an error, sometimes two, and sets them in the true values.
pub fn draw(name: &'static str, machine: &mut Drawn, random: &mut ChaCha8Rng) -> Vec<Truth> {
    let mut extras = set(name, machine, random);
    let second = one_of(&SECOND, random);
    // Errors of one sensor would hide each other.
    let sensor = |name: &str| name.split('_').next().map(str::to_owned);
    if random.random_bool(SECOND_PROBABILITY) && sensor(second) != sensor(name) {
        extras.extend(set(second, machine, random));
    }
    extras
}

/// Draws the size of an error and sets it: for both axes where they have it in common, otherwise for one of them or both.
fn set(name: &'static str, machine: &mut Drawn, random: &mut ChaCha8Rng) -> Vec<Truth> {
    let mut sizes = Random(random);
    let parameters = match name {
        "timestamp_jitter" => {
            machine.recorder.jitter_s = sizes.between(20e-6, 50e-6);
            Some(vec![("us", 1e6 * machine.recorder.jitter_s)])
        }
        "quant" => {
            machine.recorder.repeated = 0.01;
            machine.axes.iter_mut().for_each(|axis| super::chain_size::encoder_steps(axis, 1e-6));
            Some(vec![("percent", 1.0), ("step_um", 1.0)])
        }
        "command_shifted" => {
            let late = sizes.signed(0.2, 0.6);
            machine.axes.iter_mut().for_each(|axis| axis.recording.command_late = late);
            Some(vec![("samples", late)])
        }
        "probe_rotated" => Some(turn(machine, 0.0, &mut sizes)),
        "probe_mounting" => {
            let gain = sizes.signed(0.2e-3, 1e-3);
            Some(turn(machine, gain, &mut sizes))
        }
        _ => None,
    };
    if let Some(parameters) = parameters {
        return [0, 1].map(|index| extra(name, index, parameters.clone())).to_vec();
    }
    let first = random.random_range(0..AXES.len());
    let both = random.random_bool(0.5);
    let indices = [first, 1 - first];
    indices[..if both { 2 } else { 1 }]
        .iter()
        .map(|&index| extra(name, index, of_axis(name, &mut machine.axes[index], &mut Random(random))))
        .map(|truth| Truth { reference: (name == "mode_on_table").then_some(DAMPED_AGAINST_TABLE), ..truth })
        .collect()
}

/// Key of a mode whose damper is not against the ground, and its value.
const DAMPED_AGAINST_TABLE: (&str, &str) = ("damped_against", "table");

/// Turns the probe around a drawn centre.
fn turn(machine: &mut Drawn, gain: f64, sizes: &mut Random<'_>) -> Vec<(&'static str, f64)> {
    let turn_rad = sizes.signed(0.1e-3, 1e-3);
    for (axis, sign) in machine.axes.iter_mut().zip([1.0, -1.0]) {
        axis.recording.probe_turn_rad = sign * turn_rad;
        axis.recording.probe_centre_m = sizes.between(-0.02, 0.02);
        axis.recording.probe_gain = gain;
    }
    vec![("mrad", 1e3 * turn_rad), ("gain_percent", 100.0 * gain)]
}

fn extra(name: &'static str, index: usize, parameters: Vec<(&'static str, f64)>) -> Truth {
    Truth { name, axis: AXES[index], parameters, reference: None, phase_rad: 0.0 }
}
