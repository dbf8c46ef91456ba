//! What a trace states as certain, compared with the truth: for the kinds `sensors` and `sparse`.

use serde_json::{Value, json};

use super::accepted;
use super::outside::{self, Named};
use super::truth::Truth;

/// Half-widths of its interval, and fraction of the truth, by which a certain value is at least wrong.
const MIN_HALF_WIDTHS: f64 = 3.0;
const MIN_RELATIVE: f64 = 0.05;

/// The judgement of a trace. All pairs are name and axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judgement {
    /// Certain names that are neither true nor accepted.
    pub sure_false: Vec<Named>,
    /// Such names that are called ambiguous, without a true or accepted name among the rivals.
    pub unsure_false: Vec<Named>,
    /// True effects that are neither a name nor a rival.
    pub missed: Vec<Named>,
    /// Declared values called beyond their tolerance that are not.
    pub false_statements: Vec<Named>,
    /// Certain true names with a value far outside its interval.
    pub wrong_values: Vec<Named>,
    /// Errors of the chain that were given an accepted name, also as a rival.
    pub named: Vec<Named>,
    /// Errors that were named, or whose axis is said to be unexplained, faulty or not described by the model.
    pub said: Vec<Named>,
    /// `explained`, `unexplained` or `model_does_not_fit`.
    pub verdict: String,
}

impl Judgement {
    /// Compares the JSON of a trace with the true effects and the other errors of the case.
    #[must_use]
    pub fn new(truths: &[Truth], extras: &[Truth], trace: &Value) -> Self {
        let entries = |key: &str| trace[key].as_array().cloned().unwrap_or_default();
        let effects = entries("effects");
        let case = Known { truths, extras };
        let is_false = |effect: &&Value| !names(effect).iter().any(|name| case.is_right(name, effect));
        let (sure, unsure): (Vec<&Value>, Vec<&Value>) =
            effects.iter().filter(is_false).partition(|e| is_certain(e));
        let is_named = |extra: &&Truth| {
            let of_axis = effects.iter().filter(|effect| text(effect, "axis") == extra.axis);
            let faults = entries("data_faults");
            let mut kinds = faults.iter().filter(|fault| text(fault, "axis") == extra.axis);
            of_axis.flat_map(names).any(|name| outside::is_name(extra.name, &name))
                || kinds.any(|fault| outside::is_name(extra.name, &text(fault, "kind")))
        };
        let verdict = text(trace, "verdict");
        let axes: Vec<String> = ["unexplained", "data_faults"]
            .iter()
            .flat_map(|key| entries(key))
            .map(|e| text(&e, "axis"))
            .collect();
        let is_said = |extra: &&Truth| {
            is_named(extra) || axes.iter().any(|axis| axis == extra.axis) || verdict == "model_does_not_fit"
        };
        let is_missed = |truth: &&Truth| {
            let mut of_axis = effects.iter().filter(|effect| text(effect, "axis") == truth.axis);
            !truth.is_outside() && !of_axis.any(|effect| names(effect).iter().any(|name| name == truth.name))
        };
        let certain = effects.iter().filter(|effect| is_certain(effect));
        let declared = entries("declared");
        Self {
            sure_false: pairs(sure),
            unsure_false: pairs(unsure),
            missed: truths.iter().filter(is_missed).map(pair).collect(),
            false_statements: declared
                .iter()
                .filter(|entry| case.is_false_statement(entry))
                .map(statement)
                .collect(),
            wrong_values: pairs(certain.filter(|effect| case.has_wrong_value(effect)).collect()),
            named: extras.iter().filter(is_named).map(pair).collect(),
            said: extras.iter().filter(is_said).map(pair).collect(),
            verdict,
        }
    }

