//! A circle as in ballbar reports: the magnified radial deviation over the angle.

use std::f64::consts::FRAC_1_SQRT_2;

use maud::{Markup, html};

use super::data;
use super::markup::{Attributes, legend, line_entry, svg, text};
use files::format::signed;

/// The attribute with the µm of a division, by which the script of the page knows a circle.
pub(super) const MARK: &str = "data-division";

/// Side of the picture, radius of the circle, and one division, in pixels of the page.
const SIDE: u32 = 310;
const BASE: f64 = 80.0;
const DIVISION: f64 = 15.0;

/// Divisions on either side of the circle.
const DIVISIONS: i32 = 4;

/// The smallest of 1, 2 and 5 times a power of ten µm of which the divisions hold `max_um`.
#[must_use]
pub fn division_for(max_um: f64) -> f64 {
    let min = (max_um / f64::from(DIVISIONS)).max(1e-3);
    let power = libm::pow(10_f64, libm::log10(min).floor());
    [1.0, 2.0, 5.0].into_iter().map(|m| m * power).find(|d| *d >= min).unwrap_or(10.0 * power)
}

/// How many times a picture of a circle of this radius, m, magnifies deviations more than the circle.
#[must_use]
pub fn magnification(division_um: f64, radius_m: f64) -> f64 {
    DIVISION / division_um * 1e6 * radius_m / BASE
}

/// Class of the line of a direction in the stylesheet.
#[must_use]
pub const fn class(is_clockwise: bool) -> &'static str {
    if is_clockwise { "cw" } else { "ccw" }
}

/// The legend of the directions of the lines that are drawn: whether each is clockwise.
#[must_use]
pub fn directions(drawn: impl IntoIterator<Item = bool>) -> Markup {
    const MEANINGS: [(bool, &str); 2] = [(true, "clockwise"), (false, "counter-clockwise")];
    let drawn: Vec<bool> = drawn.into_iter().collect();
    let there = MEANINGS.into_iter().filter(|(is_clockwise, _)| drawn.contains(is_clockwise));
    let entries: Vec<Markup> =
        there.map(|(is_clockwise, meaning)| line_entry(class(is_clockwise), meaning)).collect();
    legend(&entries)
}

/// The SVG element: lines, each with a class of the stylesheet, through points of angle (rad) and deviation (µm).
#[must_use]
pub fn drawing(
    title: &str,
    description: &str,
    lines: &[(&str, &[(f64, f64)])],
    division_um: f64,
    axes: [&str; 2],
) -> String {
    let position = |(angle, um): &(f64, f64)| position(*angle, BASE + DIVISION * um / division_um);
    let path = |points: &[(f64, f64)]| {
        let corners = points.iter().map(position).map(|(x, y)| format!("{x:.1},{y:.1}"));
        corners.collect::<Vec<_>>().join(" ")
    };
    let body = html! {
        (grid())
        (labels(axes, division_um))
        @for (class, points) in lines { polyline class=(class) points=(path(points)) {} }
    };
    let figures = figures(lines);
    let attributes = Attributes { division_um: Some(division_um), figures: Some(&figures) };
    svg((SIDE, SIDE), attributes, (title, description), &body)
}

/// The figures of the lines of a picture, as its script reads them.
#[must_use]
pub fn figures(lines: &[(&str, &[(f64, f64)])]) -> String {
    let degrees: Vec<(&str, Vec<(f64, f64)>)> =
        lines.iter().map(|(class, points)| (*class, in_degrees(points))).collect();
    let curves: Vec<data::Curve<'_>> = degrees.iter().map(|(class, points)| (*class, &points[..])).collect();
    data::packed(["angle, degrees", "radial deviation, µm"], &curves)
}

/// The points with their angles in degrees, for a file.
fn in_degrees(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    points.iter().map(|(angle, um)| (angle.to_degrees(), *um)).collect()
}

/// Position of a polar point in the picture.
fn position(angle: f64, radius: f64) -> (f64, f64) {
    let middle = 0.5 * f64::from(SIDE);
    (middle + radius * libm::cos(angle), middle - radius * libm::sin(angle))
}

/// Radius of the outermost division.
const OUTER: f64 = BASE + DIVISION * DIVISIONS as f64;

/// The circle, its divisions, and pieces of both axes.
fn grid() -> Markup {
    let middle = 0.5 * f64::from(SIDE);
    let inner = BASE - DIVISION * f64::from(DIVISIONS);
    let end =
        |direction: (f64, f64), radius: f64| (middle + radius * direction.0, middle + radius * direction.1);
    html! {
        @for ring in -DIVISIONS..=DIVISIONS {
            circle.ring.base[ring == 0] cx=(middle) cy=(middle) r=(BASE + DIVISION * f64::from(ring)) {}
        }
        @for direction in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
            @let ((x1, y1), (x2, y2)) = (end(direction, inner), end(direction, OUTER));
            line.ring x1=(x1) y1=(y1) x2=(x2) y2=(y2) {}
        }
    }
}

/// The deviation of the outermost and innermost division, and the names of both axes.
fn labels([x, y]: [&str; 2], division_um: f64) -> Markup {
    let middle = 0.5 * f64::from(SIDE);
    let edge = f64::from(DIVISIONS) * division_um;
    let corner = middle - FRAC_1_SQRT_2 * OUTER;
    let label = |x: f64, y: f64, anchor: &str, (words, um): (&str, Option<f64>)| {
        html! {
            text.label.edge[um.is_some()] data-um=[um] x=(format_args!("{x:.1}")) y=(format_args!("{y:.1}"))
                text-anchor=(anchor) font-size="11" { (text(words)) }
        }
    };
    let (outwards, inwards) = (format!("{} µm", signed(edge, 1)), signed(-edge, 1));
    html! {
        (label(corner - 2.0, corner - 2.0, "end", (&outwards, Some(edge))))
        (label(middle, middle + 4.0, "middle", (&inwards, Some(-edge))))
        (label(middle + OUTER + 3.0, middle + 4.0, "start", (&format!("+{x}"), None)))
        (label(middle, middle - OUTER - 3.0, "middle", (&format!("+{y}"), None)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle that was run in one direction has no line of the other.
    #[test]
    fn the_legend_has_the_directions_that_are_drawn() {
        let has =
            |legend: &Markup| [">clockwise<", ">counter-clockwise<"].map(|words| legend.0.contains(words));
        assert_eq!(has(&directions([false, true, false])), [true, true]);
        assert_eq!(has(&directions([true, true])), [true, false]);
        assert_eq!(has(&directions([false])), [false, true]);
    }

    /// The script computes deviations back from the picture, with the measures of the picture.
    #[test]
    fn the_script_has_the_measures_of_the_picture() {
        let measures = format!("BASE = {BASE}, DIVISION = {DIVISION}, MIDDLE = {}", 0.5 * f64::from(SIDE));
        assert!(crate::POLAR.contains(&measures), "{measures}");
    }
}
