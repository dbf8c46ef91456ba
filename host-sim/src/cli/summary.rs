//! What a trace found, for people: sentences, then a table, then what stays.

use crate::log::Log;
use crate::report::words;
use crate::trace::Trace;
use crate::trace::axis::{AxisTrace, StageError, residual_unit, stage_names};

/// Summary of a trace.
#[must_use]
pub fn of_trace(trace: &Trace) -> String {
    let mut lines = words::summary(trace);
    lines.push(String::new());
    lines.push(format!(
        "{:<6}{:<8}{:>5}{:>22}{:>22}{:>11}",
        "axis", "channel", "", "before", "after", "noise"
    ));
    lines.push(format!(
        "{:<6}{:<8}{:>5}{:>11}{:>11}{:>11}{:>11}",
        "", "", "unit", "fit", "held out", "fit", "held out"
    ));
    for axis in &trace.axes {
        lines.extend(axis.errors.iter().map(|error| row(axis, error)));
    }
    let rest = trace.axes.iter().flat_map(|axis| {
        let stays = axis.unexplained.iter().map(|rest| words::remainder(axis, rest));
        stays.chain(axis.not_testable.iter().map(|stage| words::not_testable(&axis.axis, stage)))
    });
    let rest: Vec<String> = rest.collect();
    if !rest.is_empty() {
        lines.push(String::new());
        lines.extend(rest);
    }
    lines.join("\n")
}

fn row(axis: &AxisTrace, error: &StageError) -> String {
    let (unit, _) = residual_unit(axis.unit, error.stage);
    let (before, after) = (error.before, error.after);
    let figures = [before.fit, before.validate, after.fit, after.validate, error.noise];
    // Validation logs may lack the channel: then there is no figure.
    let cell =
        |figure: f64| if figure.is_nan() { format!("{:>11}", "–") } else { format!("{figure:>11.3}") };
    format!("{:<6}{:<8}{unit:>5}{}", axis.axis, stage_names(&[error.stage]), figures.map(cell).concat())
}

/// What a log holds: following error and force of each axis.
#[must_use]
pub fn of_log(log: &Log) -> String {
    let mut lines = vec![
        format!("{:<6}{:>28}{:>24}", "axis", "following error µm", "force N"),
        format!("{:<6}{:>14}{:>14}{:>12}{:>12}", "", "rms", "greatest", "rms", "greatest"),
    ];
    for axis in &log.axes {
        let (Some(command), Some(motor), Some(force)) = (&axis.command, &axis.motor, &axis.force) else {
            continue;
        };
        let following: Vec<f64> = command.iter().zip(motor).map(|(c, m)| 1e3 * (c - m)).collect();
        let [error, force] = [following.as_slice(), force].map(rms_and_greatest);
        lines.push(format!(
            "{:<6}{:>14.3}{:>14.3}{:>12.1}{:>12.1}",
            axis.name, error.0, error.1, force.0, force.1
        ));
    }
    lines.join("\n")
}

fn rms_and_greatest(values: &[f64]) -> (f64, f64) {
    let squares = values.iter().map(|value| value * value);
    let greatest = values.iter().map(|value| value.abs()).fold(0.0, f64::max);
    ((squares.sum::<f64>() / values.len().max(1) as f64).sqrt(), greatest)
}
