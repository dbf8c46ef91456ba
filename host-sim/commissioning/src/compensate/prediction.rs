//! The contour error that a model predicts, with and without a compensation.

use std::path::Path;

use rayon::prelude::*;

use crate::compensate::alignment::aligned;
use crate::compensate::controller_host::ControllerHost;
use crate::compensate::file::{CompensationFile, Refused};
use contour::verification::{Commanded, Prediction};
use contour::{ContourError, LoggedMotion, NominalPath};
use files::error::InputError;
use files::log::Log;
use model::machine::Machine;
use motion::{Block, Motion};
use plant::equivalent;
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::machine_sim::MachineSim;
use plant::sensors::Sensor;
use plant::simulate::{ClosedLoop, Plant, SimulationError};

/// A motion that is simulated, and the time on the session clock at which it starts, s.
#[derive(Clone, Debug)]
pub struct TestMotion {
    /// The motion.
    pub motion: Motion,
    /// Its file.
    pub source: String,
    /// Start, s.
    pub start_s: f64,
    /// Time at rest before it with the compensation on, s, which is no part of its log: another control compensates since its homing.
    pub settle_s: f64,
}

impl TestMotion {
    /// The motion of a text at a time on the session clock, s; `source` names it in messages.
    ///
    /// # Errors
    /// If the text is no motion file.
    pub fn parse(text: &str, source: &str, start_s: f64) -> Result<Self, InputError> {
        let motion = Motion::parse(text, source)?;
        Ok(Self { motion, source: source.to_owned(), start_s, settle_s: 0.0 })
    }

    /// The motion of a file at a time on the session clock, s.
    ///
    /// # Errors
    /// If the file cannot be read, or is no motion file.
    pub fn read(path: &Path, start_s: f64) -> Result<Self, InputError> {
        let source = path.display().to_string();
        Ok(Self { motion: Motion::read(path)?, source, start_s, settle_s: 0.0 })
    }

    /// A motion that is in no file, at a time on the session clock, s. Messages have its name.
    #[must_use]
    pub fn of_program(motion: Motion, start_s: f64) -> Self {
        Self { source: motion.name.clone(), motion, start_s, settle_s: 0.0 }
    }

    /// The path of the motion on a machine, without what settles before it.
    ///
    /// # Errors
    /// If the motion does not fit the machine.
    pub fn nominal_path(&self, machine: &Machine) -> Result<NominalPath, InputError> {
        let path = MachinePath::new(&self.motion, machine, &self.source)?;
        Ok(NominalPath::of_blocks(&path.start_m, &path.blocks))
    }
}

