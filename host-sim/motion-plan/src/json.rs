//! The plan as JSON.

use serde::Serialize;

use crate::Plan;

/// The document of `plan --json`.
#[derive(Serialize)]
pub struct Document<'a> {
    seconds: f64,
    parts: &'a [String],
    pairs: Vec<Pair<'a>>,
    values: Vec<OfEffect<'a>>,
    not_by_motion: &'a [String],
    notes: &'a [String],
}

#[derive(Serialize)]
struct Pair<'a> {
    axis: &'a str,
    effects: [&'static str; 2],
    distance: f64,
    is_decided: bool,
}

#[derive(Serialize)]
struct OfEffect<'a> {
    name: &'a str,
    value: f64,
    half_width_before: Option<f64>,
    half_width_expected: Option<f64>,
    half_width_wanted: Option<f64>,
}

/// The document of a plan.
#[must_use]
pub fn of(plan: &Plan) -> Document<'_> {
    let pairs = plan.pairs.iter().map(|pair| Pair {
        axis: &pair.axis,
        effects: pair.effects,
        distance: pair.distance,
        is_decided: pair.is_decided,
    });
    let values = plan.values.iter().map(|value| OfEffect {
        name: &value.name,
        value: value.value,
        half_width_before: value.half_width_before,
        half_width_expected: value.half_width.filter(|_| plan.motion.is_some()),
        half_width_wanted: value.wanted,
    });
    Document {
        seconds: plan.seconds,
        parts: &plan.parts,
        pairs: pairs.collect(),
        values: values.collect(),
        not_by_motion: &plan.not_by_motion,
        notes: &plan.notes,
    }
}
