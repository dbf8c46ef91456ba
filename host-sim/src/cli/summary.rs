//! What a trace found, for people: sentences, then a table, then what stays.

use report::{ranking, sentences};
use trace::Trace;
use trace::outcome::{AxisTrace, StageError};
use trace::stages::{residual_unit, stage_names};

/// Summary of a trace.
#[must_use]
pub fn of_trace(trace: &Trace) -> String {
    let mut lines = sentences::summary(trace);
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
        let stays = axis.unexplained.iter().map(|rest| sentences::remainder(axis, rest));
        stays.chain(axis.not_testable.iter().map(|stage| sentences::not_testable(&axis.axis, stage)))
    });
    // Of several logs the page and the JSON tell it: here it would drown what was found.
    let told = if trace.fit_logs.len() == 1 { &trace.axes[..] } else { &[] };
    let repeats = told.iter().flat_map(|axis| axis.repeats.iter().map(|part| sentences::repeats(axis, part)));
    let runs = trace.axes.iter().flat_map(|axis| axis.free_runs.iter().map(sentences::free_run));
    let alike = trace
        .axes
        .iter()
        .flat_map(|axis| axis.ambiguities.iter().map(|alike| sentences::look_alike(axis, alike)));
    let refused = trace.axes.iter().flat_map(ranking::refused);
    let open = trace.axes.iter().flat_map(sentences::open_ends);
    let rest = alike.chain(refused).chain(open).chain(rest);
    let rest: Vec<String> = trace.notes.iter().cloned().chain(rest).chain(repeats).chain(runs).collect();
    if !rest.is_empty() {
        lines.push(String::new());
        lines.extend(rest);
    }
    lines.join("\n")
}

/// What the tables of `--empirical` take away.
pub fn of_tables(trace: &Trace) -> String {
    let lines =
        trace.axes.iter().flat_map(|axis| axis.tables.iter().map(|table| sentences::table(axis, table)));
    let lines: Vec<String> = lines.collect();
    if lines.is_empty() {
        return "\n\nNothing that stays is worth a table.".to_owned();
    }
    format!("\n\n{}", lines.join("\n"))
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
