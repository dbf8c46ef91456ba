//! The trace of one case compared with its true effects.

use serde_json::{Map, Value, json};

use super::case::Case;
use super::joint;
use super::judgement::Judgement;
use super::kind::Kind;
use super::outside::{self, Answer, ReportedFault};
use super::truth::Truth;
use files::error::InputError;

/// Largest error of the frequency of a described vibration, Hz.
const MAX_ERROR_HZ: f64 = 1.5;
/// Largest relative error of the period by which effects of one name are told apart.
const MAX_PERIOD_ERROR: f64 = 0.02;
/// Largest error of the position of a described defect, mm; the width of the defect, if that is larger.
const MAX_ERROR_MM: f64 = 3.0;

/// A parameter that was found, with its true value.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Name of the effect.
    pub effect: &'static str,
    /// Name of the parameter.
    pub parameter: &'static str,
    /// True value.
    pub truth: f64,
    /// Found value.
    pub value: f64,
    /// Ends of its 95 % confidence interval.
    pub ci95: [f64; 2],
}

impl Estimate {
    /// Absolute value of the relative error.
    #[must_use]
    pub fn error(&self) -> f64 {
        ((self.value - self.truth) / self.truth).abs()
    }

    /// Whether the interval contains the true value.
    #[must_use]
    pub fn is_covered(&self) -> bool {
        (self.ci95[0]..=self.ci95[1]).contains(&self.truth)
    }

    /// Whether the machine file determines it: the period follows from the lead and is not fitted.
    #[must_use]
    pub fn is_declared(&self) -> bool {
        self.parameter == "period_mm"
    }
}

/// The score of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Kind of the case.
    pub kind: Kind,
    /// Number of the case.
    pub number: u64,
    /// The true effects.
    pub truths: Vec<Truth>,
    /// Name and axis of the effects found, in the order of the trace.
    pub found: Vec<(String, String)>,
    /// The effects in the JSON of the trace.
    pub effects: Vec<Value>,
    /// For each effect from outside the catalogue, whether the trace describes it as unexplained.
    pub described: Vec<bool>,
    /// Parameters of the true effects that were found.
    pub estimates: Vec<Estimate>,
    /// Ratio of the rms residual after the search to the noise, on the held-out logs, by axis and channel.
    pub ratios: Vec<(String, f64)>,
    /// What the trace says about what is outside the textbook catalogue.
    pub answers: Vec<Answer>,
    /// Faults of the data that it reports.
    pub faults: Vec<ReportedFault>,
    /// What it states as certain, of the kinds that are judged by it.
    pub judgement: Judgement,
    /// Why the tracer refused the case, if it did.
    pub refusal: Option<String>,
}

impl Outcome {
    /// Scores the JSON of a trace of a case. Results of rotary axes are those of linear ones under other keys.
    #[must_use]
    pub fn of(case: &Case, trace: &Value) -> Self {
        let linear = (case.kind == Kind::Joint).then(|| joint::with_linear_keys(trace));
        let trace = linear.as_ref().unwrap_or(trace);
        Self::new(case.number, &case.truths, trace).with_kind(case.kind, &case.extras, trace)
    }

    /// The score of a case that the tracer refused: nothing was found.
    #[must_use]
    pub fn refused(case: &Case, why: &InputError) -> Self {
        Self { refusal: Some(why.to_string()), ..Self::of(case, &Value::Null) }
    }

    /// Adds the kind of the case and what is outside the textbook catalogue.
    pub(super) fn with_kind(mut self, kind: Kind, extras: &[Truth], trace: &Value) -> Self {
        let unexplained: Vec<String> =
            trace["unexplained"].as_array().into_iter().flatten().map(|u| string(u, "axis")).collect();
        self.kind = kind;
        self.judgement = Judgement::new(&self.truths, extras, trace);
        self.answers =
            extras.iter().map(|extra| Answer::new(extra, &self.found, &self.faults, &unexplained)).collect();
        let same = extras.iter().filter_map(outside::as_effect);
        self.estimates.extend(same.flat_map(|truth| estimates_of(&truth, &self.effects)).collect::<Vec<_>>());
        self
    }

    /// Scores the JSON of a trace of a case of the textbook kind.
    #[must_use]
    pub fn new(number: u64, truths: &[Truth], trace: &Value) -> Self {
        let entries = |key: &str| trace[key].as_array().cloned().unwrap_or_default();
        let effects = entries("effects");
        let unexplained = entries("unexplained");
        let found = effects.iter().map(|e| (string(e, "name"), string(e, "axis"))).collect();
        let described =
            truths.iter().filter(|t| t.is_outside()).map(|t| unexplained.iter().any(|u| describes(u, t)));
        let estimates = truths.iter().flat_map(|truth| estimates_of(truth, &effects));
        Self {
            kind: Kind::Textbook,
            number,
            answers: Vec::new(),
            judgement: Judgement::default(),
            refusal: None,
            faults: entries("data_faults").iter().map(ReportedFault::new).collect(),
            described: described.collect(),
            estimates: estimates.collect(),
            ratios: entries("residual").iter().filter_map(ratio).collect(),
            truths: truths.to_vec(),
            found,
            effects,
        }
    }

