//! The margins as JSON.

use serde_json::{Value, json};

use super::axis_margins::{AxisMargins, LoopMargins, MarginLimits};
use super::margin::At;
use super::mechanics::Condition;

/// `{"limits": {…}, "axes": […]}`; see `docs/files.md`.
#[must_use]
pub fn of(axes: &[AxisMargins], limits: MarginLimits) -> Value {
    let axis = |axis: &AxisMargins| {
        json!({
            "axis": axis.axis,
            "velocity_loop": loop_margins(&axis.velocity),
            "position_loop": loop_margins(&axis.position),
            "position_gain_per_s": axis.position_gain_per_s,
            "highest_position_gain_per_s": axis.highest_position_gain_per_s,
        })
    };
    json!({
        "limits": {"gain_margin_db": limits.gain_db, "phase_margin_deg": limits.phase_deg},
        "axes": axes.iter().map(axis).collect::<Vec<_>>(),
    })
}

/// One loop; a margin that does not exist is `null`.
#[must_use]
pub fn loop_margins(margins: &LoopMargins) -> Value {
    let one = |margin: Option<(At, Condition)>| {
        margin
            .map(|(at, condition)| json!({"value": at.value, "at_hz": at.hz, "condition": condition.name()}))
    };
    json!({
        "stable": margins.unstable.is_none(),
        "gain_margin_db": one(margins.gain_db),
        "phase_margin_deg": one(margins.phase_deg),
    })
}
