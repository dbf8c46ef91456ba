//! The contour error for a terminal.

use super::circle::{CircleDeviation, LapDeviation};
use super::corner::CornerDeviation;
use super::evaluation::{BlockError, ContourError};
use super::log_error::LogError;
use files::format::{fixed, signed, significant};
use files::log::Channel;

/// Largest number of blocks in a table.
const MAX_BLOCKS: usize = 12;

/// A table of the error of the path and of its blocks, and a sentence for each circle and for the corners.
#[must_use]
pub fn of(error: &ContourError, channel: Channel, axes: &[String]) -> String {
    let what = if error.is_along_axis { "error along the axis" } else { "contour error" };
    let mut lines = vec![
        format!("{:<34}{:>12}{:>12}", format!("{what} at the {}, µm", channel.word()), "rms", "greatest"),
        row("whole path", error.rms_um, error.max_um),
    ];
    let mut blocks: Vec<&BlockError> = error.blocks.iter().collect();
    if blocks.len() > 1 {
        blocks.sort_by(|a, b| b.max_um.total_cmp(&a.max_um));
        blocks.truncate(MAX_BLOCKS);
        blocks.sort_by_key(|block| block.block);
        let of_block =
            |block: &&BlockError| row(&format!("block[{}]", block.block), block.rms_um, block.max_um);
        lines.extend(blocks.iter().map(of_block));
    }
    if error.blocks.len() > MAX_BLOCKS {
        lines.push(format!("The {MAX_BLOCKS} of {} blocks with the greatest error.", error.blocks.len()));
    }
    lines.extend(error.circles.iter().map(|circle| of_circle(circle, axes)));
    lines.extend(of_corners(&error.corners));
    lines.join("\n")
}

/// A table of several logs, one line for each; empty without logs.
#[must_use]
pub fn of_logs(logs: &[LogError]) -> String {
    let heading = format!(
        "{:<24}{:<10}{:>10}{:>11}{:>9}{:>9}{:>9}{:>16}",
        "contour error, µm", "channel", "rms", "greatest", "G", "H", "peak", "overshoot"
    );
    let line = |log: &LogError| {
        let shown = |value: Option<f64>| value.map_or("–".to_owned(), |um| significant(um, 3));
        format!(
            "{:<24}{:<10}{:>10}{:>11}{:>9}{:>9}{:>9}{:>16}{}",
            log.log,
            log.channel.word(),
            significant(log.error.rms_um, 3),
            significant(log.error.max_um, 3),
            shown(log.error.circular_um()),
            shown(log.error.hysteresis_um()),
            shown(log.error.reversal_peak_um()),
            shown(log.error.overshoot_um()),
            if log.error.is_along_axis { "  (one axis: following error)" } else { "" }
        )
    };
    let lines: Vec<String> = logs.iter().map(line).collect();
    if lines.is_empty() { String::new() } else { format!("{heading}\n{}", lines.join("\n")) }
}

fn row(name: &str, rms_um: f64, max_um: f64) -> String {
    format!("{name:<34}{:>12}{:>12}", significant(rms_um, 3), significant(max_um, 3))
}

/// One line for a circle, and one for each of its directions.
fn of_circle(circle: &CircleDeviation, axes: &[String]) -> String {
    let names = circle.plane.map(|axis| axes.get(axis).map_or("", String::as_str));
    let mut text = format!(
        "Circle {}{} of {} mm radius (ISO 230-4):",
        names[0],
        names[1],
        significant(1e3 * circle.radius, 3)
    );
    for lap in &circle.laps {
        text += &format!("\n  {}", of_lap(lap));
    }
    if let (Some(both), Some(hysteresis)) = (circle.bidirectional_um, circle.hysteresis_um) {
        text += &format!(
            "\n  both directions: circular deviation G(b) {} µm, hysteresis H {} µm",
            significant(both, 3),
            significant(hysteresis, 3)
        );
    }
    text
}

fn of_lap(lap: &LapDeviation) -> String {
    let direction = if lap.is_clockwise { "clockwise" } else { "counter-clockwise" };
    let [min, max] = lap.radial_um.map(|um| signed(um, 2));
    let spikes = lap.spikes_um.map(|um| signed(um, 2)).join(", ");
    format!(
        "{direction}: circular deviation G {} µm, radial deviation F {min} to {max} µm; peaks at the reversals at 0, \
         90, 180, 270°: {spikes} µm",
        significant(lap.circular_um, 3)
    )
}

/// A sentence on the corners, if there are any.
fn of_corners(corners: &[CornerDeviation]) -> Option<String> {
    let worst = corners.iter().max_by(|a, b| a.overshoot_um.total_cmp(&b.overshoot_um))?;
    let rounded = numerics::max(corners.iter().map(|corner| corner.rounding_um));
    Some(format!(
        "{} {}: overshoot up to {} µm (at a turn of {:.0}°), nearest distance from the corner up to {} µm.",
        corners.len(),
        if corners.len() == 1 { "corner" } else { "corners" },
        fixed(worst.overshoot_um, 2),
        worst.turn_rad.to_degrees(),
        fixed(rounded, 2)
    ))
}
