//! The result as JSON.

use serde_json::{Map, Value, json};

use super::Analysis;
use super::iso::Direction;
use super::part::Part;

/// The document of `circle --json`.
#[must_use]
pub fn of(analysis: &Analysis) -> Value {
    let Analysis { measured, figures, parts, residual_um, frame } = analysis;
    let f = figures.radial_um().map(|um| measured.has_nominal_radius.then_some(um));
    json!({
        "iso_230_4_um": {
            "G": figures.circular_um(),
            "F_min": f[0],
            "F_max": f[1],
            "H": figures.hysteresis_um,
            "G_b": figures.bidirectional_um,
        },
        "parts": parts.iter().map(part).collect::<Vec<Value>>(),
        "residual_um": residual_um,
        "channel": measured.channel,
        "axes": measured.axes,
        "radius_mm": frame.radius_mm,
        "speed_mm_s": frame.speed_mm_s,
        "directions": figures.directions.iter().map(direction).collect::<Vec<Value>>(),
        "notes": measured.notes,
    })
}

fn part(part: &Part) -> Value {
    let mut object = Map::new();
    object.insert("name".to_owned(), json!(part.name.word()));
    object.insert("axis".to_owned(), json!(part.axis));
    object.insert("um".to_owned(), json!(part.um));
    object.insert("ci95".to_owned(), json!(part.ci95));
    object.insert("certainty".to_owned(), json!(if part.is_certain() { "certain" } else { "ambiguous" }));
    object.insert("rivals".to_owned(), json!(part.rivals));
    if let Some(shape) = part.shape {
        object.insert("shape".to_owned(), json!(shape));
    }
    for detail in &part.details {
        object.insert(detail.key.to_owned(), json!({"value": detail.value, "ci95": detail.ci95}));
    }
    Value::Object(object)
}

fn direction(direction: &Direction) -> Value {
    json!({
        "direction": if direction.is_clockwise { "cw" } else { "ccw" },
        "turns": direction.turns,
        "covered_deg": direction.covered_deg,
        "G": direction.circular_um,
        "F_min": direction.radial_um[0],
        "F_max": direction.radial_um[1],
    })
}
