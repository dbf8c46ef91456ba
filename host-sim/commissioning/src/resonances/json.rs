//! The resonances as JSON.

use serde_json::{Value, json};

use super::AxisResonances;

/// `{"source": …, "rate_hz": …, "axes": [{"axis": …, "step_hz": …, "peaks": […], "density": […]}]}`; see `docs/files.md`.
#[must_use]
pub fn of(source: &str, rate_hz: f64, axes: &[AxisResonances]) -> Value {
    let axis = |axis: &AxisResonances| {
        json!({
            "axis": axis.axis,
            "peaks": axis.peaks,
            "step_hz": axis.density.step_hz,
            "density_m2_per_s4_per_hz": axis.density.values,
        })
    };
    json!({"source": source, "rate_hz": rate_hz, "axes": axes.iter().map(axis).collect::<Vec<_>>()})
}
