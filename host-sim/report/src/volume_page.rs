//! The page of `volume`: the sentence, the errors, their courses over each axis, the measurements before and after.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use files::format::significant;
use files::output::OutputError;
use pages::file_name;
use pages::markup::{
    Column, figure, legend, line_entry, list, number_cell, paragraph, section, table, text, words_cell,
};
use pages::plot::{Chart, Ink, Layer};
use volume::Analysis;
use volume::axis_table::AxisTable;
use volume::component::Axis;
use volume::text::{known, sentence};

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(folder: &Path, analysis: &Analysis) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(analysis))
}

/// The page. The same result gives the same bytes.
#[must_use]
pub fn html(analysis: &Analysis) -> String {
    let moved = Axis::ALL.into_iter().zip(&analysis.tables);
    let sections = html! {
        (section("Errors of geometry", &errors(analysis)))
        (section("The measurements before and after", &measurements(analysis)))
        @for (axis, of) in moved {
            (section(&format!("Errors of {}", axis.name()), &courses(axis, of)))
        }
        @if !analysis.notes.is_empty() { (section("What was assumed", &list(&analysis.notes))) }
    };
    pages::render("Volume", &paragraph(&sentence(analysis)), &sections)
}

fn errors(analysis: &Analysis) -> Markup {
    let columns =
        [Column::Words("error"), Column::Words("in words"), Column::Words("greatest value, 95 % interval")];
    let rows = html! {
        @for finding in &analysis.findings {
            tr {
                td { (text(&finding.name)) }
                (words_cell(&finding.words))
                (words_cell(&known(finding)))
            }
        }
    };
    table("Errors of geometry, with the names of ISO 230-1", &columns, &rows)
}

fn measurements(analysis: &Analysis) -> Markup {
    let columns = [
        Column::Words("measurement"),
        Column::Words("part"),
        Column::Numbers("before, µm rms"),
        Column::Numbers("after, µm rms"),
    ];
    let rows = html! {
        @for judged in &analysis.judged {
            tr {
                td { (text(file_name(&judged.source))) }
                td { (if judged.is_held_out { "held out" } else { "fitted" }) }
                (number_cell(&significant(judged.before_um, 3)))
                (number_cell(&significant(judged.after_um, 3)))
            }
        }
    };
    table(
        "Deviations without centre, radius and origin, before and after the errors that are shown",
        &columns,
        &rows,
    )
}

/// The errors along and about x, y and z over the position of an axis.
fn courses(axis: Axis, of: &AxisTable) -> Markup {
    const INKS: [(Ink, &str); 3] = [(Ink::Third, "cw"), (Ink::Fourth, "ccw"), (Ink::After, "after")];
    let name = axis.name();
    let chart = |values: &[[f64; 3]], title: &'static str, y: &'static str, description: &str| {
        let layers = INKS.iter().enumerate().map(|(direction, (ink, _))| {
            let points =
                of.position_mm.iter().zip(values).map(|(mm, value)| (*mm, value[direction])).collect();
            Layer { ink: *ink, points, is_marked: false }
        });
        let layers = layers.collect();
        let x = "position, mm";
        let size = (960, 240);
        Chart { size, title, description, x, y, noise: Some(0.0), layers }.svg()
    };
    let entries = |word: &str| -> Vec<Markup> {
        let entry = |(direction, (_, class)): (Axis, &(Ink, &str))| {
            line_entry(class, &format!("{word} {}", direction.name()))
        };
        Axis::ALL.into_iter().zip(&INKS).map(entry).collect()
    };
    let along = format!("Errors along x, y and z over the position of {name}.");
    let about = format!("Errors about x, y and z over the position of {name}, right-handed.");
    html! {
        (legend(&entries("along")))
        (figure("wide", &chart(&of.along_um, "Errors along the axes", "error, µm", &along), &along))
        @if of.about_urad.iter().flatten().any(|urad| *urad != 0.0) {
            (legend(&entries("about")))
            (figure("wide", &chart(&of.about_urad, "Errors about the axes", "error, µrad", &about), &about))
        }
    }
}
