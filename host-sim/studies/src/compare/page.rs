//! The page of a comparison of number formats: sentences, a table of errors and cost, and the errors over time.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use crate::compare::errors::Spread;
use crate::compare::motion::Motion;
use crate::compare::pipeline::Pipeline;
use crate::compare::{Comparison, Row};
use files::format::significant;
use files::output::OutputError;
use pages::markup::{figure, legend, line_entry, note, number_cell, paragraph, section, table_with, text};
use pages::plot::{Chart, Ink, Layer};
use shared::scalar::Format;

const TABLE_NOTE: &str = "Command: distance from the point of the exact path nearest to the command in double \
                          precision in the same tick. Position: distance of the table from the table in the run in \
                          double precision. Drift (long run only): distance of the last command from the programmed \
                          end along the path, or change of the mean table position, whichever is greater. \
                          Instructions: median over the ticks with position loops, on an emulated \
                          Cortex-M4F.";

const CHARTS_NOTE: &str = "Maximum distance in each of up to 400 sections of a motion. For the long run, the two \
                           minutes at the beginning and at the end are shown; in between only the path is computed.";

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(folder: &Path, comparison: &Comparison, lead: &[String]) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(comparison, lead))
}

/// The page, with sentences above the sections.
#[must_use]
pub fn html(comparison: &Comparison, lead: &[String]) -> String {
    let lead = html! {
        @for sentence in lead { (paragraph(sentence)) }
    };
    let sections = html! {
        (section("Errors and cost", &table(comparison)))
        (section("Over time", &charts(comparison)))
    };
    pages::render("Fixed point against floating point", &lead, &sections)
}

/// Nanometres with three significant digits; `< 0.001` below a picometre.
#[must_use]
pub fn nanometres(nm: f64) -> String {
    match nm {
        0.0 => "0".to_owned(),
        nm if nm < 1e-3 => "< 0.001".to_owned(),
        nm => significant(nm, 3),
    }
}

fn table(comparison: &Comparison) -> Markup {
    let parts = html! {
        thead {
            tr {
                th rowspan="2" scope="col" { "motion" }
                th rowspan="2" scope="col" { "arithmetic" }
                th colspan="2" scope="colgroup" { "command, nm" }
                th colspan="2" scope="colgroup" { "position, nm" }
                th.n rowspan="2" scope="col" { "drift, nm" }
                th.n rowspan="2" scope="col" { "instructions " br; "a tick" }
            }
            tr {
                @for _ in ["command", "position"] {
                    th.n scope="col" { "max" }
                    th.n scope="col" { "rms" }
                }
            }
        }
        tbody {
            @for row in &comparison.rows { (table_row(row)) }
        }
    };
    html! {
        (note(TABLE_NOTE))
        (table_with("", "Errors and cost", &parts))
    }
}

fn table_row(row: &Row) -> Markup {
    let spread = |spread: Spread| {
        html! {
            (number_cell(&nanometres(spread.max)))
            (number_cell(&nanometres(spread.rms)))
        }
    };
    let or_dash = |shown: Option<String>| number_cell(shown.as_deref().unwrap_or("–"));
    html! {
        tr {
            th scope="row" { (text(&row.motion.replace('_', " "))) }
            td { (text(&row.scalar.replace("_position", ", positions too"))) }
            (spread(row.command_error_nm))
            (spread(row.position_error_nm))
            (or_dash(row.drift_nm.map(nanometres)))
            (or_dash(row.instructions_per_tick.map(|count| count.to_string())))
        }
    }
}

fn charts(comparison: &Comparison) -> Markup {
    let entries =
        [line_entry("after", "fixed point"), line_entry("before", "f32; on the right with f32 positions")];
    html! {
        (note(CHARTS_NOTE))
        (legend(&entries))
        @for motion in Motion::ALL {
            h3 { (text(&motion.name().replace('_', " "))) }
            div.stage { (charts_of(comparison, motion)) }
        }
    }
}

/// The charts of one motion: on the left both formats with fixed-point positions, on the right f32 positions.
fn charts_of(comparison: &Comparison, motion: Motion) -> Markup {
    let layer = |pipeline, ink| {
        let row = comparison.of(pipeline).find(|row| row.motion == motion.name());
        Layer { ink, points: row.map(|row| row.curve.clone()).unwrap_or_default(), is_marked: false }
    };
    let formats =
        vec![layer(Pipeline::Of(Format::F32), Ink::Before), layer(Pipeline::Of(Format::Fixed), Ink::After)];
    let f32_positions = vec![layer(Pipeline::F32Position, Ink::Before)];
    html! {
        (figure("", &chart(motion, (590, 190), formats), ""))
        (figure("", &chart(motion, (354, 190), f32_positions), ""))
    }
}

/// The SVG element of errors (nm) over time, in a suitable unit.
fn chart(motion: Motion, size: (u32, u32), mut layers: Vec<Layer>) -> String {
    let unit = convert_from_nm(&mut layers);
    let chart = Chart {
        size,
        title: &format!("Table error over time, {}", motion.name()),
        description: "Distance from the table in the run in double precision.",
        x: "time, s",
        y: &format!("deviation from f64, {unit}"),
        noise: Some(0.0),
        layers,
    };
    chart.svg()
}

/// Converts nm into the unit in which the maximum has few digits, and returns the unit.
fn convert_from_nm(layers: &mut [Layer]) -> &'static str {
    let points = || layers.iter().flat_map(|layer| &layer.points);
    let max = numerics::max_abs(points().map(|point| point.1));
    let (unit, factor) = match max {
        max if max >= 1e6 => ("mm", 1e-6),
        max if max >= 1e3 => ("µm", 1e-3),
        _ => ("nm", 1.0),
    };
    for point in layers.iter_mut().flat_map(|layer| &mut layer.points) {
        point.1 *= factor;
    }
    unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nanometres_have_three_digits_down_to_a_picometre() {
        assert_eq!(nanometres(0.0), "0");
        assert_eq!(nanometres(4e-9), "< 0.001");
        assert_eq!(nanometres(0.528_09), "0.528");
        assert_eq!(nanometres(922_228_459.7), "922000000");
    }
}
