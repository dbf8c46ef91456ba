//! The fastest velocity loop of an axis with given margins.
//!
//! Ti follows from Kv: with the crossover at ωc = Kv/m, the corner of the integral part lies at ωc/4, where it takes
//! atan(1/4) = 14° of phase.

use std::f64::consts::TAU;

use super::error::TuningError;
use super::measured::MeasuredAxis;
use crate::margins::axis_margins::AxisLoops;
use crate::margins::{MarginError, MarginLimits};
use model::axis::{Filters, Settings};
use model::machine::Machine;
use model::servo;
use plant::instruments::Instruments;
use shared::config::{NOTCHES, Notch};

/// Crossover over corner of the integral part.
const INTEGRAL_RATIO: f64 = 4.0;

/// Slowest crossover that is tried, rad/s.
const SLOWEST_RAD_PER_S: f64 = 10.0;

/// Ratio of two gains that are tried after each other.
const STEP: f64 = 1.05;

/// Greatest force of one count of the motor reading in one tick, as a fraction of the force limit: the noise of the reading is
/// amplified by Kv.
const MAX_FORCE_PER_COUNT: f64 = 0.01;

/// Width of a notch at the resonance of the model over its centre, and its depth.
const NOTCH: (f64, f64) = (0.5, 0.9);

/// The least factor by which each notch has to raise Kv to be proposed.
const MIN_GAIN_OF_NOTCH: f64 = 1.1;

/// The machine with the fastest velocity loop on each axis. A measured axis has the margins by the model and as measured.
///
/// # Errors
/// If the machine lacks a key, or no gain of an axis has the margins.
pub fn fastest(
    machine: &Machine,
    instruments: &Instruments,
    limits: MarginLimits,
    measured: &[MeasuredAxis],
) -> Result<Machine, TuningError> {
    let mut tuned = machine.clone();
    for index in 0..machine.axis.len() {
        let measured = measured.iter().find(|axis| axis.index == index);
        let usable = |settings: &Settings| -> Result<bool, MarginError> {
            let mut tried = machine.clone();
            tried.axis[index].settings = settings.clone();
            let loops = AxisLoops::of_machine(&tried, instruments)?.swap_remove(index);
            Ok(loops.velocity().meet(limits)
                && measured.is_none_or(|axis| axis.velocity(&loops).meets(limits)))
        };
        let settings = &machine.axis[index].settings;
        let highest_gain = highest_for_noise(settings, machine.rates().velocity_loop_hz, instruments);
        let mut best = highest(settings, highest_gain, &usable)?;
        let mut least = MIN_GAIN_OF_NOTCH * gain(best.as_ref());
        for filters in with_notches(settings, machine.rates().velocity_loop_hz, measured) {
            let notched = highest(&Settings { filters, ..settings.clone() }, highest_gain, &usable)?;
            if gain(notched.as_ref()) >= least {
                least = gain(notched.as_ref());
                best = notched;
            }
            // Each further notch has to raise the gain as much again: alone or together with the one before it.
            least *= MIN_GAIN_OF_NOTCH;
        }
        let axis = machine.axis.get_index(index).map_or("", |(name, _)| name).to_owned();
        tuned.axis[index].settings = best.ok_or(TuningError::NoVelocityLoop { axis })?;
    }
    Ok(tuned)
}

/// The settings with the highest gain up to which every loop is usable; `None`: the lowest is not.
fn highest(
    settings: &Settings,
    highest_gain: f64,
    usable: &impl Fn(&Settings) -> Result<bool, MarginError>,
) -> Result<Option<Settings>, MarginError> {
    let mass_kg = total_mass_kg(settings);
    let mut best = None;
    let mut gain = SLOWEST_RAD_PER_S * mass_kg;
    while gain <= highest_gain {
        let mut tried = settings.clone();
        tried.controller.velocity_gain_n_s_per_m = Some(gain);
        tried.controller.velocity_integral_time_s = Some(INTEGRAL_RATIO * mass_kg / gain);
        if !usable(&tried)? {
            break;
        }
        best = Some(tried);
        gain *= STEP;
    }
    Ok(best)
}

/// Motor and table, kg.
fn total_mass_kg(settings: &Settings) -> f64 {
    settings.mechanics.motor_mass_kg.unwrap_or(0.0) + settings.mechanics.table_mass_kg.unwrap_or(0.0)
}

/// Kv at which one count of the motor reading in one tick gives the force that is allowed for it; no bound without a force limit.
fn highest_for_noise(settings: &Settings, velocity_loop_hz: f64, instruments: &Instruments) -> f64 {
    let fastest = TAU * velocity_loop_hz * total_mass_kg(settings);
    let count_m_per_s = instruments.motor.resolution.max(instruments.motor.noise) * velocity_loop_hz;
    match settings.controller.force_limit_n {
        Some(limit_n) if count_m_per_s > 0.0 => fastest.min(MAX_FORCE_PER_COUNT * limit_n / count_m_per_s),
        _ => fastest,
    }
}

/// Kv of settings; 0 without it.
fn gain(settings: Option<&Settings>) -> f64 {
    settings.and_then(|settings| settings.controller.velocity_gain_n_s_per_m).unwrap_or(0.0)
}

/// The filters with one, two and more notches at the measured resonances, the highest first, else with one at that of motor against table;
/// without those that a declared notch has already, or that are beyond what the loop can filter, and with no more than an axis can have.
fn with_notches(settings: &Settings, velocity_loop_hz: f64, measured: Option<&MeasuredAxis>) -> Vec<Filters> {
    let mut found = measured.map_or(Vec::new(), |axis| axis.notches.clone());
    if found.is_empty() {
        found.extend(of_model(settings));
    }
    let mut notches: Vec<Notch> = servo::notches(&settings.filters).iter().copied().collect();
    let mut filters = Vec::new();
    for new in found {
        let is_covered =
            notches.iter().any(|notch| (notch.frequency_hz - new.frequency_hz).abs() <= 0.5 * notch.width_hz);
        if is_covered || new.frequency_hz >= 0.25 * velocity_loop_hz || notches.len() == NOTCHES {
            continue;
        }
        notches.push(new);
        filters.push(settings.filters.with_notches(&notches));
    }
    filters
}

/// A notch at the resonance of motor against table.
fn of_model(settings: &Settings) -> Option<Notch> {
    let mechanics = &settings.mechanics;
    let stiffness_n_per_m = 1e6 * mechanics.stiffness_n_per_um?;
    let (motor_kg, table_kg) = (mechanics.motor_mass_kg?, mechanics.table_mass_kg?);
    let frequency_hz = (stiffness_n_per_m * (1.0 / motor_kg + 1.0 / table_kg)).sqrt() / TAU;
    Some(Notch { frequency_hz, width_hz: NOTCH.0 * frequency_hz, depth: NOTCH.1 })
}
