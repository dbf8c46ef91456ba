//! The contour error as JSON, see `docs/files.md`.

use serde_json::{Map, Value, json};

use super::circle::{CircleDeviation, LapDeviation};
use super::corner::CornerDeviation;
use super::evaluation::{BlockError, ContourError};
use super::log_error::LogError;

/// All figures of a contour error. `axes` are the names of the axes.
#[must_use]
pub fn of(error: &ContourError, axes: &[String]) -> Value {
    let block =
        |block: &BlockError| json!({"block": block.block, "max_um": block.max_um, "rms_um": block.rms_um});
    json!({
        "max_um": error.max_um,
        "rms_um": error.rms_um,
        "noise_um": error.noise_um,
        "samples": error.samples,
        "is_along_axis": error.is_along_axis,
        "blocks": error.blocks.iter().map(block).collect::<Vec<_>>(),
        "circles": error.circles.iter().map(|circle| of_circle(circle, axes)).collect::<Vec<_>>(),
        "corners": error.corners.iter().map(|corner| of_corner(corner, axes)).collect::<Vec<_>>(),
    })
}

/// The key `contour` of `trace --json`: one entry for each log.
#[must_use]
pub fn of_logs(logs: &[LogError]) -> Value {
    let one = |log: &LogError| {
        let mut entry = of(&log.error, &log.axes);
        if let Some(entry) = entry.as_object_mut() {
            entry.insert("log".to_owned(), json!(log.log));
            entry.insert("channel".to_owned(), json!(log.channel.word()));
        }
        entry
    };
    logs.iter().map(one).collect()
}

fn of_circle(circle: &CircleDeviation, axes: &[String]) -> Value {
    let lap = |lap: &LapDeviation| {
        json!({
            "direction": if lap.is_clockwise { "clockwise" } else { "counter-clockwise" },
            "circular_deviation_um": lap.circular_um,
            "radial_deviation_um": {"min": lap.radial_um[0], "max": lap.radial_um[1]},
            "reversal_spikes_um": lap.spikes_um,
        })
    };
    json!({
        "axes": circle.plane.map(|axis| axes.get(axis)),
        "radius_mm": 1e3 * circle.radius,
        "circular_deviation_um": circle.circular_um(),
        "bidirectional_circular_deviation_um": circle.bidirectional_um,
        "circular_hysteresis_um": circle.hysteresis_um,
        "laps": circle.laps.iter().map(lap).collect::<Vec<_>>(),
    })
}

fn of_corner(corner: &CornerDeviation, axes: &[String]) -> Value {
    let position: Map<String, Value> =
        axes.iter().zip(corner.point).map(|(axis, m)| (axis.clone(), json!(1e3 * m))).collect();
    json!({
        "position_mm": position,
        "turn_deg": corner.turn_rad.to_degrees(),
        "overshoot_um": corner.overshoot_um,
        "rounding_um": corner.rounding_um,
    })
}
