//! The plan as JSON.

use serde_json::{Value, json};

use crate::compensate::plan::Plan;
use crate::compensate::watched::Watched;

/// `{"items": […], "not_compensated": […], "predicted": […], "watched": […], "beyond_mapped": […], "assumed": […]}`; see `docs/files.md`.
#[must_use]
pub fn of(plan: &Plan) -> Value {
    let items: Vec<Value> = plan
        .items
        .iter()
        .map(|item| {
            json!({
                "effect": item.effect,
                "axis": item.axis,
                "does": item.does,
                "predicted_um": {"before": item.before_um, "after": item.after_um},
            })
        })
        .collect();
    let not: Vec<Value> = plan
        .not_compensated
        .iter()
        .map(|not| json!({"effect": not.effect, "axis": not.axis, "why": not.why, "instead": not.instead}))
        .collect();
    let predicted: Vec<Value> = plan.file.predicted.iter().map(|p| json!(p)).collect();
    let watched = |watched: &Watched| json!({"motion": watched.motion, "before_um": watched.before_um, "after_um": watched.after_um});
    let beyond = plan.beyond.iter().flat_map(|(motion, axes)| {
        axes.iter().map(move |axis| {
            json!({
                "motion": motion,
                "axis": axis.axis,
                "mapped_mm": axis.mapped_mm,
                "reached_mm": axis.reached_mm,
                "unknown": axis.what,
            })
        })
    });
    json!({
        "items": items,
        "not_compensated": not,
        "predicted": predicted,
        "watched": plan.watched.iter().map(watched).collect::<Vec<_>>(),
        "beyond_mapped": beyond.collect::<Vec<_>>(),
        "assumed": plan.assumed.iter().map(|assumed| json!({"axis": assumed.axis, "what": assumed.what})).collect::<Vec<_>>(),
    })
}