    /// Whether every true effect is found and no name, value or statement is false.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.missed.is_empty() && self.unsure_false.is_empty() && !self.is_surely_false()
    }

    /// Whether something false is stated as certain.
    #[must_use]
    pub fn is_surely_false(&self) -> bool {
        [&self.sure_false, &self.false_statements, &self.wrong_values].iter().any(|list| !list.is_empty())
    }

    /// Its entry in the JSON of the self-test.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "sure_false": self.sure_false,
            "unsure_false": self.unsure_false,
            "missed": self.missed,
            "false_statements": self.false_statements,
            "wrong_values": self.wrong_values,
            "named": self.named,
            "said": self.said,
            "verdict": self.verdict,
        })
    }
}

/// What is true of a case.
struct Known<'a> {
    truths: &'a [Truth],
    extras: &'a [Truth],
}

impl Known<'_> {
    /// Whether a name, on the axis of an effect, is true or accepted.
    fn is_right(&self, name: &str, effect: &Value) -> bool {
        let axis = text(effect, "axis");
        let is_of = |truth: &&Truth| truth.axis == axis && is_of_form(truth, effect);
        self.truths.iter().filter(is_of).any(|truth| truth.name == name)
            || self.extras.iter().filter(is_of).any(|extra| outside::is_accepted(extra.name, name))
    }

    /// Whether a declared value is called beyond its tolerance, as a certain statement and without cause.
    fn is_false_statement(&self, entry: &Value) -> bool {
        let (axis, key) = (text(entry, "axis"), text(entry, "key"));
        let mut causes = self.truths.iter().chain(self.extras).filter(|truth| truth.axis == axis);
        entry["beyond_tolerance"] == true
            && is_certain(entry)
            && !causes.any(|truth| accepted::excuses(truth.name, &key))
    }

    /// Whether the interval of a parameter of a true effect is far from its true value.
    fn has_wrong_value(&self, effect: &Value) -> bool {
        let (name, axis) = (text(effect, "name"), text(effect, "axis"));
        let truths = self.truths.iter().filter(|truth| truth.name == name && truth.axis == axis);
        let is_wrong = |&(key, true_value): &(&str, f64)| {
            let found = &effect["parameters"][key];
            let end = |index: usize| found["ci95"][index].as_f64();
            let Some(((value, low), high)) = found["value"].as_f64().zip(end(0)).zip(end(1)) else {
                return false;
            };
            let error = (value - true_value).abs();
            error > MIN_HALF_WIDTHS * 0.5 * (high - low) && error > MIN_RELATIVE * true_value.abs()
        };
        // Of several with one name, the periods tell which is meant; each case has one.
        truths.flat_map(|truth| &truth.parameters).filter(|(key, _)| *key != "period_mm").any(is_wrong)
    }
}

/// Whether an effect that is called certain says of the damper of a mode what is true: without the key it acts against the ground.
fn is_of_form(truth: &Truth, effect: &Value) -> bool {
    const KEY: &str = "damped_against";
    let true_value = truth.reference.and_then(|(key, value)| (key == KEY).then_some(value));
    !is_certain(effect) || effect[KEY].as_str() == true_value
}

/// An effect's name and its rivals.
fn names(effect: &Value) -> Vec<String> {
    let rivals = effect["rivals"].as_array().into_iter().flatten().filter_map(Value::as_str);
    [text(effect, "name")].into_iter().chain(rivals.map(str::to_owned)).collect()
}

fn is_certain(entry: &Value) -> bool {
    entry["certainty"] != "ambiguous"
}

fn pairs(effects: Vec<&Value>) -> Vec<Named> {
    effects.into_iter().map(|effect| (text(effect, "name"), text(effect, "axis"))).collect()
}

fn pair(truth: &Truth) -> Named {
    (truth.name.to_owned(), truth.axis.to_owned())
}

fn statement(entry: &Value) -> Named {
    (text(entry, "key"), text(entry, "axis"))
}

