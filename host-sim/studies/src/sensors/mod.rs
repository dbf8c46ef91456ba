//! One machine with its position loop closed by the motor, by the table and by both: contour error, margins and highest position
//! gain, for P control and HPC, without and with compensation.
//!
//! The machine has backlash, pitch errors, friction and an elastic drive. The contour error is simulated, with the noise of
//! typical sensors; the margins are those of the crate `margins`, the smallest of both axes. The compensation is the one that
//! `lost-motion compensate` plans from the true model, so that what it leaves is the limit of the controller.

pub mod page;
pub mod row;
#[cfg(test)]
mod tests;
pub mod text;
pub mod verdict;

use rayon::prelude::*;
use serde::Serialize;

use commissioning::compensate::CompensationFile;
use commissioning::compensate::planning::Planning;
use commissioning::compensate::prediction::{PredictionError, TestMotion, contour_errors};
use commissioning::margins::MarginLimits;
use commissioning::margins::axis_margins::{self, AxisMargins, MarginError};
use files::error::InputError;
use model::axis::{Feedback, Law};
use model::machine::Machine;
use plant::instruments::Instruments;
use row::{CrossoverPoint, GainPoint, Row};

const MACHINE: &str = include_str!("machine.toml");
const MOTIONS: [(&str, &str); 2] =
    [("circle.toml", include_str!("circle.toml")), ("corner.toml", include_str!("corner.toml"))];

/// Points of a curve of the contour error over the position gain.
const CURVE_POINTS: usize = 8;

/// Lowest position gain of these curves, 1/s.
const LOWEST_GAIN_PER_S: f64 = 10.0;

/// Time constants of dual feedback whose contour error and highest gain are compared, s.
const CROSSOVERS_S: [f64; 5] = [0.003, 0.01, 0.03, 0.1, 0.3];

/// Seed of the sensors' noise.
const SEED: u64 = 1;

/// Sensors and law of a position loop, in the order of the table.
pub const LOOPS: [(Feedback, Law); 6] = [
    (Feedback::Motor, Law::P),
    (Feedback::Table, Law::P),
    (Feedback::Dual, Law::P),
    (Feedback::Motor, Law::Hpc),
    (Feedback::Table, Law::Hpc),
    (Feedback::Dual, Law::Hpc),
];

