//! The contour error as JSON, see `docs/files.md`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::circle::{CircleDeviation, LapDeviation};
use super::corner::CornerDeviation;
use super::evaluation::BlockError;
use super::log_error::LogError;

/// The contour error of a log as it was logged.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "ContourError")]
pub struct OfLog {
    /// The log.
    log: String,
    /// The position that was measured: tool, else table, else motor.
    channel: &'static str,
    /// Largest distance from the path.
    max_um: f64,
    /// Rms distance from the path.
    rms_um: f64,
    /// Part of it that is noise.
    noise_um: f64,
    /// Number of samples.
    samples: u64,
    /// Whether a single axis moves, so that the error is that along it.
    is_along_axis: bool,
    /// Motions between standstills.
    blocks: Vec<BlockFigures>,
    /// Full circles.
    circles: Vec<Circle>,
    /// Corners.
    corners: Vec<Corner>,
}

/// A motion between standstills.
#[derive(Clone, Debug, Serialize, JsonSchema)]
struct BlockFigures {
    block: usize,
    max_um: f64,
    rms_um: f64,
}

/// A full circle. Bidirectional figures are `null` unless both directions are full.
#[derive(Clone, Debug, Serialize, JsonSchema)]
struct Circle {
    axes: [Option<String>; 2],
    radius_mm: f64,
    /// The larger G of the laps.
    circular_deviation_um: f64,
    bidirectional_circular_deviation_um: Option<f64>,
    circular_hysteresis_um: Option<f64>,
    laps: Vec<Lap>,
}

/// A lap of a circle.
#[derive(Clone, Debug, Serialize, JsonSchema)]
struct Lap {
    direction: Direction,
    circular_deviation_um: f64,
    radial_deviation_um: Range,
    /// At 0, 90, 180 and 270°.
    reversal_spikes_um: [f64; 4],
}

#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum Direction {
    Clockwise,
    CounterClockwise,
}

/// Least and greatest value.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
struct Range {
    min: f64,
    max: f64,
}

/// A corner.
#[derive(Clone, Debug, Serialize, JsonSchema)]
struct Corner {
    /// Position of each axis.
    position_mm: BTreeMap<String, f64>,
    turn_deg: f64,
    overshoot_um: f64,
    rounding_um: f64,
}

/// The key `contour` of `trace --json`: one entry for each log.
#[must_use]
pub fn of_logs(logs: &[LogError]) -> Vec<OfLog> {
    logs.iter().map(OfLog::new).collect()
}

impl OfLog {
    fn new(LogError { log, channel, axes, error, .. }: &LogError) -> Self {
        let block =
            |&BlockError { block, max_um, rms_um, .. }: &BlockError| BlockFigures { block, max_um, rms_um };
        Self {
            log: log.clone(),
            channel: channel.word(),
            max_um: error.max_um,
            rms_um: error.rms_um,
            noise_um: error.noise_um,
            samples: error.samples,
            is_along_axis: error.is_along_axis,
            blocks: error.blocks.iter().map(block).collect(),
            circles: error.circles.iter().map(|circle| Circle::new(circle, axes)).collect(),
            corners: error.corners.iter().map(|corner| Corner::new(corner, axes)).collect(),
        }
    }
}

impl Circle {
    /// `axes` are the names of the axes.
    fn new(circle: &CircleDeviation, axes: &[String]) -> Self {
        let lap = |lap: &LapDeviation| Lap {
            direction: if lap.is_clockwise { Direction::Clockwise } else { Direction::CounterClockwise },
            circular_deviation_um: lap.circular_um,
            radial_deviation_um: Range { min: lap.radial_um[0], max: lap.radial_um[1] },
            reversal_spikes_um: lap.spikes_um,
        };
        Self {
            axes: circle.plane.map(|axis| axes.get(axis).cloned()),
            radius_mm: 1e3 * circle.radius,
            circular_deviation_um: circle.circular_um(),
            bidirectional_circular_deviation_um: circle.bidirectional_um,
            circular_hysteresis_um: circle.hysteresis_um,
            laps: circle.laps.iter().map(lap).collect(),
        }
    }
}

impl Corner {
    fn new(corner: &CornerDeviation, axes: &[String]) -> Self {
        Self {
            position_mm: axes.iter().zip(corner.point).map(|(axis, m)| (axis.clone(), 1e3 * m)).collect(),
            turn_deg: corner.turn_rad.to_degrees(),
            overshoot_um: corner.overshoot_um,
            rounding_um: corner.rounding_um,
        }
    }
}
