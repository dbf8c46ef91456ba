//! Contour errors before, as predicted, and after a change: a table, and circles on one scale.

use maud::{Markup, html};

use budget::limits::{Figure, Judgement};
use contour::ContourError;
use contour::circle::CircleDeviation;
use contour::comparison::{Comparison, QUANTITIES};
use files::format::{signed, significant};
use pages::markup::{Column, figure, note, number_cell, paragraph, table, text};
use pages::polar::{class, directions, division_for, drawing, magnification};

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
        (errors(&rows, &[]))
        @for motion in motions {
            @let [before, predicted, after] = &motion.errors;
            h3 { (text(&motion.name)) }
            (on_one_scale(&[("Before", before), ("Predicted", predicted), ("After", after)], &motion.axes, Last::OnOneScale))
        }
    }
}

/// The table of contour errors: for each motion a row for each figure. `limits`: what became of limits on each motion, if there are any.
pub(crate) fn errors(rows: &[Comparison], limits: &[Vec<Judgement>]) -> Markup {
    let shown = Shown {
        prediction: rows.iter().any(|row| row.figures.iter().any(|figure| figure[1].is_some())),
        limits: limits.iter().any(|of_motion| !of_motion.is_empty()),
    };
    let columns = [
        (true, Column::Words("motion")),
        (true, Column::Words("figure")),
        (true, Column::Numbers("before, µm")),
        (shown.prediction, Column::Numbers("predicted")),
        (true, Column::Numbers("after")),
        (shown.limits, Column::Numbers("limit, µm")),
        (shown.limits, Column::Words("result")),
    ];
    let columns: Vec<Column> =
        columns.into_iter().filter(|(is_shown, _)| *is_shown).map(|(_, column)| column).collect();
    let body = html! {
        @for (i, row) in rows.iter().enumerate() {
            (of_motion(row, limits.get(i).map_or(&[][..], Vec::as_slice), shown))
        }
    };
    html! {
        (note("G: circular deviation, the larger of both directions (ISO 230-4). Greatest: distance from the path."))
        (table("Contour errors of each motion", &columns, &body))
    }
}

/// The columns of the table that it has only where there is something in them.
#[derive(Clone, Copy)]
struct Shown {
    prediction: bool,
    limits: bool,
}

/// The figures of a motion that it has, in the order in which limits name them.
fn of_motion(row: &Comparison, limits: &[Judgement], shown: Shown) -> Markup {
    const ORDER: [(usize, Figure); QUANTITIES.len()] =
        [(2, Figure::Circular), (0, Figure::Rms), (1, Figure::Greatest)];
    let known: Vec<(usize, Figure)> =
        ORDER.into_iter().filter(|(index, _)| row.figures[*index].iter().any(Option::is_some)).collect();
    let um = |value: Option<f64>| value.map_or("–".to_owned(), |um| significant(um, 3));
    html! {
        @for (place, (index, name)) in known.iter().enumerate() {
            @let [before, predicted, after] = row.figures[*index];
            @let limit = limits.iter().find(|limit| limit.name == *name);
            tr {
                @if place == 0 { th scope="row" rowspan=(known.len()) { (text(&row.name)) } }
                td { (name.name()) }
                (number_cell(&um(before)))
                @if shown.prediction { (number_cell(&um(predicted))) }
                (number_cell(&um(after)))
                @if shown.limits {
                    (number_cell(&limit.map_or(String::new(), |limit| significant(limit.limit_um, 3))))
                    td.result { (limit.map_or("", |limit| limit.result.word())) }
                }
            }
        }
    }
}

/// Whether the last of several circles is drawn once more, as large as it can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Last {
    /// It is not.
    OnOneScale,
    /// It is: after a change little is left to be seen on the scale of before.
    AndAlone,
}

/// The largest circle of each contour error, beside each other on one scale; empty if one has no circle.
pub(crate) fn on_one_scale(errors: &[(&str, &ContourError)], axes: &[String], last: Last) -> Markup {
    let circles: Option<Vec<(&str, &CircleDeviation)>> =
        errors.iter().map(|(title, error)| Some((*title, error.largest_circle()?))).collect();
    let Some(circles) = circles.filter(|circles| !circles.is_empty()) else { return Markup::default() };
    let division_um = division(circles.iter().map(|(_, circle)| *circle));
    let alone = circles.last().filter(|_| last == Last::AndAlone).map(|(title, circle)| {
        let title = format!("{title}, as large as it can be");
        picture(&title, circle, division([*circle].into_iter()), axes)
    });
    html! {
        (note(&format!(
            "Radial deviation from the programmed circle of {} mm radius.",
            significant(1e3 * circles[0].1.radius, 3)
        )))
        div.circles {
            @for (title, circle) in &circles { (picture(title, circle, division_um, axes)) }
            @if let Some(alone) = &alone { (alone) }
        }
        (directions(circles.iter().flat_map(|(_, circle)| &circle.laps).map(|lap| lap.is_clockwise)))
    }
}

/// The division that holds all deviations of circles.
fn division<'a>(circles: impl Iterator<Item = &'a CircleDeviation>) -> f64 {
    let points = circles.flat_map(|circle| &circle.laps).flat_map(|lap| &lap.points);
    division_for(numerics::max_abs(points.map(|point| point.1)))
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
    let lines: Vec<(&str, &[(f64, f64)])> =
        circle.laps.iter().map(|lap| (class(lap.is_clockwise), &lap.points[..])).collect();
    let names = circle.plane.map(|axis| axes.get(axis).map_or("", String::as_str));
    figure("", &drawing(title, &caption, &lines, division_um, names), &caption)
}