    /// True effects of the catalogue that were not found.
    #[must_use]
    pub fn missed(&self) -> Vec<&Truth> {
        let is_rival = |truth: &&Truth| {
            self.kind.is_judged() && !self.judgement.missed.iter().any(|missed| is_same(truth, missed))
        };
        let catalogued = self.truths.iter().filter(|truth| !truth.is_outside());
        catalogued.filter(|truth| !is_rival(truth) && !self.finds(truth)).collect()
    }

    /// Whether a true effect was found.
    #[must_use]
    pub(super) fn finds(&self, truth: &Truth) -> bool {
        (0..self.found.len()).any(|found| self.is_found_as(found, truth))
    }

    /// False effects: found but not true, and not accepted for something outside the catalogue. One that is found twice
    /// on its axis counts once.
    #[must_use]
    pub fn false_finds(&self) -> Vec<&(String, String)> {
        if self.kind.is_judged() {
            return self.judgement.sure_false.iter().chain(&self.judgement.unsure_false).collect();
        }
        let mut names: Vec<&(String, String)> = Vec::new();
        for index in self.false_indices() {
            let name = &self.found[index];
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// False effects that the trace does not call ambiguous.
    #[must_use]
    pub fn certain_false_finds(&self) -> Vec<&(String, String)> {
        let is_certain = |name: &&(String, String)| {
            let mut same = self.false_indices().filter(|index| self.found[*index] == **name);
            same.any(|index| string(&self.effects[index], "certainty") != "ambiguous")
        };
        self.false_finds().into_iter().filter(|found| is_certain(found)).collect()
    }

    /// The effects found that are neither true nor accepted for something outside the catalogue.
    fn false_indices(&self) -> impl Iterator<Item = usize> {
        let is_true = |found: usize| self.truths.iter().any(|truth| self.is_found_as(found, truth));
        let is_accepted = |(name, axis): &(String, String)| {
            self.answers.iter().any(|a| a.extra.axis == *axis && outside::is_accepted(a.extra.name, name))
        };
        (0..self.found.len()).filter(move |&found| !is_true(found) && !is_accepted(&self.found[found]))
    }

    /// Whether an effect found is a true one: by name, axis and, of a wave, period.
    fn is_found_as(&self, found: usize, truth: &Truth) -> bool {
        is_same(truth, &self.found[found]) && has_period(truth, &self.effects[found])
    }

    /// Reported faults of the data that are not there, by kind and axis, each once.
    #[must_use]
    pub fn false_faults(&self) -> Vec<&(String, String)> {
        let is_true = |(kind, axis): &(String, String)| {
            self.answers.iter().any(|a| a.extra.axis == axis && outside::is_name(a.extra.name, kind))
        };
        let mut names: Vec<_> = self.faults.iter().map(|fault| &fault.name).collect();
        names.sort_unstable();
        names.dedup();
        names.retain(|name| !is_true(name));
        names
    }

    /// What is outside the catalogue and counts, each with what the trace says about it.
    pub fn counted_answers(&self) -> impl Iterator<Item = &Answer> {
        self.answers.iter().filter(|answer| outside::counts(&answer.extra))
    }

    /// Effects that were found again on the same axis (latency of two channels, for example), unless they stand for
    /// something outside the catalogue. The score counts them once.
    #[must_use]
    pub fn duplicates(&self) -> usize {
        let is_answer = |(name, axis): &(String, String)| {
            self.answers.iter().any(|answer| answer.extra.axis == axis && answer.names.contains(name))
        };
        let is_true = |found: usize| self.truths.iter().any(|truth| self.is_found_as(found, truth));
        let is_duplicate = |i: &usize| {
            self.found[..*i].contains(&self.found[*i]) && is_true(*i) && !is_answer(&self.found[*i])
        };
        (0..self.found.len()).filter(is_duplicate).count()
    }

    /// Whether exactly the true effects of the catalogue were found.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        let is_judged_exact = !self.kind.is_judged() || self.judgement.is_exact();
        let is_complete = self.missed().is_empty() && self.false_finds().is_empty() && self.refusal.is_none();
        is_complete && is_judged_exact
    }

    /// Whether the machine has no undeclared effect.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.truths.is_empty() && self.answers.is_empty()
    }

