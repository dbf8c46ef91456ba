//! The summary of a trace on stdout: sentences, a table of errors, remarks.

use budget::Budget;
use files::format::significant;
use report::{laws, ranking, sentences};
use trace::AxisIdentification;
use trace::Identification;
use trace::judge::StageResidual;
use trace::stages::{residual_unit, stage_names};

/// Summary of a trace: a sentence for each effect, with what it costs at the tool as far as a budget has it; with details, the residuals of
/// all stages.
#[must_use]
pub fn of_trace(trace: &Identification, budget: Option<&Budget>, has_details: bool) -> String {
    let mut lines = sentences::summary(trace, budget);
    if has_details {
        lines.extend(residuals(trace));
    }
    let remarks = remarks(trace);
    if !remarks.is_empty() {
        lines.push(String::new());
        lines.extend(remarks);
    }
    lines.join("\n")
}

/// The table of the residuals of all stages.
fn residuals(trace: &Identification) -> Vec<String> {
    let mut lines = vec![String::new()];
    lines.push(format!(
        "{:<6}{:<8}{:>5}{:>22}{:>22}{:>11}",
        "axis", "channel", "", "before", "after", "noise"
    ));
    lines.push(format!(
        "{:<6}{:<8}{:>5}{:>11}{:>11}{:>11}{:>11}",
        "", "", "unit", "fit", "held out", "fit", "held out"
    ));
    for axis in trace.axes() {
        lines.extend(axis.residuals.iter().map(|error| row(axis, error)));
    }
    lines
}

/// Sentences on ambiguities, refused effects, limitations of the fit, residuals, repeatability and free runs.
fn remarks(trace: &Identification) -> Vec<String> {
    let axes = || trace.axes().iter();
    let ambiguous = axes().flat_map(|axis| {
        axis.ambiguities_with_motions().map(|(pair, motion)| sentences::ambiguity(axis, pair, motion))
    });
    let refused = axes().flat_map(ranking::refused);
    let open = axes().flat_map(sentences::open_ends);
    let residuals = axes().flat_map(|axis| {
        let unexplained = axis.unexplained.iter().map(|residual| sentences::remainder(axis, residual));
        let found = axis.laws_with_motions().map(|(law, refutation)| laws::sentence(axis, law, refutation));
        unexplained
            .chain(found)
            .chain(axis.not_testable.iter().map(|stage| sentences::not_testable(&axis.axis, stage)))
    });
    // For several logs only the page and the JSON have it: it is long.
    let shown = if trace.fit_logs().len() == 1 { trace.axes() } else { &[] };
    let repeats =
        shown.iter().flat_map(|axis| axis.repeats.iter().map(|part| sentences::repeats(axis, part)));
    let free_runs =
        axes().flat_map(|axis| axis.free_runs.iter().map(|run| sentences::free_run(axis.unit, run)));
    let notes = trace.notes().iter().cloned();
    notes
        .chain(ambiguous)
        .chain(refused)
        .chain(open)
        .chain(residuals)
        .chain(repeats)
        .chain(free_runs)
        .collect()
}

/// One sentence for each table of `--empirical`.
pub fn of_tables(trace: &Identification) -> String {
    let lines =
        trace.axes().iter().flat_map(|axis| axis.tables.iter().map(|table| sentences::table(axis, table)));
    let lines: Vec<String> = lines.collect();
    if lines.is_empty() {
        return "No empirical table reduces the remaining residuals.".to_owned();
    }
    format!("\n\n{}", lines.join("\n"))
}

fn row(axis: &AxisIdentification, error: &StageResidual) -> String {
    let (unit, _) = residual_unit(axis.unit, error.stage);
    let (before, after) = (error.before, error.after);
    let figures = [before.fit, before.validate, after.fit, after.validate, error.noise];
    // Validation logs may lack the channel: a dash.
    let cell = |figure: f64| format!("{:>11}", significant(figure, 3));
    format!("{:<6}{:<8}{unit:>5}{}", axis.axis, stage_names(&[error.stage]), figures.map(cell).concat())
}
