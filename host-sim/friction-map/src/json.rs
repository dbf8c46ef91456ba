//! The result of a map as JSON, in the form of `trace --json`. `validate` is the error of runs left out.

use serde_json::{Map, Value, json};

use super::explain::{Errors, Explanation};
use super::map::FrictionMap;
use super::parameters::{Parameter, declared, of_term};
use super::residual_analysis::Residual;
use super::term::Term;

/// Name of the axis, which a map does not have.
const AXIS: &str = "map";

/// The JSON of `trace --friction-map`.
#[must_use]
pub fn json(map: &FrictionMap, explanation: &Explanation, residual: Option<&Residual>) -> Value {
    let selection = &explanation.selection;
    let unexplained: Vec<Value> = residual.iter().map(|residual| unexplained(map, residual)).collect();
    let not_testable = explanation.not_testable.iter();
    let not_testable: Vec<Value> = not_testable
        .map(|(term, needs)| json!({"channel": "force", "axis": AXIS, "effect": term.name(), "needs": needs}))
        .collect();
    json!({
        "residual": [errors(map, explanation)],
        "declared": values(&declared(map, &selection.declared)),
        "fitted": values(&declared(map, &selection.fitted)),
        "effects": effects(map, explanation),
        "unexplained": unexplained,
        "not_testable": not_testable,
        "runs": map.runs.len(),
        "runs_at_standstill": map.standstill_runs,
    })
}

fn object<const N: usize>(entries: [(String, Value); N]) -> Value {
    Value::Object(entries.into_iter().collect())
}

fn values(parameters: &[Parameter]) -> Value {
    let entry = |parameter: &Parameter| {
        let mut entry = Map::new();
        entry.insert("value".to_owned(), json!(parameter.value));
        if let Some(half) = parameter.half_width {
            entry.insert("ci95".to_owned(), json!([parameter.value - half, parameter.value + half]));
        }
        (parameter.key.clone(), Value::Object(entry))
    };
    Value::Object(parameters.iter().map(entry).collect())
}

fn effects(map: &FrictionMap, explanation: &Explanation) -> Vec<Value> {
    let fitted = &explanation.selection.fitted;
    let effect = |(i, &term): (usize, &Term)| {
        json!({
            "name": term.name(),
            "axis": AXIS,
            "channel": "force",
            "parameters": values(&of_term(map, fitted, i)),
            "validate_reduction_percent": explanation.reduction_percent(term),
            "as_good": explanation.equally_good(term).into_iter().map(Term::name).collect::<Vec<_>>(),
        })
    };
    fitted.law.terms.iter().enumerate().map(effect).collect()
}

fn errors(map: &FrictionMap, explanation: &Explanation) -> Value {
    let unit = map.unit.force_key();
    let errors = |e: &Errors| json!({"fit": e.fit, "validate": e.left_out, "ranges": e.ranges_left_out});
    object([
        ("channel".to_owned(), json!("force")),
        ("axis".to_owned(), json!(AXIS)),
        ("unit".to_owned(), json!(unit)),
        (format!("before_{unit}"), errors(&explanation.before)),
        (format!("after_{unit}"), errors(&explanation.after)),
        (format!("noise_{unit}"), json!(map.standard_error())),
        (format!("within_run_{unit}"), json!(map.deviation_within_runs())),
    ])
}

fn unexplained(map: &FrictionMap, residual: &Residual) -> Value {
    object([
        ("channel".to_owned(), json!("force")),
        ("axis".to_owned(), json!(AXIS)),
        (format!("rms_{}", map.unit.force_key()), json!(residual.rms)),
        ("share_percent".to_owned(), json!(residual.slow_percent)),
        ("variable".to_owned(), json!(residual.variable)),
    ])
}
