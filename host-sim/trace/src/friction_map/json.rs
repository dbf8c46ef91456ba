//! What a map told, for programs.

use serde_json::{Map, Value, json};

use super::FrictionMap;
use super::fit::Fitted;
use super::law::{Term, viscous_key};
use super::search::{AS_GOOD, Errors, Explained, half_widths};
use super::unexplained::Unexplained;

/// A map has no machine and so no name of an axis.
const AXIS: &str = "map";

/// A number of a law with its name and the half width of its 95 % interval; without one it was not fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Key in the JSON.
    pub key: String,
    /// Value in the unit that the key says.
    pub value: f64,
    /// Half width.
    pub half_width: Option<f64>,
}

/// Coulomb and viscous friction of a law.
#[must_use]
pub fn declared(map: &FrictionMap, fitted: &Fitted) -> [Parameter; 2] {
    let half = half_widths(fitted);
    let (viscous, factor) = viscous_key("viscous", map.unit);
    let of = |key: String, i: usize, factor: f64| Parameter {
        key,
        value: factor * fitted.law.sizes[i],
        half_width: Some(factor * half[i]),
    };
    [of(format!("coulomb_{}", map.unit.force_key()), 0, 1.0), of(viscous, 1, factor)]
}

/// The numbers of a term of a law.
#[must_use]
pub fn parameters(map: &FrictionMap, fitted: &Fitted, index: usize) -> Vec<Parameter> {
    let (law, half) = (&fitted.law, half_widths(fitted));
    let term = law.terms[index];
    let ((size_key, factor), shape_key) = term.keys(map.unit);
    let size = Parameter {
        key: size_key,
        value: factor * law.sizes[index + 2],
        half_width: Some(factor * half[index + 2]),
    };
    let mut all = vec![size];
    if let Some(key) = shape_key {
        let shaped = law.terms[..index].iter().filter(|term| term.width() == 2).count();
        let shape = law.shapes[index];
        // The interval of a logarithm, taken as one of the number.
        let half_width = half.get(law.sizes.len() + shaped).map(|half| half * shape);
        all.push(Parameter { key, value: shape, half_width });
    }
    let fixed = |key: &str, value: f64| Parameter { key: key.to_owned(), value, half_width: None };
    match term {
        Term::Stribeck => all.push(fixed("exponent", 2.0)),
        Term::StribeckExponential | Term::StribeckAsymmetry => all.push(fixed("exponent", 1.0)),
        Term::Power => all.push(fixed(&format!("top_speed_{}", map.unit.speed_key()), law.top)),
        _ => {}
    }
    all
}

/// How much a found term lowered the error of left-out runs when it was added, percent of their rms.
#[must_use]
pub fn reduction_percent(explained: &Explained, term: Term) -> f64 {
    let rounds = explained.searched.rounds.iter();
    let added = rounds.filter_map(|round| round.added.map(|index| &round.candidates[index]));
    let share = added.into_iter().find(|candidate| candidate.term == term).map_or(0.0, |c| c.reduction);
    100.0 * (1.0 - (1.0 - share).max(0.0).sqrt())
}

/// Terms that left-out runs supported nearly as well as the one that was added: the map does not tell them apart.
/// What the law holds besides is none of them.
#[must_use]
pub fn rivals(explained: &Explained, term: Term) -> Vec<Term> {
    for round in &explained.searched.rounds {
        let Some(added) = round.added.map(|index| &round.candidates[index]) else { continue };
        if added.term != term {
            continue;
        }
        let count = round.candidates.len();
        let near = |c: &&super::search::Candidate| {
            let is_held = explained.searched.fitted.law.terms.iter().any(|held| held.name() == c.term.name());
            !is_held && c.is_supported(count) && 1.0 - c.reduction < AS_GOOD * (1.0 - added.reduction)
        };
        return round.candidates.iter().filter(near).map(|c| c.term).collect();
    }
    Vec::new()
}

/// The JSON of `trace --friction-map`: the shape of `trace --json`, `validate` being the runs left out.
#[must_use]
pub fn json(map: &FrictionMap, explained: &Explained, rest: Option<&Unexplained>) -> Value {
    let unit = map.unit.force_key();
    let keyed = |entries: Vec<(String, Value)>| Value::Object(entries.into_iter().collect());
    let errors = |e: &Errors| json!({"fit": e.fit, "validate": e.left_out, "ranges": e.ranges_left_out});
    let values = |all: &[Parameter]| -> Value {
        let one = |p: &Parameter| {
            let mut entry = Map::new();
            entry.insert("value".to_owned(), json!(p.value));
            if let Some(half) = p.half_width {
                entry.insert("ci95".to_owned(), json!([p.value - half, p.value + half]));
            }
            (p.key.clone(), Value::Object(entry))
        };
        keyed(all.iter().map(one).collect())
    };
    let fitted = &explained.searched.fitted;
    let effects: Vec<Value> = fitted
        .law
        .terms
        .iter()
        .enumerate()
        .map(|(i, &term)| {
            json!({
                "name": term.name(),
                "axis": AXIS,
                "channel": "force",
                "parameters": values(&parameters(map, fitted, i)),
                "validate_reduction_percent": reduction_percent(explained, term),
                "as_good": rivals(explained, term).into_iter().map(Term::name).collect::<Vec<_>>(),
            })
        })
        .collect();
    let residual = keyed(vec![
        ("channel".to_owned(), json!("force")),
        ("axis".to_owned(), json!(AXIS)),
        ("unit".to_owned(), json!(unit)),
        (format!("before_{unit}"), errors(&explained.before)),
        (format!("after_{unit}"), errors(&explained.after)),
        (format!("noise_{unit}"), json!(map.noise())),
        (format!("within_run_{unit}"), json!(map.ripple())),
    ]);
    let unexplained = rest.map(|rest| {
        keyed(vec![
            ("channel".to_owned(), json!("force")),
            ("axis".to_owned(), json!(AXIS)),
            (format!("rms_{unit}"), json!(rest.rms)),
            ("share_percent".to_owned(), json!(rest.share_percent)),
            ("variable".to_owned(), json!(rest.variable)),
        ])
    });
    let not_testable: Vec<Value> = explained
        .not_testable
        .iter()
        .map(|(term, needs)| json!({"channel": "force", "axis": AXIS, "effect": term.name(), "needs": needs}))
        .collect();
    json!({
        "residual": [residual],
        "declared": values(&declared(map, &explained.searched.declared)),
        "fitted": values(&declared(map, fitted)),
        "effects": effects,
        "unexplained": unexplained.into_iter().collect::<Vec<_>>(),
        "not_testable": not_testable,
        "runs": map.runs.len(),
        "runs_at_standstill": map.standing,
    })
}
