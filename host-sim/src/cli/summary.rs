//! What a trace found, for people: sentences, then a table, then what stays.

use crate::effects::Stage;
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
