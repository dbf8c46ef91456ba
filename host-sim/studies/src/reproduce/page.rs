//! The page of the published experiments: for each paper the results in sentences, all figures, pictures, and notes.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use super::Reproduction;
use super::study::{Outcome, Picture, Study};
use files::format::significant;
use files::output::OutputError;
use pages::markup::{
    Column, figure, legend, line_entry, list, note, number_cell, paragraph, point_entry, section,
    surface_entry, table, text,
};

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(folder: &Path, reproduction: &Reproduction, lead: &str) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(reproduction, lead))
}

/// The page, with a sentence above the studies.
#[must_use]
pub fn html(reproduction: &Reproduction, lead: &str) -> String {
    let sections = html! {
        @for study in &reproduction.studies { (section_of(study)) }
    };
    pages::render("Published experiments repeated", &paragraph(lead), &sections)
}

fn section_of(study: &Study) -> Markup {
    let body = html! {
        @for sentence in &study.findings { (paragraph(sentence)) }
        (outcomes(&study.outcomes))
        @for picture in &study.pictures { (picture_with_legend(picture)) }
        @if !study.notes.is_empty() {
            (note("Notes on the printed text:"))
            (list(&study.notes))
        }
    };
    section(&format!("{}: {}", study.paper, study.title), &body)
}

fn outcomes(outcomes: &[Outcome]) -> Markup {
    let columns = [
        Column::Words("quantity"),
        Column::Numbers("printed"),
        Column::Numbers("ours"),
        Column::Words("unit"),
        Column::Words("verdict"),
    ];
    let rows = html! {
        @for outcome in outcomes { (row(outcome)) }
    };
    table("Printed values and ours", &columns, &rows)
}

fn row(outcome: &Outcome) -> Markup {
    html! {
        tr {
            th scope="row" { (text(&outcome.quantity)) }
            (number_cell(&outcome.printed.label()))
            (number_cell(&significant(outcome.ours, 4)))
            td { (text(outcome.unit)) }
            td {
                @if outcome.agrees() { "agrees" } @else { strong { "differs" } }
            }
        }
    }
}

fn picture_with_legend(picture: &Picture) -> Markup {
    let entries: Vec<Markup> =
        picture.legend.iter().map(|(class, meaning)| legend_entry(class, meaning)).collect();
    html! {
        h3 { (text(&picture.title)) }
        (legend(&entries))
        (figure("", &picture.svg, &picture.caption))
    }
}

/// A point where the class ends in ` mark`, a surface for `before-range`, otherwise a line.
fn legend_entry(class: &str, meaning: &str) -> Markup {
    match class.strip_suffix(" mark") {
        Some(class) => point_entry(class, meaning),
        None if class == "before-range" => surface_entry(class, meaning),
        None => line_entry(class, meaning),
    }
}
