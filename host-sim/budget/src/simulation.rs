//! The contour error of a motion with all causes, with each alone, and with each taken out.
//!
//! The lag of the loops acts in every simulation. What it does alone is a simulation without all other causes; its displacement of the
//! tool is subtracted where the other causes shall act without it.

use rayon::prelude::*;

use commissioning::compensate::CompensationFile;
use commissioning::compensate::alignment::aligned;
use commissioning::compensate::controller_host::ControllerHost;
use commissioning::compensate::planning::Planning;
use commissioning::compensate::prediction::{self, PredictionError, TestMotion};
use files::log::{Channel, Log};
use model::machine::Machine;

use crate::cause::{self, Cause};
use crate::radial::{self, RadialDeviation};
use crate::sizes::Sizes;

/// What is simulated.
#[derive(Clone, Copy, Debug)]
pub struct Simulated<'a> {
    /// The model, with its effects.
    pub model: &'a Machine,
    /// Seed of the noise of the sensors.
    pub seed: u64,
    /// Whether the controller compensates those of the causes that act: see [`Planning::everything`].
    pub is_compensated: bool,
}

/// How a motion goes wrong: the figures, and the curve if it is a circle.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The figures.
    pub sizes: Sizes,
    /// The radial deviation over the angle.
    pub circle: Option<RadialDeviation>,
}

/// The contour error with a cause alone, and with all but it.
#[derive(Clone, Debug)]
pub struct AloneAndWithout {
    /// With this cause alone.
    pub alone: Sizes,
    /// With all causes but this one.
    pub without: Outcome,
}

impl Simulated<'_> {
    /// The contour error with all causes, and of each cause.
    ///
    /// # Errors
    /// If the motion does not fit the machine, or the machine does not complete it.
    pub fn outcomes(
        &self,
        test: &TestMotion,
        causes: &[Cause],
    ) -> Result<(Outcome, Vec<AloneAndWithout>), PredictionError> {
        let lag = self.log(test, &[])?;
        let all = self.log(test, causes)?;
        let is_circle = radial::is_circle(&test.motion);
        let one = |cause: &Cause| match cause {
            Cause::FollowingLag => Ok(AloneAndWithout {
                alone: outcome(&lag, false)?.sizes,
                without: outcome(&less(&all, &lag), is_circle)?,
            }),
            cause => {
                let others: Vec<Cause> = causes.iter().filter(|other| *other != cause).cloned().collect();
                let alone = self.log(test, std::slice::from_ref(cause))?;
                let without = outcome(&self.log(test, &others)?, is_circle)?;
                Ok(AloneAndWithout { alone: outcome(&less(&alone, &lag), false)?.sizes, without })
            }
        };
        let each = causes.par_iter().map(one).collect::<Result<_, PredictionError>>()?;
        Ok((outcome(&all, is_circle)?, each))
    }

    /// The compensation of a machine with some causes; `None`: there is none, or no reason for any.
    ///
    /// # Errors
    /// If the controller has too few settings for it, or the motion does not fit the machine.
    pub fn compensation(
        &self,
        machine: &Machine,
        test: &TestMotion,
        causes: &[Cause],
    ) -> Result<Option<CompensationFile>, PredictionError> {
        if !self.is_compensated {
            return Ok(None);
        }
        let planning = Planning {
            model: machine,
            model_file: "",
            tests: std::slice::from_ref(test),
            watched: &[],
            instruments: cause::instruments(self.model, causes, self.seed),
            set_at_s: test.start_s,
        };
        planning.everything()
    }

    /// The log of the machine with some causes, with the tool where it is and not where a probe reads it.
    fn log(&self, test: &TestMotion, causes: &[Cause]) -> Result<Log, PredictionError> {
        let machine = cause::with(self.model, causes);
        let instruments = cause::instruments(self.model, causes, self.seed);
        let file =
            self.compensation(&machine, test, causes)?.unwrap_or_else(|| CompensationFile::none(&machine));
        let log = prediction::log(&machine, &file, test, (instruments, ControllerHost::Host))?;
        Ok(aligned(&log, &machine))
    }
}

/// A log whose tool is not displaced as in another log of the same motion.
fn less(log: &Log, other: &Log) -> Log {
    let mut log = log.clone();
    for (axis, other) in log.axes.iter_mut().zip(&other.axes) {
        let (Some(command), Some(tool)) = (&other.command, &other.tool) else { continue };
        let displaced = command.iter().zip(tool).map(|(command, tool)| tool - command);
        if let Some(own) = axis.channel_mut(Channel::Tool) {
            own.iter_mut().zip(displaced).for_each(|(mm, displaced)| *mm -= displaced);
        }
    }
    log
}

fn outcome(log: &Log, is_circle: bool) -> Result<Outcome, PredictionError> {
    let (error, motion) = prediction::of_aligned(log)?;
    let circle = if is_circle { RadialDeviation::of(&error, &motion.axes) } else { None };
    Ok(Outcome { sizes: Sizes::of(&error), circle })
}
