//! Motions of a machine before and after its compensation, beside what the model predicts.

use rayon::prelude::*;

use crate::compensate::controller_host::ControllerHost;
use crate::compensate::file::CompensationFile;
use crate::compensate::prediction::{self, PredictionError, TestMotion, contour_error, total_rms_um};
use contour::ContourError;
use contour::comparison::Comparison;
use files::log::Log;
use model::machine::Machine;
use plant::instruments::Instruments;
use plant::sensors::Sensor;

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

impl Compared {
    /// Its figures.
    #[must_use]
    pub fn comparison(&self) -> Comparison {
        Comparison::new(&self.name, &self.errors)
    }
}

/// The sensors of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensing {
    /// As they are.
    Installed,
    /// Without noise, with their resolution.
    Noiseless,
    /// Without noise, and not quantised.
    Ideal,
}

/// A machine on which motions are executed.
pub trait MachineUnderTest: Sync {
    /// Log of a motion with a compensation. `run` selects the noise of the sensors: each run has other noise.
    ///
    /// # Errors
    /// If the motion does not fit the machine, the controller refuses the compensation, or the machine does not complete the
    /// motion.
    fn log(
        &self,
        file: &CompensationFile,
        test: &TestMotion,
        run: u64,
        sensing: Sensing,
    ) -> Result<Log, PredictionError>;
}

/// A machine of the simulator of this program.
#[derive(Clone, Copy, Debug)]
pub struct SimulatedMachine<'a> {
    /// The machine with all its effects.
    pub machine: &'a Machine,
    /// Its sensors and drives.
    pub instruments: Instruments,
    /// Where its controller runs with a compensation and the sensors as they are; otherwise it runs in this process, with the same
    /// bits.
    pub controller_host: ControllerHost,
}

impl MachineUnderTest for SimulatedMachine<'_> {
    fn log(
        &self,
        file: &CompensationFile,
        test: &TestMotion,
        run: u64,
        sensing: Sensing,
    ) -> Result<Log, PredictionError> {
        let instruments = with_sensing(self.instruments, sensing);
        let instruments = Instruments { seed: instruments.seed + run, ..instruments };
        let is_plain = file.axis.is_empty() || sensing != Sensing::Installed;
        let controller_host = if is_plain { ControllerHost::Host } else { self.controller_host };
        prediction::log(self.machine, file, test, (instruments, controller_host))
    }
}

/// Instruments with other sensors.
#[must_use]
pub fn with_sensing(instruments: Instruments, sensing: Sensing) -> Instruments {
    match sensing {
        Sensing::Installed => instruments,
        Sensing::Noiseless => instruments.with_sensors(|sensor| Sensor { noise: 0.0, ..sensor }),
        Sensing::Ideal => instruments.with_sensors(|_| Sensor::default()),
    }
}

/// Executes each motion on a machine with one compensation and with another, and on the model with the other one.
///
/// # Errors
/// If a motion cannot be simulated.
pub fn compare(
    machine_under_test: &dyn MachineUnderTest,
    (model, instruments): (&Machine, Instruments),
    [file_before, file]: [&CompensationFile; 2],
    tests: &[TestMotion],
) -> Result<Vec<Compared>, PredictionError> {
    tests
        .par_iter()
        .enumerate()
        .map(|(number, test)| {
            let first = 1000 + 3 * number as u64;
            let instruments = Instruments { seed: instruments.seed + first + 1, ..instruments };
            let before = machine_under_test.log(file_before, test, first, Sensing::Installed)?;
            let predicted = prediction::log(model, file, test, (instruments, ControllerHost::Host))?;
            let after = machine_under_test.log(file, test, first + 2, Sensing::Installed)?;
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