    /// The first error or the gap of a case that is judged by what is stated as certain.
    #[must_use]
    pub fn subject(&self) -> Option<&'static str> {
        self.answers.first().filter(|_| self.kind.is_judged()).map(|answer| answer.extra.name)
    }

    /// The case in words: `case 3`, `offspec case 3`.
    #[must_use]
    pub fn name(&self) -> String {
        self.kind.case_words(self.number)
    }

    /// Effects from outside the catalogue, each with whether the trace describes it.
    pub fn outside(&self) -> impl Iterator<Item = (&Truth, bool)> {
        self.truths.iter().filter(|truth| truth.is_outside()).zip(self.described.iter().copied())
    }

    /// Its entry in the JSON of the self-test.
    #[must_use]
    pub fn json(&self) -> Value {
        let ratios: Map<String, Value> =
            self.ratios.iter().map(|(channel, ratio)| (channel.clone(), json!(ratio))).collect();
        json!({
            "kind": self.kind.name(),
            "case": self.number,
            "exact": self.is_exact(),
            "truth": self.truths.iter().map(Truth::json).collect::<Vec<_>>(),
            "found": self.effects,
            "outside_said": self.described,
            "after_over_noise": ratios,
            "outside": self.answers.iter().map(Answer::json).collect::<Vec<_>>(),
            "judgement": self.kind.is_judged().then(|| self.judgement.json()),
            "refused": self.refusal,
            "data_faults": self.faults.iter().map(|fault| fault.entry.clone()).collect::<Vec<_>>(),
        })
    }
}

/// Whether a found effect is a true one, by name and axis.
fn is_same(truth: &Truth, (name, axis): &(String, String)) -> bool {
    truth.name == name && truth.axis == axis
}

fn string(entry: &Value, key: &str) -> String {
    entry[key].as_str().unwrap_or_default().to_owned()
}

/// Whether an entry about an unexplained residual describes an effect from outside the catalogue.
fn describes(entry: &Value, truth: &Truth) -> bool {
    let near = |key: &str, truth_key: &str, tolerance: f64| {
        let pair = entry[key].as_f64().zip(truth.parameter(truth_key));
        pair.is_some_and(|(value, true_value)| (value - true_value).abs() < tolerance)
    };
    string(entry, "axis") == truth.axis
        && match (truth.name, string(entry, "variable").as_str()) {
            ("vibration", "time") => near("frequency_hz", "frequency_hz", MAX_ERROR_HZ),
            ("local_defect", "position") => {
                near("centre_mm", "centre_mm", MAX_ERROR_MM.max(truth.parameter("width_mm").unwrap_or(0.0)))
            }
            _ => false,
        }
}

/// Whether an effect found has the period of a true one, or one of them has no period.
fn has_period(truth: &Truth, entry: &Value) -> bool {
    let found = entry["parameters"]["period_mm"]["value"].as_f64();
    let pair = found.zip(truth.parameter("period_mm"));
    pair.is_none_or(|(found, period)| (found - period).abs() <= MAX_PERIOD_ERROR * period)
}

/// Parameters of a true effect in the effects found. Effects of one name on an axis are told apart by their period.
fn estimates_of(truth: &Truth, effects: &[Value]) -> Vec<Estimate> {
    let is_named =
        |entry: &&Value| string(entry, "name") == truth.name && string(entry, "axis") == truth.axis;
    let same = effects.iter().filter(is_named).filter(|entry| has_period(truth, entry));
    same.flat_map(|entry| estimates(truth, &entry["parameters"])).collect()
}

fn estimates(truth: &Truth, parameters: &Value) -> Vec<Estimate> {
    let estimate = |&(parameter, true_value): &(&'static str, f64)| {
        let entry = &parameters[parameter];
        let end = |index: usize| entry["ci95"][index].as_f64();
        Some(Estimate {
            effect: truth.name,
            parameter,
            truth: true_value,
            value: entry["value"].as_f64()?,
            ci95: [end(0)?, end(1)?],
        })
    };
    truth.parameters.iter().filter_map(estimate).collect()
}

/// Axis and channel (`x table`), and the ratio of residual to noise.
fn ratio(entry: &Value) -> Option<(String, f64)> {
    let unit = if entry.get("noise_n").is_some() { "n" } else { "um" };
    let noise = entry[format!("noise_{unit}")].as_f64().filter(|&noise| noise > 0.0)?;
    let after = entry[format!("after_{unit}")]["validate"].as_f64()?;
    Some((format!("{} {}", string(entry, "axis"), string(entry, "channel")), after / noise))
}

#[cfg(test)]
pub(super) mod tests;
