//! A trace from the JSON that `lost-motion trace --json` writes.

use std::collections::BTreeMap;

use files::error::{InputError, quoted};
use indexmap::IndexMap;
use jiff::civil::Date;
use serde::Deserialize;
use serde_json::Value;

use crate::record::{Cost, Figure, Group, Name, Names, Record, Trust, undated};

/// What a history needs of the JSON of a trace.
#[derive(Deserialize)]
struct Written {
    schema_version: u32,
    machine: Option<String>,
    circumstances: Option<Circumstances>,
    effects: Vec<Effect>,
    declared: Vec<Declared>,
    residual: Vec<Residual>,
    not_testable: Vec<NotTestable>,
    #[serde(default)]
    contour: Vec<Contour>,
    budget: Option<Budget>,
}

#[derive(Deserialize)]
struct Circumstances {
    serial: Option<String>,
    date: Option<String>,
    temperature_c: Option<f64>,
}

#[derive(Deserialize)]
struct Effect {
    name: String,
    axis: String,
    source: Option<String>,
    certainty: String,
    parameters: IndexMap<String, Parameter>,
}

type Interval = [Option<f64>; 2];

#[derive(Deserialize)]
#[serde(untagged)]
enum Parameter {
    One {
        value: f64,
        ci95: Interval,
    },
    Fitted {
        value: Vec<f64>,
        ci95: Vec<Interval>,
    },
    /// Lists that are not fitted, and what a later version may write.
    Other {},
}

#[derive(Deserialize)]
struct Declared {
    axis: String,
    key: String,
    fitted: f64,
    ci95: Option<Interval>,
}

#[derive(Deserialize)]
struct Residual {
    axis: String,
    channel: String,
    #[serde(flatten)]
    figures: BTreeMap<String, Value>,
}

#[derive(Deserialize)]
struct NotTestable {
    axis: String,
    effect: Option<String>,
}

#[derive(Deserialize)]
struct Contour {
    log: String,
    channel: String,
    rms_um: Option<f64>,
    #[serde(default)]
    circles: Vec<Circle>,
}

#[derive(Deserialize)]
struct Circle {
    circular_deviation_um: Option<f64>,
}

#[derive(Deserialize)]
struct Budget {
    motions: Vec<Motion>,
}

#[derive(Deserialize)]
struct Motion {
    name: String,
    whole_um: Sizes,
    causes: Vec<Cause>,
}

#[derive(Deserialize)]
struct Sizes {
    rms: f64,
    #[serde(rename = "G")]
    circular: Option<f64>,
}

#[derive(Deserialize)]
struct Cause {
    #[serde(rename = "cause")]
    name: String,
    axis: String,
    um: Sizes,
}

/// Whether a JSON text may be a trace: other results have no such keys.
fn is_trace(value: &Value) -> bool {
    ["schema_version", "verdict", "effects", "residual"].iter().all(|key| value.get(key).is_some())
}

/// A trace from its JSON, with its date where the file says it, else `day`; `None` if it is the JSON of something else.
///
/// # Errors
/// Text that is no JSON, a trace of another version, a trace without a date.
pub fn read(text: &str, source: &str, day: Option<Date>) -> Result<Option<Record>, InputError> {
    let value: Value =
        serde_json::from_str(text).map_err(|error| InputError::expected(source, "JSON", error))?;
    if !is_trace(&value) {
        return Ok(None);
    }
    let written: Written = serde_json::from_value(value)
        .map_err(|error| InputError::expected(source, "the JSON of `lost-motion trace --json`", error))?;
    if written.schema_version != 1 {
        let found = written.schema_version;
        return Err(InputError::expected(source, "schema_version 1", found).at_key("schema_version"));
    }
    let own = written.circumstances.as_ref().and_then(|circumstances| circumstances.date.as_deref());
    let own = own
        .map(|date| {
            let bad = |_| InputError::expected(source, "a date, as 2026-11-27", quoted(date));
            date.parse().map_err(bad)
        })
        .transpose()?;
    let day = own.or(day).ok_or_else(|| undated(source))?;
    Ok(Some(written.record(source, day)))
}

impl Written {
    fn record(self, source: &str, day: Date) -> Record {
        let costs = self.costs();
        let (serial, temperature_c) =
            self.circumstances.map_or((None, None), |own| (own.serial, own.temperature_c));
        let mut figures = IndexMap::new();
        let mut names = Names::default();
        for effect in self.effects {
            let of = names.of(&effect.axis, &effect.name, effect.source.as_deref());
            let certain = if effect.certainty == "certain" { Trust::Certain } else { Trust::Ambiguous };
            for (key, parameter) in effect.parameters {
                for (key, value, interval) in parameter.values(&key) {
                    let name = Name { group: Group::Effect, axis: effect.axis.clone(), of: of.clone(), key };
                    if let Some(figure) = fitted(value, Some(interval), certain) {
                        figures.insert(name, figure);
                    }
                }
            }
        }
        for Declared { axis, key, fitted: value, ci95 } in self.declared {
            let name = Name { group: Group::Declared, axis, of: String::new(), key };
            if let Some(figure) = fitted(value, ci95, Trust::Certain) {
                figures.insert(name, figure);
            }
        }
        for residual in &self.residual {
            figures.extend(residual.left());
        }
        figures.extend(self.contour.iter().flat_map(Contour::figures));
        figures.extend(self.budget.iter().flat_map(|budget| &budget.motions).flat_map(Motion::figures));
        let not_testable = self.not_testable.into_iter();
        let not_testable = not_testable.filter_map(|entry| Some((entry.axis, entry.effect?))).collect();
        let Self { machine, .. } = self;
        Record {
            source: source.to_owned(),
            day,
            machine,
            serial,
            temperature_c,
            figures,
            costs,
            not_testable,
        }
    }

