//! The page of a self-test: sentences, confusion matrix, parameters, incorrect cases.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use files::format::fixed;
use pages::markup::{
    Column, figure, legend, note, number_cell, paragraph, section, surface_entry, table, text,
};

use crate::kind::Kind;
use crate::score::Outcome;
use crate::summary::{Summary, by_kind};
use crate::text_summary;
use crate::{confusion_plot, kind_table, parameter_plot};
use files::output::OutputError;

const MATRIX_NOTE: &str = "Rows: true effects; columns: effects found. A false effect is assigned to an effect that \
                           was missed on its axis, otherwise to nothing. Unexplained: an effect from outside the \
                           catalogue that the trace describes as unexplained.";

const PARAMETERS_NOTE: &str = "Left: error of each parameter found, in percent of the true value, with the median \
                               as a line. Right: coverage of the 95 % confidence intervals, with its own 95 % \
                               interval. Periods follow from the lead and are left out.";

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(
    folder: &Path,
    lead: &[String],
    outcomes: &[Outcome],
    summary: &Summary,
) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(lead, outcomes, summary))
}

/// The page, with sentences above the sections.
#[must_use]
pub fn html(lead: &[String], outcomes: &[Outcome], summary: &Summary) -> String {
    let lead = html! {
        @for sentence in lead { (paragraph(sentence)) }
    };
    let sections = html! {
        @if kind_table::is_needed(outcomes) { (section("Kinds of cases", &kind_table::markup(outcomes))) }
        (section("Confusion matrix", &matrices(outcomes, summary)))
        (section("Parameters", &parameters(summary)))
        (section("Residuals on held-out logs", &residuals(summary)))
        (section("Incorrect cases", &wrong_cases(outcomes)))
    };
    pages::render("Tracer on randomly drawn machines", &lead, &sections)
}

/// The confusion matrix of all cases, or one for each kind.
fn matrices(outcomes: &[Outcome], summary: &Summary) -> Markup {
    let pictures: Vec<(Option<Kind>, String)> = if kind_table::is_needed(outcomes) {
        let of = |outcomes: &[Outcome]| confusion_plot::picture(&Summary::new(outcomes).confusion);
        by_kind(outcomes).iter().map(|(kind, outcomes)| (Some(*kind), of(outcomes))).collect()
    } else {
        vec![(None, confusion_plot::picture(&summary.confusion))]
    };
    let shown = || pictures.iter().filter(|(_, picture)| !picture.is_empty());
    let entries = [surface_entry("hit", "correct"), surface_entry("slip", "confused or missed")];
    html! {
        @if shown().next().is_some() {
            (note(MATRIX_NOTE))
            (legend(&entries))
        }
        @for (kind, picture) in shown() {
            @if let Some(kind) = kind { h3 { (kind.name()) } }
            (figure("", picture, ""))
        }
    }
}

fn parameters(summary: &Summary) -> Markup {
    let picture = parameter_plot::picture(&summary.parameters);
    html! {
        @if !picture.is_empty() {
            (note(PARAMETERS_NOTE))
            (figure("", &picture, ""))
        }
    }
}

fn residuals(summary: &Summary) -> Markup {
    let columns = [
        Column::Words("channel"),
        Column::Numbers("values"),
        Column::Numbers("median"),
        Column::Numbers("95 % quantile"),
    ];
    let rows = html! {
        @for (channel, spread) in summary.ratios.iter().filter(|(_, spread)| spread.count > 0) {
            tr {
                th scope="row" { (channel) }
                (number_cell(&spread.count.to_string()))
                (number_cell(&fixed(spread.median, 2)))
                (number_cell(&fixed(spread.percentile95, 2)))
            }
        }
    };
    if rows.0.is_empty() {
        return rows;
    }
    html! {
        (note("Rms residual with all effects found, divided by the rms noise of the sensors."))
        (table("Residuals by channel", &columns, &rows))
    }
}

fn wrong_cases(outcomes: &[Outcome]) -> Markup {
    let rows = html! {
        @for outcome in outcomes.iter().filter(|outcome| !text_summary::is_right(outcome)) { (row(outcome)) }
    };
    if rows.0.is_empty() {
        return paragraph("None.");
    }
    table("Cases that are not right", &["case", "true effects", "found"].map(Column::Words), &rows)
}

fn row(outcome: &Outcome) -> Markup {
    let (there, found) = text_summary::true_and_found(outcome);
    html! {
        tr {
            th scope="row" { (outcome.kind.case_name(outcome.number)) }
            td { (text(&there)) }
            td { (text(&found)) }
        }
    }
}
