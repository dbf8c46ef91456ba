//! Contour errors before, as predicted, and after a change: a table, and circles on one scale.

use maud::{Markup, html};

use contour::ContourError;
use contour::circle::CircleDeviation;
use contour::comparison::{Comparison, QUANTITIES};
use files::format::{signed, significant};
use pages::markup::{Column, figure, legend, line_entry, note, number_cell, paragraph, table, text};
use pages::polar::{division_for, drawing, magnification};

/// A motion before, as predicted, and after.
#[derive(Clone, Debug, PartialEq)]
pub struct RoundTripMotion {
    /// Name of the motion.
    pub name: String,
    /// Names of the axes.
    pub axes: Vec<String>,
    /// Contour errors before, as predicted, and after.
    pub errors: [ContourError; 3],
}

/// A sentence, the table, and the circles beside each other on one scale; empty without a motion.
#[must_use]
pub fn round_trip(motions: &[RoundTripMotion], lead: &str) -> Markup {
    if motions.is_empty() {
        return Markup::default();
    }
    let rows: Vec<Comparison> =
        motions.iter().map(|motion| Comparison::new(&motion.name, &motion.errors)).collect();
    html! {
        (paragraph(lead))
        (errors(&rows))
        @for motion in motions {
            @let [before, predicted, after] = &motion.errors;
            (paragraph(&motion.name))
            (on_one_scale(&[("Before", before), ("Predicted", predicted), ("After", after)], &motion.axes))
        }
    }
}

/// The table of contour errors.
pub(crate) fn errors(rows: &[Comparison]) -> Markup {
    const FIRST: [&str; QUANTITIES.len()] = ["rms before, µm", "greatest before, µm", "G before, µm"];
    let numbers = FIRST.into_iter().flat_map(|first| [first, "predicted", "after"]);
    let columns: Vec<Column> =
        std::iter::once(Column::Words("motion")).chain(numbers.map(Column::Numbers)).collect();
    let cells = html! {
        @for row in rows {
            tr {
                th scope="row" { (text(&row.name)) }
                @for value in row.figures.iter().flatten() {
                    (number_cell(&value.map_or("–".to_owned(), |um| significant(um, 3))))
                }
            }
        }
    };
    html! {
        (note("G: circular deviation, the larger of both directions (ISO 230-4)."))
        (table("Contour errors of each motion", &columns, &cells))
    }
}

/// The largest circle of each contour error, beside each other on one scale; empty if one has no circle.
pub(crate) fn on_one_scale(errors: &[(&str, &ContourError)], axes: &[String]) -> Markup {
    let largest = |error: &ContourError| -> Option<CircleDeviation> {
        error.circles.iter().max_by(|a, b| a.radius.total_cmp(&b.radius)).cloned()
    };
    let circles: Option<Vec<(&str, CircleDeviation)>> =
        errors.iter().map(|(title, error)| Some((*title, largest(error)?))).collect();
    let Some(circles) = circles.filter(|circles| !circles.is_empty()) else { return Markup::default() };
    let points = circles.iter().flat_map(|(_, circle)| &circle.laps).flat_map(|lap| &lap.points);
    let division_um = division_for(numerics::max_abs(points.map(|point| point.1)));
    html! {
        (note(&format!(
            "Radial deviation from the programmed circle of {} mm radius.",
            significant(1e3 * circles[0].1.radius, 3)
        )))
        div.circles {
            @for (title, circle) in &circles { (picture(title, circle, division_um, axes)) }
        }
        (legend(&[line_entry("cw", "clockwise"), line_entry("ccw", "counter-clockwise")]))
    }
}

fn picture(title: &str, circle: &CircleDeviation, division_um: f64, axes: &[String]) -> Markup {
    let [min, max] = numerics::min_max(circle.laps.iter().flat_map(|lap| &lap.points).map(|point| point.1));
    let caption = format!(
        "{title}: {} to {} µm, G {} µm. One division is {} µm, magnified {} times.",
        signed(min, 2),
        signed(max, 2),
        significant(circle.circular_um(), 3),
        significant(division_um, 1),
        significant(magnification(division_um, circle.radius), 2),
    );
    let class = |is_clockwise: bool| if is_clockwise { "cw" } else { "ccw" };
    let lines: Vec<(&str, &[(f64, f64)])> =
        circle.laps.iter().map(|lap| (class(lap.is_clockwise), &lap.points[..])).collect();
    let names = circle.plane.map(|axis| axes.get(axis).map_or("", String::as_str));
    figure("", &drawing(title, &caption, &lines, division_um, names), &caption)
}