fn text(entry: &Value, key: &str) -> String {
    entry[key].as_str().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::score::tests::truth;
    use super::*;

    fn found(name: &str, certainty: &str, rivals: &[&str]) -> Value {
        json!({"name": name, "axis": "x", "certainty": certainty, "rivals": rivals, "parameters": {}})
    }

    fn judged(truths: &[Truth], extras: &[Truth], effects: &[Value]) -> Judgement {
        Judgement::new(truths, extras, &json!({"effects": effects, "verdict": "explained"}))
    }

    #[test]
    fn a_false_name_is_sure_unless_it_is_ambiguous_and_none_if_a_rival_is_right() {
        let rotated = [truth("probe_rotated", "x", &[])];
        let of = |certainty: &str, rivals: &[&str]| {
            judged(&[], &rotated, &[found("squareness", certainty, rivals)])
        };
        let name = vec![("squareness".to_owned(), "x".to_owned())];
        assert_eq!(of("certain", &[]).sure_false, name);
        assert_eq!(of("ambiguous", &["straightness"]).unsure_false, name);
        let with_rival = of("ambiguous", &["probe_rotation"]);
        assert!(with_rival.is_exact() && with_rival.named.len() == 1);
        let right = judged(&[], &rotated, &[found("probe_rotation", "certain", &[])]);
        assert!(right.is_exact() && right.named.len() == 1);
        assert!(judged(&[], &rotated, &[]).named.is_empty());
    }

    /// A certain damper at the ground where it is at the table is false, and the other way round; without certainty it is not.
    #[test]
    fn the_wrong_damper_is_false_if_it_is_certain() {
        let reference = Some(("damped_against", "table"));
        let on_table = [Truth { reference, ..truth("mode_on_table", "x", &[]) }];
        let two = [truth("two_modes", "x", &[])];
        let mode = |certainty: &str, is_on_table: bool| {
            let mut effect = found("resonance", certainty, &[]);
            if is_on_table {
                effect["damped_against"] = json!("table");
            }
            effect
        };
        for (extras, is_on_table) in [(&on_table, true), (&two, false)] {
            let is_false =
                |certainty: &str, said: bool| judged(&[], extras, &[mode(certainty, said)]).is_surely_false();
            assert!(!is_false("certain", is_on_table) && is_false("certain", !is_on_table));
            assert!(!is_false("ambiguous", !is_on_table));
        }
    }

    #[test]
    fn a_true_effect_among_the_rivals_is_found() {
        let backlash = [truth("backlash", "x", &[("width_um", 12.0)])];
        assert!(judged(&backlash, &[], &[found("lost_motion", "ambiguous", &["backlash"])]).is_exact());
        assert_eq!(judged(&backlash, &[], &[]).missed, [("backlash".to_owned(), "x".to_owned())]);
    }

    #[test]
    fn a_certain_value_far_outside_its_interval_is_wrong() {
        let backlash = [truth("backlash", "x", &[("width_um", 12.0)])];
        let wide = |value: f64, half: f64, certainty: &str| {
            let mut effect = found("backlash", certainty, &[]);
            effect["parameters"] =
                json!({"width_um": {"value": value, "ci95": [value - half, value + half]}});
            judged(&backlash, &[], &[effect]).wrong_values.len()
        };
        // 15.9 ± 0.1 where 12 is true; 12.3 is within 5 %, 15.9 ± 2 within three half-widths.
        let counts = [wide(15.9, 0.1, "certain"), wide(12.3, 0.01, "certain"), wide(15.9, 2.0, "certain")];
        assert_eq!((counts, wide(15.9, 0.1, "ambiguous")), ([1, 0, 0], 0));
    }

    #[test]
    fn a_declared_value_within_its_tolerance_must_not_be_called_beyond_it() {
        let of = |truths: &[Truth], key: &str, beyond: bool| {
            let declared = json!([{"axis": "x", "key": key, "beyond_tolerance": beyond}]);
            let trace = json!({"effects": [], "declared": declared});
            Judgement::new(truths, &[], &trace).false_statements.len()
        };
        let windup = [truth("windup", "x", &[])];
        assert_eq!(of(&[], "table_mass_kg", true), 1);
        assert_eq!(of(&[], "table_mass_kg", false), 0);
        assert_eq!(of(&windup, "stiffness_n_per_um", true), 0);
        assert_eq!(of(&windup, "table_mass_kg", true), 1);
    }
}