/// Errors of the study.
#[derive(Debug, thiserror::Error)]
pub enum SensorsError {
    /// A built-in file is refused.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The machine does not complete a motion.
    #[error(transparent)]
    Prediction(#[from] PredictionError),
    /// The machine file lacks a key.
    #[error(transparent)]
    Margins(#[from] MarginError),
}

/// The result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SensorStudy {
    /// Kp of the table's contour errors and margins, 1/s.
    pub position_gain_per_s: f64,
    /// Gain margin that the highest position gain leaves, dB.
    pub gain_margin_db: f64,
    /// Phase margin that the highest position gain leaves, degrees.
    pub phase_margin_deg: f64,
    /// One row for each loop.
    pub rows: Vec<Row>,
    /// Dual feedback and P control with other time constants.
    pub crossovers: Vec<CrossoverPoint>,
}

/// Runs the study; `progress` is told what is being done.
///
/// # Errors
/// If the machine does not complete a motion.
pub fn run(progress: &dyn Fn(&str)) -> Result<SensorStudy, SensorsError> {
    let machine = Machine::parse(MACHINE, "machine.toml")?;
    let tests = MOTIONS.map(|(source, text)| TestMotion::parse(text, source, 0.0));
    let tests: Vec<TestMotion> = tests.into_iter().collect::<Result<_, InputError>>()?;
    let limits = MarginLimits::default();
    let rows = LOOPS.into_iter().map(|(feedback, law)| {
        let machine = with_loop(&machine, feedback, law);
        progress(&format!("{}, {}", row::feedback_name(feedback), row::law_name(law)));
        row(&machine, &tests, limits)
    });
    let rows: Vec<Row> = rows.collect::<Result<_, SensorsError>>()?;
    let gain = machine.axis.values().find_map(|axis| axis.settings.controller.position_gain_per_s);
    Ok(SensorStudy {
        position_gain_per_s: gain.unwrap_or(0.0),
        gain_margin_db: limits.gain_db,
        phase_margin_deg: limits.phase_deg,
        rows,
        crossovers: crossovers(&machine, &tests[..1], limits)?,
    })
}

/// Kf of a law, %, at which a circle has its radius.
///
/// With x = s/Kp, a position command is followed as (1 + Kf·x)/(1 + x) by P control, and as (16 + 16·Kf·x)/(x³ + 6x² + 16x + 16) by
/// HPC. At x = jw the squared magnitude is 1 + (Kf² − 1)·w² and 1 + (Kf² − ¼)·w², to second order.
#[must_use]
pub const fn feedforward_percent(law: Law) -> f64 {
    match law {
        Law::P => 100.0,
        Law::Hpc => 50.0,
    }
}

/// The machine with its position loops closed by these sensors and this law.
#[must_use]
pub fn with_loop(machine: &Machine, feedback: Feedback, law: Law) -> Machine {
    let mut machine = machine.clone();
    for axis in machine.axis.values_mut() {
        axis.settings.controller.law = Some(law);
        axis.settings.controller.feedforward_percent = Some(feedforward_percent(law));
        axis.settings.sensors.feedback = feedback;
        if feedback != Feedback::Dual {
            axis.settings.sensors.dual_feedback_time_constant_s = None;
        }
    }
    machine
}

/// The row of a machine.
fn row(machine: &Machine, tests: &[TestMotion], limits: MarginLimits) -> Result<Row, SensorsError> {
    let instruments = Instruments::of(machine, SEED);
    let none = CompensationFile::none(machine);
    let before = contour_errors(machine, &none, tests, instruments)?;
    let planning = Planning {
        model: machine,
        model_file: "machine.toml",
        tests,
        watched: &[],
        instruments,
        set_at_s: 0.0,
    };
    let plan = planning.plan()?;
    let after = contour_errors(machine, &plan.file, tests, instruments)?;
    let axes = axis_margins::of_machine(machine, &instruments, limits)?;
    let highest = highest_gain(&axes);
    let over_gain = curve(machine, &tests[..1], highest.unwrap_or(LOWEST_GAIN_PER_S))?;
    Ok(Row::new(machine, &axes, highest, [&before, &after]).with_curve(over_gain))
}

/// The highest position gain that all axes can have, 1/s.
fn highest_gain(axes: &[AxisMargins]) -> Option<f64> {
    let gains: Option<Vec<f64>> = axes.iter().map(|axis| axis.highest_position_gain_per_s).collect();
    gains.map(numerics::min)
}

/// Contour error over the position gain, without compensation, up to the highest gain.
fn curve(
    machine: &Machine,
    tests: &[TestMotion],
    highest_per_s: f64,
) -> Result<Vec<GainPoint>, SensorsError> {
    let ratio = (highest_per_s / LOWEST_GAIN_PER_S).max(1.0);
    let point = |index: usize| {
        let share = index as f64 / (CURVE_POINTS - 1) as f64;
        let gain_per_s = LOWEST_GAIN_PER_S * libm::pow(ratio, share);
        let mut machine = machine.clone();
        for axis in machine.axis.values_mut() {
            axis.settings.controller.position_gain_per_s = Some(gain_per_s);
        }
        let instruments = Instruments::of(&machine, SEED);
        let errors = contour_errors(&machine, &CompensationFile::none(&machine), tests, instruments)?;
        Ok(GainPoint { position_gain_per_s: gain_per_s, circle_rms_um: errors[0].rms_um })
    };
    (0..CURVE_POINTS).into_par_iter().map(point).collect()
}

/// Contour error and highest gain of dual feedback over its time constant.
fn crossovers(
    machine: &Machine,
    tests: &[TestMotion],
    limits: MarginLimits,
) -> Result<Vec<CrossoverPoint>, SensorsError> {
    let point = |time_constant_s: f64| {
        let mut machine = with_loop(machine, Feedback::Dual, Law::P);
        for axis in machine.axis.values_mut() {
            axis.settings.sensors.dual_feedback_time_constant_s = Some(time_constant_s);
        }
        let instruments = Instruments::of(&machine, SEED);
        let errors = contour_errors(&machine, &CompensationFile::none(&machine), tests, instruments)?;
        let axes = axis_margins::of_machine(&machine, &instruments, limits)?;
        Ok(CrossoverPoint {
            time_constant_s,
            circle_rms_um: errors[0].rms_um,
            highest_position_gain_per_s: highest_gain(&axes),
        })
    };
    CROSSOVERS_S.into_par_iter().map(point).collect()
}
