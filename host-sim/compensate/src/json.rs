//! The plan as JSON.

use serde_json::{Value, json};

use crate::plan::Plan;

/// `{"items": […], "not_compensated": […], "predicted": […]}`; see `docs/files.md`.
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
    json!({"items": items, "not_compensated": not, "predicted": predicted})
}
