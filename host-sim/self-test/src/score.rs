//! The trace of one case compared with its true effects.

use serde_json::{Map, Value, json};

use super::truth::Truth;

/// Largest error of the frequency of a described vibration, Hz.
const MAX_ERROR_HZ: f64 = 1.5;
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
}

impl Outcome {
    /// Scores the JSON of a trace.
    #[must_use]
    pub fn new(number: u64, truths: &[Truth], trace: &Value) -> Self {
        let entries = |key: &str| trace[key].as_array().cloned().unwrap_or_default();
        let effects = entries("effects");
        let unexplained = entries("unexplained");
        let found = effects.iter().map(|e| (string(e, "name"), string(e, "axis"))).collect();
        let described =
            truths.iter().filter(|t| t.is_outside()).map(|t| unexplained.iter().any(|u| describes(u, t)));
        let estimates = truths.iter().flat_map(|truth| {
            let same =
                effects.iter().filter(|e| string(e, "name") == truth.name && string(e, "axis") == truth.axis);
            same.flat_map(|entry| estimates(truth, &entry["parameters"])).collect::<Vec<_>>()
        });
        Self {
            number,
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
        let catalogued = self.truths.iter().filter(|truth| !truth.is_outside());
        catalogued.filter(|truth| !self.found.iter().any(|found| is_same(truth, found))).collect()
    }

    /// False effects: found but not true.
    #[must_use]
    pub fn false_finds(&self) -> Vec<&(String, String)> {
        self.found.iter().filter(|found| !self.truths.iter().any(|truth| is_same(truth, found))).collect()
    }

    /// Effects that were found again on the same axis (latency of two channels, for example). The score counts them once.
    #[must_use]
    pub fn duplicates(&self) -> usize {
        let is_duplicate = |i: &usize| self.found[..*i].contains(&self.found[*i]);
        (0..self.found.len()).filter(is_duplicate).count()
    }

    /// Whether exactly the true effects of the catalogue were found.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.missed().is_empty() && self.false_finds().is_empty()
    }

    /// Whether the machine has no undeclared effect.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.truths.is_empty()
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
            "case": self.number,
            "exact": self.is_exact(),
            "truth": self.truths.iter().map(Truth::json).collect::<Vec<_>>(),
            "found": self.effects,
            "outside_said": self.described,
            "after_over_noise": ratios,
        })
    }
}

/// Whether a found effect is a true one, by name and axis.
pub(super) fn is_same(truth: &Truth, (name, axis): &(String, String)) -> bool {
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
pub(super) mod tests {
    use super::*;

    pub fn truth(name: &'static str, axis: &'static str, parameters: &[(&'static str, f64)]) -> Truth {
        Truth { name, axis, parameters: parameters.to_vec(), reference: None, phase_rad: 0.0 }
    }

    pub fn found(name: &str, axis: &str, parameters: &Value) -> Value {
        json!({"name": name, "axis": axis, "parameters": parameters})
    }

    #[test]
    fn a_case_is_exact_if_all_names_and_axes_are_right() {
        let truths = [truth("backlash", "x", &[("width_um", 10.0)]), truth("squareness", "x", &[])];
        let named = |effects: &[Value]| Outcome::new(1, &truths, &json!({"effects": effects}));
        let both = [found("squareness", "x", &json!({})), found("backlash", "x", &json!({}))];
        assert!(named(&both).is_exact());
        let wrong_axis = [both[0].clone(), found("backlash", "y", &json!({}))];
        let outcome = named(&wrong_axis);
        assert!(!outcome.is_exact());
        assert_eq!(outcome.missed(), [&truths[0]]);
        assert_eq!(outcome.false_finds(), [&("backlash".to_owned(), "y".to_owned())]);
        assert!(!named(&both[..1]).is_exact());
    }

    #[test]
    fn an_effect_from_outside_the_catalogue_must_be_described() {
        let truths = [
            truth("vibration", "x", &[("frequency_hz", 119.0)]),
            truth("local_defect", "y", &[("centre_mm", 10.0), ("width_mm", 8.0)]),
        ];
        let described = |unexplained: Value| {
            let outcome = Outcome::new(1, &truths, &json!({"effects": [], "unexplained": unexplained}));
            assert!(outcome.is_exact() && !outcome.is_clean());
            outcome.described
        };
        let time = |hz: f64| json!({"axis": "x", "variable": "time", "frequency_hz": hz});
        let position = |mm: f64| json!({"axis": "y", "variable": "position", "centre_mm": mm});
        assert_eq!(described(json!([time(120.4), position(17.9)])), [true, true]);
        assert_eq!(described(json!([time(120.6), position(18.1)])), [false, false]);
        assert_eq!(described(json!([])), [false, false]);
    }

    #[test]
    fn errors_are_relative_and_coverage_is_that_of_the_interval() {
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
    fn ratios_are_those_of_the_held_out_logs() {
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