    /// What each effect costs on the motion on which it costs most.
    fn costs(&self) -> BTreeMap<(String, String), Cost> {
        let mut costs: BTreeMap<(String, String), Cost> = BTreeMap::new();
        for motion in self.budget.iter().flat_map(|budget| &budget.motions) {
            let is_same = |a: &Cause, b: &Cause| (&a.axis, &a.name) == (&b.axis, &b.name);
            // Of two effects with one name, the budget does not tell which is which.
            let is_alone =
                |cause: &&Cause| motion.causes.iter().filter(|other| is_same(cause, other)).count() == 1;
            for cause in motion.causes.iter().filter(is_alone) {
                let cost = Cost { motion: motion.name.clone(), um_rms: cause.um.rms };
                let largest =
                    costs.entry((cause.axis.clone(), cause.name.clone())).or_insert_with(|| cost.clone());
                if cost.um_rms > largest.um_rms {
                    *largest = cost;
                }
            }
        }
        costs
    }
}

/// A fitted value; `None` for one that was not fitted, whose interval has no width.
fn fitted(value: f64, interval: Option<Interval>, trust: Trust) -> Option<Figure> {
    match interval {
        Some([Some(low), Some(high)]) if high > low => {
            Some(Figure { value, half_width: Some(0.5 * (high - low)), trust })
        }
        Some([Some(_), Some(_)]) => None,
        _ => Some(Figure { value, half_width: None, trust: Trust::NoInterval }),
    }
}

impl Parameter {
    /// Keys, values and intervals; those of a list are numbered from 1.
    fn values(self, key: &str) -> Vec<(String, f64, Interval)> {
        match self {
            Self::One { value, ci95 } => vec![(key.to_owned(), value, ci95)],
            Self::Fitted { value, ci95 } => {
                let numbered = |(index, (value, ci95))| (format!("{key}[{index}]"), value, ci95);
                (1..).zip(value.into_iter().zip(ci95)).map(numbered).collect()
            }
            Self::Other {} => Vec::new(),
        }
    }
}

fn exact(value: f64) -> Figure {
    Figure { value, half_width: None, trust: Trust::Certain }
}

impl Residual {
    /// What is left after the trace, of held-out logs where there are some.
    fn left(&self) -> Option<(Name, Figure)> {
        let (key, after) = self.figures.iter().find(|(key, _)| key.starts_with("after_"))?;
        let rms = ["validate", "fit"].into_iter().find_map(|part| after.get(part)?.as_f64())?;
        let key = format!("{}_{}", self.channel, key.strip_prefix("after_")?);
        let name = Name { group: Group::Residual, axis: self.axis.clone(), of: "residual".to_owned(), key };
        Some((name, exact(rms)))
    }
}

fn of_tool(of: &str, key: &str, value: Option<f64>) -> Option<(Name, Figure)> {
    let (axis, of, key) = ("tool".to_owned(), of.to_owned(), key.to_owned());
    Some((Name { group: Group::Tool, axis, of, key }, exact(value?)))
}

impl Contour {
    /// Contour error as it was measured at the tool.
    fn figures(&self) -> Vec<(Name, Figure)> {
        if self.channel != "tool" {
            return Vec::new();
        }
        let circular = self.circles.iter().filter_map(|circle| circle.circular_deviation_um);
        let of = format!("measured.{}", self.log);
        let figures = [of_tool(&of, "rms_um", self.rms_um), of_tool(&of, "G_um", circular.reduce(f64::max))];
        figures.into_iter().flatten().collect()
    }
}

impl Motion {
    /// Contour error as the model predicts it.
    fn figures(&self) -> Vec<(Name, Figure)> {
        let Self { name, whole_um, .. } = self;
        let figures = [of_tool(name, "rms_um", Some(whole_um.rms)), of_tool(name, "G_um", whole_um.circular)];
        figures.into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_with_one_name_are_numbered_and_share_no_cost() {
        let effect = |um: f64| {
            serde_json::json!({
                "name": "pitch_cyclic", "axis": "x", "certainty": "certain",
                "parameters": { "amplitude_um": { "value": um, "ci95": [um - 0.1, um + 0.1] } },
            })
        };
        let sizes = serde_json::json!({ "rms": 1.0, "G": null });
        let cause = |name: &str| serde_json::json!({ "cause": name, "axis": "x", "um": sizes });
        let causes = ["pitch_cyclic", "pitch_cyclic", "backlash"].map(cause);
        let trace = serde_json::json!({
            "schema_version": 1, "verdict": "explained", "effects": [effect(1.0), effect(2.0)], "declared": [],
            "residual": [], "not_testable": [],
            "budget": { "motions": [{ "name": "circle", "whole_um": sizes, "causes": causes }] },
        });
        let day = Date::constant(2026, 11, 27);
        let record = read(&trace.to_string(), "t.json", Some(day)).unwrap().unwrap();
        let names: Vec<String> = record.figures.keys().map(ToString::to_string).collect();
        assert_eq!(
            names,
            ["x.pitch_cyclic.amplitude_um", "x.pitch_cyclic#2.amplitude_um", "tool.circle.rms_um"]
        );
        let costs: Vec<&str> = record.costs.keys().map(|(_, effect)| effect.as_str()).collect();
        assert_eq!(costs, ["backlash"]);
    }
}
