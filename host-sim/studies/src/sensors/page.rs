//! The page of the study: sentences, the table, and the contour error over the position gain.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use super::SensorStudy;
use super::row::Row;
use files::format::significant;
use files::output::OutputError;
use pages::markup::{figure, legend, line_entry, note, number_cell, paragraph, section, table_with, text};
use pages::plot::{Chart, Ink, Layer};

const COLUMNS: [&str; 11] = [
    "gain margin, dB",
    "phase margin, °",
    "highest Kp, 1/s",
    "circle rms, µm",
    "compensated",
    "circle G, µm",
    "compensated",
    "corner rms, µm",
    "compensated",
    "corner greatest, µm",
    "compensated",
];

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(folder: &Path, study: &SensorStudy) -> Result<PathBuf, OutputError> {
    let lead = html! {
        @for sentence in study.verdicts() { (paragraph(&sentence)) }
    };
    let sections = html! {
        (section("Contour error and margins", &table(study)))
        (section("Contour error over the position gain", &charts(study)))
    };
    pages::write(folder, &pages::render("Motor, table and dual feedback", &lead, &sections))
}

fn table(study: &SensorStudy) -> Markup {
    let remark = format!(
        "Contour errors and margins at Kp = {}/s. Highest Kp: the position loops have a gain margin of {} dB and a phase \
         margin of {}°.",
        study.position_gain_per_s, study.gain_margin_db, study.phase_margin_deg
    );
    let parts = html! {
        thead {
            tr {
                th scope="col" { "feedback" }
                th scope="col" { "law" }
                @for column in COLUMNS { th.n scope="col" { (text(column)) } }
            }
        }
        tbody {
            @for row in &study.rows {
                tr {
                    th scope="row" { (text(row.feedback)) }
                    td { (text(row.controller)) }
                    @for number in numbers(row) { (number_cell(&number)) }
                }
            }
        }
    };
    html! {
        (note(&remark))
        (table_with("", "Contour errors and margins", &parts))
    }
}

fn numbers(row: &Row) -> [String; 11] {
    let (before, after) = (row.uncompensated, row.compensated);
    [
        row.gain_margin_db,
        row.phase_margin_deg,
        row.highest_position_gain_per_s,
        Some(before.circle_rms_um),
        Some(after.circle_rms_um),
        Some(before.circular_um),
        Some(after.circular_um),
        Some(before.corner_rms_um),
        Some(after.corner_rms_um),
        Some(before.corner_max_um),
        Some(after.corner_max_um),
    ]
    .map(|value| value.map_or("–".to_owned(), |value| significant(value, 3)))
}

fn charts(study: &SensorStudy) -> Markup {
    let entries = [
        line_entry("before", "motor (semi-closed)"),
        line_entry("after", "table (full-closed)"),
        line_entry("cw", "dual"),
    ];
    html! {
        (note("Without compensation. Each line ends at the highest Kp."))
        (legend(&entries))
        div.stage {
            @for (law, name) in [("p", "P control"), ("hpc", "HPC")] { (figure("", &chart(study, law, name), name)) }
        }
    }
}

fn chart(study: &SensorStudy, law: &str, name: &str) -> String {
    let inks = [("motor", Ink::Before), ("table", Ink::After), ("dual", Ink::Third)];
    let layer = |(feedback, ink): (&str, Ink)| {
        let points = study.row(feedback, law).map(|row| row.over_gain.iter());
        let points =
            points.into_iter().flatten().map(|point| (point.position_gain_per_s, point.circle_rms_um));
        Layer { ink, points: points.collect(), is_marked: false }
    };
    let chart = Chart {
        size: (470, 240),
        title: &format!("Contour error over Kp, {name}"),
        description: "Rms of the contour error on the circle without compensation.",
        x: "Kp, 1/s",
        y: "circle rms, µm",
        noise: Some(0.0),
        layers: inks.into_iter().map(layer).collect(),
    };
    chart.svg()
}