/// Why a motion cannot be simulated.
#[derive(Debug, thiserror::Error)]
pub enum PredictionError {
    /// The motion does not fit the machine.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The machine does not complete it.
    #[error("{motion}: {error}")]
    Simulation {
        /// File of the motion.
        motion: String,
        /// Why.
        error: SimulationError,
    },
    /// The controller refuses the compensation.
    #[error(transparent)]
    Refused(#[from] Refused),
    /// The controller refuses the compensation of a part of the model.
    #[error("axis {}: the compensation of {part} is beyond what the controller takes: {refused}", refused.axis)]
    Beyond {
        /// Name of the effect or part.
        part: String,
        /// What is refused.
        refused: Refused,
    },
    /// A log has no contour error.
    #[error("{motion}: the motion is too short, or has no linear axis")]
    NoContour {
        /// Name of the motion.
        motion: String,
    },
}

/// Log of a machine on a motion with a compensation.
///
/// # Errors
/// If the motion does not fit the machine, the controller refuses the compensation, or the machine does not complete the
/// motion.
pub fn log(
    machine: &Machine,
    file: &CompensationFile,
    test: &TestMotion,
    (instruments, controller_host): (Instruments, ControllerHost),
) -> Result<Log, PredictionError> {
    let plant = |machine: &Machine, start_m: &[f64]| {
        Ok(MachineSim::new(machine, instruments, start_m)?.starting_at(test.start_s))
    };
    log_of_plant((machine, plant), file, test, controller_host)
}

/// The log of a motion on any plant, with what [`equivalent`] takes for loops and masses that are not known: `plant` makes it from the machine with the settings of the compensation, at rest at its start, m.
///
/// # Errors
/// As [`log`].
pub fn log_of_plant<P: Plant>(
    (machine, plant): (&Machine, impl FnOnce(&Machine, &[f64]) -> Result<P, SimulationError>),
    file: &CompensationFile,
    test: &TestMotion,
    controller_host: ControllerHost,
) -> Result<Log, PredictionError> {
    let machine = file.applied_to(machine);
    let (machine, _) = equivalent::of(&machine);
    let machine = machine.as_ref();
    let mut motion = test.motion.clone();
    if test.settle_s > 0.0 {
        motion.blocks.insert(0, Block::Dwell { seconds: test.settle_s });
    }
    let path = MachinePath::new(&motion, machine, &test.source)?;
    let failed = |error| PredictionError::Simulation { motion: test.source.clone(), error };
    let mut controller = controller_host.controller(machine, &path.start_m).map_err(failed)?;
    file.set(machine, controller.as_mut())?;
    let mut plant = plant(machine, &path.start_m).map_err(failed)?;
    let closed_loop = ClosedLoop { machine, blocks: &path.blocks, start_s: test.start_s };
    let mut log = closed_loop.log(&mut plant, controller.as_mut(), |_, _, _| {}).map_err(failed)?;
    log.source.clone_from(&test.motion.name);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some thousands of samples")]
    let settled = (test.settle_s / log.sample_time_s).round() as usize;
    Ok(if settled > 0 { log.slice(settled.min(log.len())..log.len()) } else { log })
}

/// Contour error of a machine on each motion with a compensation.
///
/// # Errors
/// As [`log`].
pub fn contour_errors(
    machine: &Machine,
    file: &CompensationFile,
    tests: &[TestMotion],
    instruments: Instruments,
) -> Result<Vec<ContourError>, PredictionError> {
    tests.par_iter().map(|test| contour_error_on(machine, file, test, instruments)).collect()
}

/// Contour error of a machine on one motion with a compensation.
///
/// # Errors
/// As [`log`].
pub fn contour_error_on(
    machine: &Machine,
    file: &CompensationFile,
    test: &TestMotion,
    instruments: Instruments,
) -> Result<ContourError, PredictionError> {
    contour_error(&log(machine, file, test, (instruments, ControllerHost::Host))?, machine)
}

/// Contour error of a log, whose channels are aligned by the model.
///
/// # Errors
/// If the log is too short or has no linear axis.
pub fn contour_error(log: &Log, model: &Machine) -> Result<ContourError, PredictionError> {
    Ok(of_aligned(&aligned(log, model))?.0)
}

/// Contour error of a log whose channels are aligned, and its positions.
///
/// # Errors
/// If the log is too short or has no linear axis.
pub fn of_aligned(log: &Log) -> Result<(ContourError, LoggedMotion), PredictionError> {
    let motion = LoggedMotion::of(log).ok();
    let both = motion.and_then(|motion| Some((motion.contour_error()?, motion)));
    both.ok_or_else(|| PredictionError::NoContour { motion: log.source.clone() })
}

/// Root mean square over the samples of all motions, µm.
#[must_use]
pub fn total_rms_um(errors: &[ContourError]) -> f64 {
    let squares: f64 = errors.iter().map(|error| error.samples as f64 * error.rms_um.powi(2)).sum();
    let samples: u64 = errors.iter().map(|error| error.samples).sum();
    (squares / samples.max(1) as f64).sqrt()
}

/// The predictions of a compensation file for motions of a machine, without a bound. The probe has the resolution of the
/// instruments and no noise: what the logs have of it is removed where they are compared.
///
/// # Errors
/// As [`log`].
pub fn predictions(
    machine: &Machine,
    file: &CompensationFile,
    tests: &[TestMotion],
    instruments: Instruments,
) -> Result<Vec<Prediction>, PredictionError> {
    let tool = Sensor { noise: 0.0, ..instruments.tool };
    let instruments = Instruments { tool, ..instruments };
    let none = CompensationFile::none(machine);
    let one = |test: &TestMotion| {
        let measured = |file| {
            let log = log(machine, file, test, (instruments, ControllerHost::Host))?;
            of_aligned(&aligned(&log, machine))
        };
        let [(before, _), (after, motion)] = [measured(&none)?, measured(file)?];
        Ok(Prediction::new(&test.motion.name, [&before, &after], &Commanded::of(&motion)))
    };
    tests.par_iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensate::file::AxisCompensation;
    use crate::compensate::servo::ControllerChange;
    use shared::compensate::CompensationSettings;
    use shared::compensate::settings::{Pitch, PitchSource, Points};

    /// The table is 20 µm too far everywhere. At the start of a motion the correction has just been switched on, or it has been there for
    /// a second; the log begins with the motion.
    #[test]
    fn a_control_that_has_compensated_before_starts_where_it_should() {
        let text = "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ndrive = \"velocity\"\nposition_gain_per_s = 50.0\n";
        let machine = Machine::parse(text, "m.toml").unwrap();
        let motion = "name = \"line\"\nfeed_mm_per_min = 600.0\nacceleration_m_per_s2 = 0.5\nstart_mm = { x = 0.0 }\n\
                      [[block]]\nline_to_mm = { x = 2.0 }\n";
        let forward = Points { start_m: -0.1, spacing_m: 0.2, values: [20e-6; 2].into_iter().collect() };
        let pitch = Some(Pitch { of: PitchSource::Screw, forward, backward: None });
        let compensation = CompensationSettings { pitch, ..CompensationSettings::default() };
        let x = AxisCompensation { mapped_mm: None, controller: ControllerChange::default(), compensation };
        let axis = [("x".to_owned(), x)].into_iter().collect();
        let file = CompensationFile { axis, ..CompensationFile::none(&machine) };
        let logged = |settle_s| {
            let test = TestMotion { settle_s, ..TestMotion::parse(motion, "line.toml", 0.0).unwrap() };
            log(&machine, &file, &test, (Instruments::default(), ControllerHost::Host)).unwrap()
        };
        let (at_once, settled) = (logged(0.0), logged(1.0));
        assert!(at_once.len().abs_diff(settled.len()) <= 1, "{} {}", at_once.len(), settled.len());
        let first_um = |log: &Log| 1e3 * log.axes[0].motor.as_ref().unwrap()[0];
        assert!(first_um(&at_once).abs() < 1.0, "{}", first_um(&at_once));
        assert!((first_um(&settled) + 20.0).abs() < 1.0, "{}", first_um(&settled));
    }
}
