//! A plan as text and JSON.

use serde_json::{Value, json};

use crate::family::Candidate;
use crate::questions::{Question, Undecidable, Unexplained};
use crate::trial::{Answers, Asked};
use files::format::significant;
use model::effects::Effect;
use model::machine::Machine;
use model::machine::evidence::Certainty;

/// A motion that was tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// Its name.
    pub name: String,
    /// Its duration, s.
    pub seconds: f64,
    /// How many goals it reaches.
    pub reached: usize,
}

/// The interval that is expected of a value of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Name of the axis.
    pub axis: String,
    /// Name of the effect.
    pub effect: &'static str,
    /// Key of the value.
    pub key: &'static str,
    /// The value in the model.
    pub value: f64,
    /// Half of its 95 % interval in the model, if it is known there.
    pub before: Option<f64>,
    /// Half of the interval that the log of the motion will give; `None`: the effect will not be found.
    pub after: Option<f64>,
}

/// A planned motion.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The questions of the model.
    pub questions: Vec<Question>,
    /// What no motion decides.
    pub undecidable: Vec<Undecidable>,
    /// The axes that the trace has not described: what they lack is in no simulation.
    pub unexplained: Vec<Unexplained>,
    /// The candidates of all questions.
    pub asked: Vec<Asked>,
    /// Whether a trace of the motion finds each of them for certain if it is the true one.
    pub is_recognized: Vec<bool>,
    /// The number of goals: the candidates of all questions, and the widths of the intervals if they are limited.
    pub goals: usize,
    /// The motions that were tried, in their order.
    pub tried: Vec<Tried>,
    /// The motion; `None` if none within the limits answers anything, or nothing is asked.
    pub motion: Option<Candidate>,
    /// The intervals that are expected of the effects of the model.
    pub expected: Vec<Expected>,
}

impl Expected {
    /// The values of the effects of a model that a trace has found and fitted: the period of a wave of the screw is its lead.
    #[must_use]
    pub fn of(model: &Machine, answers: &Answers) -> Vec<Self> {
        let mut all = Vec::new();
        for (name, axis) in &model.axis {
            for (effect, evidence) in axis.effect.iter().zip(&axis.evidence) {
                if evidence.certainty == Certainty::Declared {
                    continue;
                }
                let found = answers.found.iter().find(|(of, found, _)| of == name && found.is_same(effect));
                let parameters = effect.declared_parameters();
                let values = parameters.iter().zip(effect.values()).enumerate();
                // The knots of a map are too many for a table.
                let single = values.filter(|(_, (parameter, _))| !parameter.is_list);
                let expected = single.map(|(i, (parameter, value))| Self {
                    axis: name.clone(),
                    effect: effect.name(),
                    key: parameter.key,
                    value,
                    before: evidence.half_widths.get(i).copied().filter(|half| *half > 0.0),
                    after: found.and_then(|(_, _, half_widths)| half_widths.get(i).copied()),
                });
                all.extend(expected.filter(|one| one.after != Some(0.0)));
            }
        }
        all
    }

    /// Whether the interval is known and no wider than a percentage of the value.
    #[must_use]
    pub fn is_within(&self, percent: f64) -> bool {
        self.after.is_some_and(|half| half <= 0.01 * percent * self.value.abs())
    }
}

impl Plan {
    /// Whether the motion decides a question, whichever candidate is the true one.
    #[must_use]
    pub fn decides(&self, question: usize) -> bool {
        let recognized = self.recognized(question);
        !recognized.is_empty() && recognized.iter().all(|is| *is)
    }

    /// Whether each candidate of a question is recognized if it is the true one.
    fn recognized(&self, question: usize) -> Vec<bool> {
        let all = self.asked.iter().zip(&self.is_recognized);
        all.filter(|(asked, _)| asked.question == question).map(|(_, is)| *is).collect()
    }

    /// Whether there is something that a motion could decide or measure.
    #[must_use]
    pub const fn has_goals(&self) -> bool {
        self.goals > 0
    }

    /// A sentence and tables.
    #[must_use]
    pub fn text(&self) -> String {
        let mut parts = vec![self.sentence()];
        parts.extend(self.questions_text());
        let imitations: Vec<String> = self.undecidable.iter().map(Undecidable::sentence).collect();
        if !imitations.is_empty() {
            parts.push(imitations.join("\n"));
        }
        if self.motion.is_some() {
            parts.extend(self.expected_text());
        }
        let unexplained: Vec<String> = self.unexplained.iter().map(Unexplained::sentence).collect();
        if !unexplained.is_empty() {
            parts.push(unexplained.join("\n"));
        }
        if !self.tried.is_empty() {
            let row = |one: &Tried| {
                format!("{:<64}{:>8.1}{:>5} of {}", one.name, one.seconds, one.reached, self.goals)
            };
            let head = format!("{:<64}{:>8}{:>10}", "motion tried", "s", "reached");
            parts
                .push(std::iter::once(head).chain(self.tried.iter().map(row)).collect::<Vec<_>>().join("\n"));
        }
        parts.join("\n\n")
    }

    fn sentence(&self) -> String {
        let Some(motion) = &self.motion else {
            return if self.has_goals() {
                match self.tried.len() {
                    0 => {
                        "No motion of this program is within the limits: a longer time is needed.".to_owned()
                    }
                    _ => "No motion within the limits decides anything.".to_owned(),
                }
            } else {
                "No motion is planned: no effect of the model leaves a question that another motion would answer.".to_owned()
            };
        };
        let name = format!("{}, {:.1} s", motion.name, motion.seconds);
        let count = self.questions.len();
        let decided = (0..count).filter(|question| self.decides(*question)).count();
        let is_all = self.tried.iter().any(|one| one.reached == self.goals);
        if is_all {
            return format!(
                "The shortest of the motions that were tried and reach every goal in simulation: {name}."
            );
        }
        format!(
            "No motion within the limits reaches every goal in simulation. The one that reaches most: {name}; it decides {decided} of {count}."
        )
    }

