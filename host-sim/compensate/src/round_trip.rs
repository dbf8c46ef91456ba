//! Motions of a machine before and after its compensation, beside what the model predicts.

use rayon::prelude::*;

use crate::file::CompensationFile;
use crate::place::Place;
use crate::prediction::{self, PredictionError, TestMotion, contour_error, total_rms_um};
use contour::ContourError;
use files::log::Log;
use model::machine::Machine;
use plant::instruments::Instruments;

/// A motion before, as predicted, and after.
#[derive(Clone, Debug)]
pub struct Compared {
    /// Name of the motion.
    pub name: String,
    /// The logs: before, predicted, after.
    pub logs: [Log; 3],
    /// Their contour errors.
    pub errors: [ContourError; 3],
}

/// A machine on which motions are executed.
#[derive(Clone, Copy, Debug)]
pub struct RealMachine<'a> {
    /// The machine with all its effects.
    pub machine: &'a Machine,
    /// Its sensors and drives.
    pub instruments: Instruments,
    /// Where its controller runs with the compensation.
    pub place: Place,
}

/// Executes each motion on a machine without and with a compensation, and on the model with it. The noise of the sensors differs
/// from run to run.
///
/// # Errors
/// If a motion cannot be simulated.
pub fn compare(
    real: RealMachine<'_>,
    model: &Machine,
    file: &CompensationFile,
    tests: &[TestMotion],
) -> Result<Vec<Compared>, PredictionError> {
    let none = CompensationFile { machine: file.machine.clone(), ..CompensationFile::default() };
    let seeded = |offset: u64| Instruments { seed: real.instruments.seed + offset, ..real.instruments };
    tests
        .par_iter()
        .enumerate()
        .map(|(number, test)| {
            let first = 1000 + 3 * number as u64;
            let before = prediction::log(real.machine, &none, test, (seeded(first), Place::Host))?;
            let predicted = prediction::log(model, file, test, (seeded(first + 1), Place::Host))?;
            let after = prediction::log(real.machine, file, test, (seeded(first + 2), real.place))?;
            let of = |log| contour_error(log, model);
            let errors = [of(&before)?, of(&predicted)?, of(&after)?];
            Ok(Compared { name: test.motion.name.clone(), logs: [before, predicted, after], errors })
        })
        .collect()
}

/// Rms over the samples of all motions before, as predicted, and after, µm.
#[must_use]
pub fn totals_um(motions: &[Compared]) -> [f64; 3] {
    [0, 1, 2].map(|which| {
        let errors: Vec<ContourError> = motions.iter().map(|motion| motion.errors[which].clone()).collect();
        total_rms_um(&errors)
    })
}
