//! What the log of a motion answers: it is simulated under each candidate of each question, and traced.

use rayon::prelude::*;

use crate::questions::Question;
use commissioning::compensate::controller_host::ControllerHost;
use commissioning::compensate::file::CompensationFile;
use commissioning::compensate::prediction::{self, PredictionError, TestMotion};
use files::error::InputError;
use files::log::{AxisLog, Channel, Log};
use model::effects::Effect;
use model::machine::Machine;
use motion::Motion;
use plant::instruments::Instruments;
use trace::judge::found_effect::FoundEffect;
use trace::{AxisIdentification, Identification, certainty};

/// Why a motion could not be tried.
#[derive(Debug, thiserror::Error)]
pub enum TrialError {
    /// The log cannot be traced.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The machine does not complete the motion.
    #[error(transparent)]
    Run(#[from] PredictionError),
}

/// The machine that a trial simulates, and what is logged of it.
pub struct Bench<'a> {
    /// The model with its questions.
    pub model: &'a Machine,
    /// The machine as it was declared, with which logs are traced.
    pub declared: &'a Machine,
    /// What the model leaves open.
    pub questions: &'a [Question],
    /// Logs of the machine: channels that none of them has will not be logged either. Empty: all channels.
    pub logs: &'a [Log],
}

/// An answer that a trial has to give: with the candidate of a question in the machine, the trace is to find it and to be certain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Asked {
    /// Index of the question.
    pub question: usize,
    /// Index of the candidate that the machine has.
    pub candidate: usize,
}

/// What the log of a motion answers.
#[derive(Clone, Debug)]
pub struct Answers {
    /// Whether each candidate is found for certain if it is the true one, in the order of [`asked`].
    pub is_recognized: Vec<bool>,
    /// The effects found on the model as it is: axis, effect, half widths of the 95 % intervals of its values.
    pub found: Vec<(String, Effect, Vec<f64>)>,
}

/// Every candidate of every question.
#[must_use]
pub fn asked(questions: &[Question]) -> Vec<Asked> {
    let of = |(question, one): (usize, &Question)| {
        (0..one.candidates.len()).map(move |candidate| Asked { question, candidate })
    };
    questions.iter().enumerate().flat_map(of).collect()
}

impl Bench<'_> {
    /// Simulates and traces a motion under every candidate. `noise` selects the noise of the sensors.
    ///
    /// # Errors
    /// If a machine cannot execute the motion, or its log cannot be traced.
    pub fn answers(&self, motion: &Motion, noise: u64) -> Result<Answers, TrialError> {
        let rivals: Vec<Asked> =
            asked(self.questions).into_iter().filter(|asked| asked.candidate > 0).collect();
        let machines =
            rivals.iter().map(|one| self.questions[one.question].answered(self.model, one.candidate));
        let machines: Vec<Machine> = std::iter::once(self.model.clone()).chain(machines).collect();
        let traced: Vec<Identification> = machines
            .par_iter()
            .map(|machine| self.traced(machine, motion, noise))
            .collect::<Result<_, TrialError>>()?;
        let is_recognized = |asked: Asked| {
            // The candidate of the model is in the first machine.
            let machine = rivals.iter().position(|rival| *rival == asked).map_or(0, |index| index + 1);
            let question = &self.questions[asked.question];
            is_found(&traced[machine], &machines[machine], question, asked.candidate)
        };
        Ok(Answers {
            is_recognized: asked(self.questions).into_iter().map(is_recognized).collect(),
            found: found(&traced[0]),
        })
    }

    fn traced(&self, machine: &Machine, motion: &Motion, noise: u64) -> Result<Identification, TrialError> {
        let test = TestMotion::of_program(motion.clone(), 0.0);
        let sensing = (Instruments::of(machine, noise), ControllerHost::Host);
        let mut log = prediction::log(machine, &CompensationFile::default(), &test, sensing)?;
        for axis in &mut log.axes {
            keep_logged(axis, self.logs);
        }
        Ok(trace::trace(self.declared, std::slice::from_ref(&log), &[], &|_| {})?)
    }
}

/// Removes the channels that no log of the machine has.
fn keep_logged(axis: &mut AxisLog, logs: &[Log]) {
    if logs.is_empty() {
        return;
    }
    let same: Vec<&AxisLog> =
        logs.iter().flat_map(|log| &log.axes).filter(|other| other.name == axis.name).collect();
    for channel in Channel::ALL {
        if same.iter().all(|log| log.channel(channel).is_none()) {
            *axis.channel_mut(channel) = None;
        }
    }
}

/// The effects of an axis that are certain.
fn certain(axis: &AxisIdentification) -> impl Iterator<Item = &Effect> {
    axis.found.iter().filter(|found| certainty::is_certain(axis, found)).map(|found| &found.effect)
}

/// Whether a trace finds a candidate of a question for certain, and no effect that the machine does not have.
fn is_found(traced: &Identification, machine: &Machine, question: &Question, candidate: usize) -> bool {
    let has = |axis: &AxisIdentification, effect: &Effect| {
        let of_axis = machine.axis.get(&axis.axis);
        of_axis.is_some_and(|of| of.effect.iter().any(|other| other.name() == effect.name()))
    };
    let is_true = traced.axes().iter().all(|axis| certain(axis).all(|effect| has(axis, effect)));
    let of_question = traced.axes().iter().find(|axis| axis.axis == question.axis);
    let is_candidate = |effect: &Effect| effect.is_same(&question.candidates[candidate]);
    is_true && of_question.is_some_and(|axis| certain(axis).any(is_candidate))
}

fn found(traced: &Identification) -> Vec<(String, Effect, Vec<f64>)> {
    let of_axis = |axis: &AxisIdentification| {
        let of = |found: &FoundEffect| (axis.axis.clone(), found.effect.clone(), found.half_widths.clone());
        axis.found.iter().map(of).collect::<Vec<_>>()
    };
    traced.axes().iter().flat_map(of_axis).collect()
}
