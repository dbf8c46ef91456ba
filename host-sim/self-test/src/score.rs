//! What a trace made of one case, held against the truth as the project's `score.py` does.

use serde_json::{Map, Value, json};

use super::truth::Truth;

/// A frequency is right within this, Hz.
const SAME_HZ: f64 = 1.5;
/// A place is right within the width of the defect, or within this, mm.
const SAME_MM: f64 = 3.0;

/// A parameter that was found, beside its truth.
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
    /// Error over truth, not negative.
    #[must_use]
    pub fn error(&self) -> f64 {
        ((self.value - self.truth) / self.truth).abs()
    }

    /// Whether the interval holds the truth.
    #[must_use]
    pub fn is_covered(&self) -> bool {
        (self.ci95[0]..=self.ci95[1]).contains(&self.truth)
    }

    /// Whether the machine file gave it away: the lead says the period, which no fit moves.
    #[must_use]
    pub fn is_given(&self) -> bool {
        self.parameter == "period_mm"
    }
}

/// A case and what came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Of the case.
    pub number: u64,
    /// What there was.
    pub truths: Vec<Truth>,
    /// Name and axis of what was found, in the order of the trace.
    pub found: Vec<(String, String)>,
    /// The entries of the trace, for the record.
    pub effects: Vec<Value>,
    /// Of each effect from outside the catalogue, whether the trace says that it is there and what it follows.
    pub said: Vec<bool>,
    /// Of what was rightly found.
    pub estimates: Vec<Estimate>,
    /// Residual after over noise on the logs that were not fitted, by channel.
    pub ratios: Vec<(String, f64)>,
}

impl Outcome {
    /// Scores the JSON of a trace.
    #[must_use]
    pub fn new(number: u64, truths: &[Truth], trace: &Value) -> Self {
        let entries = |key: &str| trace[key].as_array().cloned().unwrap_or_default();
        let effects = entries("effects");
        let unexplained = entries("unexplained");
        let found = effects.iter().map(|e| (word(e, "name"), word(e, "axis"))).collect();
        let said = truths.iter().filter(|t| t.is_outside()).map(|t| unexplained.iter().any(|u| says(u, t)));
        let estimates = truths.iter().flat_map(|truth| {
            let same =
                effects.iter().filter(|e| word(e, "name") == truth.name && word(e, "axis") == truth.axis);
            same.flat_map(|entry| estimates(truth, &entry["parameters"])).collect::<Vec<_>>()
        });
        Self {
            number,
            said: said.collect(),
            estimates: estimates.collect(),
            ratios: entries("residual").iter().filter_map(ratio).collect(),
            truths: truths.to_vec(),
            found,
            effects,
        }
    }

    /// Effects of the catalogue that were there and are not found.
    #[must_use]
    pub fn missed(&self) -> Vec<&Truth> {
        let catalogued = self.truths.iter().filter(|truth| !truth.is_outside());
        catalogued.filter(|truth| !self.found.iter().any(|found| is_same(truth, found))).collect()
    }

    /// Effects that were found and are not there.
    #[must_use]
    pub fn false_ones(&self) -> Vec<&(String, String)> {
        self.found.iter().filter(|found| !self.truths.iter().any(|truth| is_same(truth, found))).collect()
    }

    /// Effects that were found more than once on an axis (two channels late, say). The score takes them for one.
    #[must_use]
    pub fn doubled(&self) -> usize {
        let again = |i: &usize| self.found[..*i].contains(&self.found[*i]);
        (0..self.found.len()).filter(again).count()
    }

    /// Whether exactly the effects of the catalogue that were there were found.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.missed().is_empty() && self.false_ones().is_empty()
    }

    /// Whether the machine was as declared.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.truths.is_empty()
    }

    /// Effects from outside the catalogue, each with whether the trace says what it follows.
    pub fn outside(&self) -> impl Iterator<Item = (&Truth, bool)> {
        self.truths.iter().filter(|truth| truth.is_outside()).zip(self.said.iter().copied())
    }

    /// As it stands in the JSON of the self-test.
    #[must_use]
    pub fn json(&self) -> Value {
        let ratios: Map<String, Value> =
            self.ratios.iter().map(|(channel, ratio)| (channel.clone(), json!(ratio))).collect();
        json!({
            "case": self.number,
            "exact": self.is_exact(),
            "truth": self.truths.iter().map(Truth::json).collect::<Vec<_>>(),
            "found": self.effects,
            "outside_said": self.said,
            "after_over_noise": ratios,
        })
    }
}

/// Name and axis make an effect the same.
pub(super) fn is_same(truth: &Truth, (name, axis): &(String, String)) -> bool {
    truth.name == name && truth.axis == axis
}

fn word(entry: &Value, key: &str) -> String {
    entry[key].as_str().unwrap_or_default().to_owned()
}