    fn questions_text(&self) -> Option<String> {
        let rows = |(number, question): (usize, &Question)| {
            let recognized = self.recognized(number);
            let row = |(i, candidate): (usize, &Effect)| {
                let axis = if i == 0 { question.axis.as_str() } else { "" };
                let said = match recognized.get(i) {
                    Some(true) => "named it, certain",
                    Some(false) => "did not decide",
                    None => "unknown",
                };
                let or = if i == 0 { "" } else { "or " };
                format!("{axis:<6}{:<40}{said}", format!("{or}{}", candidate.name()))
            };
            question.candidates.iter().enumerate().map(row).collect::<Vec<_>>()
        };
        let head = format!("{:<6}{:<40}where it was the cause, a simulated trace", "axis", "cause");
        let rows = std::iter::once(head).chain(self.questions.iter().enumerate().flat_map(rows));
        (!self.questions.is_empty()).then(|| rows.collect::<Vec<_>>().join("\n"))
    }

    fn expected_text(&self) -> Option<String> {
        let half = |half: Option<f64>| {
            half.map_or_else(|| "unknown".to_owned(), |half| format!("±{}", significant(half, 2)))
        };
        let row = |one: &Expected| {
            let name = format!("{} {} {}", one.axis, one.effect, one.key);
            format!(
                "{name:<56}{:>12}{:>12}{:>12}",
                significant(one.value, 4),
                half(one.before),
                half(one.after)
            )
        };
        let head = format!("{:<56}{:>12}{:>12}{:>12}", "95 % interval", "value", "now", "expected");
        let rows = std::iter::once(head).chain(self.expected.iter().map(row));
        (!self.expected.is_empty()).then(|| rows.collect::<Vec<_>>().join("\n"))
    }

    /// The plan as JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        let question = |(number, question): (usize, &Question)| {
            json!({
                "axis": question.axis,
                "candidates": question.names(),
                "is_recognized": self.recognized(number),
                "is_decided": self.decides(number),
            })
        };
        let undecidable = |one: &Undecidable| json!({"axis": one.axis, "effect": one.effect, "rivals": one.rivals, "decided_by": one.decided_by});
        let expected = |one: &Expected| {
            json!({
                "axis": one.axis, "effect": one.effect, "parameter": one.key, "value": one.value,
                "half_width_before": one.before, "half_width_expected": one.after,
            })
        };
        let tried = |one: &Tried| json!({"motion": one.name, "duration_s": one.seconds, "reached": one.reached, "goals": self.goals});
        json!({
            "motion": self.motion.as_ref().map(|one| &one.name),
            "duration_s": self.motion.as_ref().map(|one| one.seconds),
            "questions": self.questions.iter().enumerate().map(question).collect::<Vec<_>>(),
            "not_by_a_motion": self.undecidable.iter().map(undecidable).collect::<Vec<_>>(),
            "unexplained_um": self.unexplained.iter().map(|one| (one.axis.clone(), one.um.into())).collect::<serde_json::Map<_, _>>(),
            "expected": self.expected.iter().map(expected).collect::<Vec<_>>(),
            "tried": self.tried.iter().map(tried).collect::<Vec<_>>(),
        })
    }
}

impl Unexplained {
    fn sentence(&self) -> String {
        let Self { axis, um } = self;
        format!(
            "{axis}: the trace left {} µm rms unexplained, which no motion was simulated with: an effect beside it may stay ambiguous.",
            significant(*um, 2)
        )
    }
}

impl Undecidable {
    fn sentence(&self) -> String {
        let Self { axis, effect, rivals, decided_by } = self;
        format!(
            "{axis}: {effect} or {}: not decided by a motion, but by {}.",
            rivals.join(" or "),
            decided_by.join("; or ")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A period that is the lead of the screw is not fitted, and has no interval that a motion could narrow.
    #[test]
    fn only_fitted_values_have_an_expected_interval() {
        let text = r#"
            name = "m"
            sample_rate_hz = 1000.0
            [axis.x]
            lead_mm = 10.0
            [[axis.x.effect]]
            name = "pitch_cyclic"
            amplitude_um = 3.0
            period_mm = 10.0
            phase_rad = 0.5
            [[axis.x.evidence]]
            effect = "pitch_cyclic"
            certainty = "ambiguous"
            half_widths = [0.3, 0.0, 0.1]
        "#;
        let model = Machine::parse(text, "m.toml").unwrap();
        let effect = model.axis["x"].effect[0].clone();
        let answers = Answers {
            is_recognized: Vec::new(),
            found: vec![("x".to_owned(), effect, vec![0.2, 0.0, 0.04])],
        };
        let expected = Expected::of(&model, &answers);
        let rows: Vec<_> = expected.iter().map(|one| (one.key, one.before, one.after)).collect();
        assert_eq!(rows, [("amplitude_um", Some(0.3), Some(0.2)), ("phase_rad", Some(0.1), Some(0.04))]);
        // 0.2 of 3 is 6.7 %.
        assert!(expected[0].is_within(7.0) && !expected[0].is_within(6.0));
    }
}
