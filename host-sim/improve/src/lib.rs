//! Commissioning in rounds: a machine is logged, its logs are traced, the model found is compensated, and the motions are executed
//! again, until nothing more is gained.
//!
//! - [`round`]: one round, and when its compensation is kept
//! - [`retrace`]: the parts of the logs of a compensated machine that are traced
//! - [`outcome`]: the rounds as sentences, table and JSON

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod outcome;
pub mod retrace;
pub mod round;

use rayon::prelude::*;

use commissioning::compensate::file::CompensationFile;
use commissioning::compensate::prediction::{self, PredictionError, TestMotion, contour_error};
use commissioning::compensate::round_trip::{MachineUnderTest, Sensing, SimulatedMachine};
use commissioning::compensate::standard_motions;
use commissioning::margins::MarginLimits;
use contour::ContourError;
use files::error::InputError;
use files::log::Log;
use model::machine::Machine;

use outcome::{Improvement, Stop};
use retrace::Logs;
use round::Round;

/// Number of the first run of a judged motion in round 1, by which its noise is selected: after those of the fit.
const JUDGED: u64 = 500;

/// Why a machine cannot be improved.
#[derive(Debug, thiserror::Error)]
pub enum ImproveError {
    /// A log cannot be traced.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A motion cannot be executed, or the controller refuses the compensation.
    #[error(transparent)]
    Run(#[from] PredictionError),
}

/// The machine to be improved, and the motions.
#[derive(Clone, Copy)]
pub struct Improving<'a> {
    /// The declared machine.
    pub declared: &'a Machine,
    /// The machine that executes the motions.
    pub machine_under_test: SimulatedMachine<'a>,
    /// Motions whose logs are fitted.
    pub fit: &'a [TestMotion],
    /// Motions whose contour error counts. Their logs are held out of every fit.
    pub judged: &'a [TestMotion],
    /// Margins that the loops must keep.
    pub limits: MarginLimits,
}

impl Improving<'_> {
    /// Executes at most `max_rounds` rounds. `progress` receives each step as it starts.
    ///
    /// # Errors
    /// If a motion cannot be executed, or its log cannot be traced.
    pub fn improve(
        &self,
        max_rounds: usize,
        progress: &(dyn Fn(&str) + Sync),
    ) -> Result<Improvement, ImproveError> {
        let none = CompensationFile::none(self.declared);
        progress("round 1: running the machine");
        let mut logs = Logs::new(self.run(self.fit, &none, 0)?, self.run(self.judged, &none, JUDGED)?);
        let mut rounds: Vec<Round> = Vec::new();
        let uncompensated = logs.judged.clone();
        let mut model = self.declared.clone();
        let mut stop = Stop::Rounds;
        for number in 1..=max_rounds {
            let show = |what: &str| progress(&format!("round {number}: {what}"));
            let trace = logs.trace(&model, number > 1, &show)?;
            let traced = retrace::with_loops_of(&trace.better_machine(), self.declared);
            show("planning the compensation");
            let plan = self.plan(&traced)?;
            if !round::keeps_margins(&plan.file, self.declared, self.limits) {
                stop = Stop::Margins;
                break;
            }
            show("running the machine with its compensation");
            let seed = 1000 * number as u64;
            // What the model knows of the probe is removed from both: an error of the probe is none of the machine.
            let before = errors(&logs.judged, &traced)?;
            logs.judged = self.run(self.judged, &plan.file, seed)?;
            let predicted = prediction::contour_errors(
                &traced,
                &plan.file,
                self.judged,
                self.machine_under_test.instruments,
            )?;
            let after = errors(&logs.judged, &traced)?;
            let round = Round { trace, model: traced, plan, before, predicted, after };
            let (fits, is_kept) = (round.fits(), round.is_kept());
            model = round.model.clone();
            rounds.push(round);
            if !is_kept {
                stop = if fits { Stop::NothingGained } else { Stop::ModelDoesNotFit };
                break;
            }
            if number < max_rounds {
                show("logging the compensated machine");
                logs.fit.extend(self.run(self.fit, &rounds[number - 1].plan.file, seed + 500)?);
            }
        }
        let described = rounds.iter().rev().find(|round| round.fits());
        let first = errors(&uncompensated, described.map_or(self.declared, |round| &round.model))?;
        Ok(Improvement { motions: names(self.judged), first, rounds, stop })
    }

    /// The compensation of a model.
    fn plan(&self, model: &Machine) -> Result<commissioning::compensate::plan::Plan, PredictionError> {
        let set_at_s = self.judged.iter().map(|test| test.start_s).fold(0.0, f64::max);
        let watched = standard_motions::all(model, self.judged, set_at_s)?;
        let planning = commissioning::compensate::planning::Planning {
            model,
            model_file: "the traced model",
            tests: self.judged,
            watched: &watched,
            instruments: self.machine_under_test.instruments,
            set_at_s,
        };
        planning.plan()
    }

    /// The logs of motions with a compensation; each run has different noise.
    fn run(
        &self,
        motions: &[TestMotion],
        file: &CompensationFile,
        seed: u64,
    ) -> Result<Vec<Log>, PredictionError> {
        let one = |(number, test): (usize, &TestMotion)| {
            self.machine_under_test.log(file, test, seed + number as u64, Sensing::Installed)
        };
        motions.par_iter().enumerate().map(one).collect()
    }
}

fn errors(logs: &[Log], model: &Machine) -> Result<Vec<ContourError>, PredictionError> {
    logs.iter().map(|log| contour_error(log, model)).collect()
}

fn names(motions: &[TestMotion]) -> Vec<String> {
    motions.iter().map(|test| test.motion.name.clone()).collect()
}