/// Whether an entry about what stays unexplained describes an effect from outside the catalogue.
fn says(entry: &Value, truth: &Truth) -> bool {
    let near = |key: &str, truth_key: &str, tolerance: f64| {
        let pair = entry[key].as_f64().zip(truth.parameter(truth_key));
        pair.is_some_and(|(said, true_value)| (said - true_value).abs() < tolerance)
    };
    word(entry, "axis") == truth.axis
        && match (truth.name, word(entry, "variable").as_str()) {
            ("vibration", "time") => near("frequency_hz", "frequency_hz", SAME_HZ),
            ("local_defect", "position") => {
                near("centre_mm", "centre_mm", SAME_MM.max(truth.parameter("width_mm").unwrap_or(0.0)))
            }
            _ => false,
        }
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

/// `x table` and the like, and by how much its residual exceeds the noise.
fn ratio(entry: &Value) -> Option<(String, f64)> {
    let unit = if entry.get("noise_n").is_some() { "n" } else { "um" };
    let noise = entry[format!("noise_{unit}")].as_f64().filter(|&noise| noise > 0.0)?;
    let after = entry[format!("after_{unit}")]["validate"].as_f64()?;
    Some((format!("{} {}", word(entry, "axis"), word(entry, "channel")), after / noise))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub fn truth(name: &'static str, axis: &'static str, parameters: &[(&'static str, f64)]) -> Truth {
        Truth { name, axis, parameters: parameters.to_vec(), word: None }
    }

    pub fn found(name: &str, axis: &str, parameters: &Value) -> Value {
        json!({"name": name, "axis": axis, "parameters": parameters})
    }

    #[test]
    fn the_set_has_to_be_exact() {
        let truths = [truth("backlash", "x", &[("width_um", 10.0)]), truth("squareness", "x", &[])];
        let named = |effects: &[Value]| Outcome::new(1, &truths, &json!({"effects": effects}));
        let both = [found("squareness", "x", &json!({})), found("backlash", "x", &json!({}))];
        assert!(named(&both).is_exact());
        let wrong_axis = [both[0].clone(), found("backlash", "y", &json!({}))];
        let outcome = named(&wrong_axis);
        assert!(!outcome.is_exact());
        assert_eq!(outcome.missed(), [&truths[0]]);
        assert_eq!(outcome.false_ones(), [&("backlash".to_owned(), "y".to_owned())]);
        assert!(!named(&both[..1]).is_exact());
    }

    #[test]
    fn an_effect_from_outside_is_no_part_of_the_set_but_has_to_be_said() {
        let truths = [
            truth("vibration", "x", &[("frequency_hz", 119.0)]),
            truth("local_defect", "y", &[("centre_mm", 10.0), ("width_mm", 8.0)]),
        ];
        let said = |unexplained: Value| {
            let outcome = Outcome::new(1, &truths, &json!({"effects": [], "unexplained": unexplained}));
            assert!(outcome.is_exact() && !outcome.is_clean());
            outcome.said
        };
        let time = |hz: f64| json!({"axis": "x", "variable": "time", "frequency_hz": hz});
        let place = |mm: f64| json!({"axis": "y", "variable": "position", "centre_mm": mm});
        assert_eq!(said(json!([time(120.4), place(17.9)])), [true, true]);
        assert_eq!(said(json!([time(120.6), place(18.1)])), [false, false]);
        assert_eq!(said(json!([])), [false, false]);
    }

    #[test]
    fn errors_are_relative_and_intervals_hold_the_truth_or_not() {
        let truths = [truth("backlash", "x", &[("width_um", 10.0)])];
        let width = |value: f64, ci95: [f64; 2]| {
            let effects = [found("backlash", "x", &json!({"width_um": {"value": value, "ci95": ci95}}))];
            Outcome::new(1, &truths, &json!({"effects": effects})).estimates.remove(0)
        };
        let inside = width(9.5, [8.9, 10.1]);
        assert!((inside.error() - 0.05).abs() < 1e-12);
        assert!(inside.is_covered());
        assert!(!width(9.5, [9.4, 9.6]).is_covered());
    }

    #[test]
    fn ratios_are_of_the_logs_that_were_not_fitted() {
        let residual = json!([
            {"axis": "x", "channel": "table", "after_um": {"fit": 9.0, "validate": 0.3}, "noise_um": 0.2},
            {"axis": "y", "channel": "force", "after_n": {"fit": 9.0, "validate": 4.0}, "noise_n": 2.0},
        ]);
        let outcome = Outcome::new(1, &[], &json!({"residual": residual, "effects": []}));
        assert_eq!(outcome.ratios[1], ("y force".to_owned(), 2.0));
        assert!((outcome.ratios[0].1 - 1.5).abs() < 1e-12);
        assert!(outcome.is_clean() && outcome.is_exact());
    }
}
