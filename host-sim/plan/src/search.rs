//! The shortest motion that answers everything.

use crate::family::{Candidate, candidates};
use crate::limits::MotionLimits;
use crate::outcome::{Expected, Plan, Tried};
use crate::questions::{declared, questions, undecidable, unexplained};
use crate::trial::{Answers, Bench, asked};
use files::log::Log;
use model::machine::Machine;

/// Numbers of the noise of the sensors in the first trial of a motion and in its repetition.
const NOISES: [u64; 2] = [1, 2];

/// The search ends after this many motions in a row that reach no more than a shorter one: what is not recognized then is too small for any.
const WITHOUT_GAIN: usize = 6;

/// What is to be planned.
#[derive(Clone, Copy, Debug)]
pub struct Planning<'a> {
    /// The model that a trace has written.
    pub model: &'a Machine,
    /// Limits of the motion.
    pub limits: &'a MotionLimits,
    /// Logs of the machine, for its channels; empty: it has all.
    pub logs: &'a [Log],
    /// Largest half width of an interval, percent of its value; `None`: any.
    pub interval_percent: Option<f64>,
}

/// Tries motions, the shortest first, until one answers everything. `progress` receives each one as it starts.
#[must_use]
pub fn plan(planning: &Planning<'_>, progress: &(dyn Fn(&str) + Sync)) -> Plan {
    let Planning { model, limits, logs, interval_percent } = *planning;
    let (declared, questions) = (declared(model), questions(model));
    let bench = Bench { model, declared: &declared, questions: &questions, logs };
    let asked = asked(&questions);
    let (mut tried, mut best): (Vec<Tried>, Option<(Candidate, Answers, usize)>) = (Vec::new(), None);
    let goals = asked.len() + usize::from(interval_percent.is_some());
    let family = if goals > 0 { candidates(limits) } else { Vec::new() };
    let mut without_gain = 0;
    for candidate in family {
        progress(&format!("simulating and tracing {}", candidate.name));
        let (row, answers) = attempt(&bench, &candidate, interval_percent);
        without_gain += 1;
        if let Some(answers) = answers
            && best.as_ref().is_none_or(|(_, _, reached)| row.reached > *reached)
        {
            best = Some((candidate, answers, row.reached));
            without_gain = 0;
        }
        let is_done = row.reached == goals || without_gain == WITHOUT_GAIN;
        tried.push(row);
        if is_done {
            break;
        }
    }
    Plan {
        undecidable: undecidable(model),
        unexplained: unexplained(model),
        asked,
        questions,
        goals,
        tried,
        expected: best.as_ref().map_or_else(Vec::new, |(_, answers, _)| Expected::of(model, answers)),
        is_recognized: best.as_ref().map_or_else(Vec::new, |(_, answers, _)| answers.is_recognized.clone()),
        motion: best.filter(|(_, _, reached)| *reached > 0).map(|(candidate, _, _)| candidate),
    }
}

/// Tries a motion; again with other noise if it reaches everything, as that may be less favourable.
fn attempt(bench: &Bench<'_>, candidate: &Candidate, percent: Option<f64>) -> (Tried, Option<Answers>) {
    let goals = asked(bench.questions).len() + usize::from(percent.is_some());
    let answers = |noise: u64| {
        let motion = candidate.motion.motion()?;
        bench.answers(motion, noise).ok()
    };
    let is_all = |answers: &Answers| reached(bench, answers, percent) == goals;
    let [first, again] = NOISES;
    let answers = match answers(first) {
        Some(first) if is_all(&first) => answers(again).map(|again| first.and(&again)),
        first => first,
    };
    let reached = answers.as_ref().map_or(0, |answers| reached(bench, answers, percent));
    (Tried { name: candidate.name.clone(), seconds: candidate.seconds, reached }, answers)
}

/// The number of candidates that are recognized, and one more if the intervals are as narrow as asked for.
fn reached(bench: &Bench<'_>, answers: &Answers, percent: Option<f64>) -> usize {
    let is_narrow =
        |percent: f64| Expected::of(bench.model, answers).iter().all(|one| one.is_within(percent));
    answers.is_recognized.iter().filter(|is| **is).count() + usize::from(percent.is_some_and(is_narrow))
}

impl Answers {
    /// What is answered with this noise and with another one, with the wider of both intervals.
    fn and(mut self, other: &Self) -> Self {
        for (is, also) in self.is_recognized.iter_mut().zip(&other.is_recognized) {
            *is &= also;
        }
        for (axis, effect, half_widths) in &mut self.found {
            let same = other.found.iter().find(|(name, found, _)| name == axis && found.is_same(effect));
            let others = same.map(|(_, _, half_widths)| half_widths.as_slice()).unwrap_or_default();
            for (half, also) in half_widths.iter_mut().zip(others) {
                *half = half.max(*also);
            }
        }
        self
    }
}
