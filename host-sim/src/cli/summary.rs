//! What a trace found, for people: sentences, then a table, then what stays.

use crate::effects::Stage;
use crate::log::Log;
use crate::report::words;
use crate::trace::Trace;
use crate::trace::axis::{AxisTrace, StageError, stage_names};

/// Prints the summary to stdout.
pub fn print(trace: &Trace) {
    for sentence in words::summary(trace) {
        println!("{sentence}");
    }
    println!();
    println!("{:<6}{:<8}{:>5}{:>22}{:>22}{:>10}", "axis", "channel", "", "before", "after", "noise");
    println!("{:<6}{:<8}{:>5}{:>11}{:>11}{:>11}{:>11}", "", "", "unit", "fit", "held out", "fit", "held out");
    for axis in &trace.axes {
        for error in &axis.errors {
            println!("{}", row(axis, error));
        }
    }
    let rest: Vec<String> = trace
        .axes
        .iter()
        .flat_map(|axis| {
            let stays = axis.unexplained.iter().map(|rest| words::remainder(axis, rest));
            stays.chain(axis.not_testable.iter().map(|stage| words::not_testable(&axis.axis, stage)))
        })
        .collect();
    if !rest.is_empty() {
        println!();
        for sentence in rest {
            println!("{sentence}");
        }
    }
}

fn row(axis: &AxisTrace, error: &StageError) -> String {
    let unit = if error.stage == Stage::Force { "N" } else { "µm" };
    let (before, after) = (error.before, error.after);
    format!(
        "{:<6}{:<8}{unit:>5}{:>11.3}{:>11.3}{:>11.3}{:>11.3}{:>10.3}",
        axis.axis,
        stage_names(&[error.stage]),
        before.fit,
        before.validate,
        after.fit,
        after.validate,
        error.noise
    )
}

/// Prints what a log holds: following error and force of each axis.
pub fn print_log(log: &Log) {
    println!();
    println!("{:<6}{:>28}{:>24}", "axis", "following error µm", "force N");
    println!("{:<6}{:>14}{:>14}{:>12}{:>12}", "", "rms", "greatest", "rms", "greatest");
    for axis in &log.axes {
        let (Some(command), Some(motor), Some(force)) = (&axis.command, &axis.motor, &axis.force) else {
            continue;
        };
        let following: Vec<f64> = command.iter().zip(motor).map(|(c, m)| 1e3 * (c - m)).collect();
        let [error, force] = [following.as_slice(), force].map(rms_and_greatest);
        println!("{:<6}{:>14.3}{:>14.3}{:>12.1}{:>12.1}", axis.name, error.0, error.1, force.0, force.1);
    }
}

fn rms_and_greatest(values: &[f64]) -> (f64, f64) {
    let squares = values.iter().map(|value| value * value);
    let greatest = values.iter().map(|value| value.abs()).fold(0.0, f64::max);
    ((squares.sum::<f64>() / values.len().max(1) as f64).sqrt(), greatest)
}
