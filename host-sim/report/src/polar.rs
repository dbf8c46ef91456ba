//! The circle as ballbar users draw it: the deviation from it, magnified.

use std::f64::consts::FRAC_1_SQRT_2;
use std::fmt::Write;

use super::circle::find;
use super::deviation::{Lap, Run};
use super::markup::{figure, key, note, svg, text};
use super::number::{signed, significant};
use super::stages::AxisView;
use trace::Trace;

/// Pixels of the page: the picture, radius of the circle, and one division.
const SIDE: u32 = 310;
const BASE: f64 = 80.0;
const DIVISION: f64 = 15.0;

/// Divisions on either side of the circle.
const DIVISIONS: i32 = 4;

/// The section's body; empty where no log holds a circle with the channels for it.
#[must_use]
pub fn body(trace: &Trace, views: &[AxisView<'_>]) -> String {
    let (Some(circle), [x, y, ..]) = (find(&trace.validate_logs), views) else { return String::new() };
    let run = Run { circle: &circle, signals: &trace.validate_logs[circle.log], axes: [x, y] };
    let Some((channel, measured)) = run.measured() else { return String::new() };
    let mut pictures = picture(&run, "As measured", &measured, division(&[&measured]));
    let mut intro = format!(
        "{}: a circle of {} mm radius at {} mm/s, seen with +{} to the right and +{} up. Outside the circle is \
         outwards. As measured: how far the {channel} ran off the commanded circle.",
        super::file_name(&run.signals.source),
        significant(1e3 * circle.radius, 3),
        significant(1e3 * run.speed(), 3),
        x.trace.axis,
        y.trace.axis,
    );
    if !run.stages().is_empty() {
        let before = run.unexplained([&x.before, &y.before]);
        let after = run.unexplained([&x.after, &y.after]);
        let same = division(&[&before, &after]);
        pictures += &picture(&run, "Unexplained before", &before, same);
        pictures += &picture(&run, "Unexplained after", &after, same);
        intro += " Unexplained before: what is left of it when all that the declared model predicts is taken away. \
                  Unexplained after: the same with the effects found, at the same magnification.";
    }
    let keys = [key("cw", false, "clockwise"), key("ccw", false, "counter-clockwise")].concat();
    format!("{}<div class=\"circles\">\n{pictures}</div>\n<p class=\"legend\">{keys}</p>\n", note(&intro))
}

/// The least of 1, 2 and 5 times a power of ten µm at which all deviations fit the divisions.
fn division(all: &[&[Lap]]) -> f64 {
    let points = all.iter().copied().flatten().flat_map(|lap| &lap.points);
    division_for(numerics::max_abs(points.map(|point| point.1)))
}

/// The least of 1, 2 and 5 times a power of ten µm of which the divisions hold `most`.
#[must_use]
pub fn division_for(most: f64) -> f64 {
    let least = (most / f64::from(DIVISIONS)).max(1e-3);
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|m| m * power).find(|d| *d >= least).unwrap_or(10.0 * power)
}

/// One polar picture with its caption.
fn picture(run: &Run<'_>, title: &str, laps: &[Lap], division_um: f64) -> String {
    let points = || laps.iter().flat_map(|lap| &lap.points).map(|point| point.1);
    let [least, most] = numerics::min_max(points());
    let magnified = DIVISION / division_um * 1e6 * run.circle.radius / BASE;
    let caption = format!(
        "{title}: {} to {} µm. One division is {} µm, magnified {} times.",
        signed(least, 2),
        signed(most, 2),
        significant(division_um, 1),
        significant(magnified, 2),
    );
    let class = |lap: &Lap| if lap.is_clockwise { "cw" } else { "ccw" };
    let lines: Vec<(&str, &[(f64, f64)])> = laps.iter().map(|lap| (class(lap), &lap.points[..])).collect();
    let title = format!("{title}: radial deviation over the angle");
    let axes = run.axes.map(|axis| axis.trace.axis.as_str());
    figure("", &drawing(&title, &caption, &lines, division_um, axes), &caption)
}

/// The drawing alone: lines of a class of the stylesheet through points of angle (rad) and deviation (µm).
#[must_use]
pub fn drawing(
    title: &str,
    description: &str,
    lines: &[(&str, &[(f64, f64)])],
    division_um: f64,
    axes: [&str; 2],
) -> String {
    let mut body = grid(axes, division_um);
    for (class, points) in lines {
        let place = |(angle, um): &(f64, f64)| place(*angle, BASE + DIVISION * um / division_um);
        let path: Vec<String> = points.iter().map(place).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(body, "<polyline class=\"{class}\" points=\"{}\"/>", path.join(" "));
    }
    svg((SIDE, SIDE), title, description, &body)
}

/// Place of a polar point in the picture.
fn place(angle: f64, radius: f64) -> (f64, f64) {
    let middle = 0.5 * f64::from(SIDE);
    (middle + radius * angle.cos(), middle - radius * angle.sin())
}

/// The circle, its divisions, and what they mean.
fn grid([x, y]: [&str; 2], division_um: f64) -> String {
    let mut grid = String::new();
    let middle = 0.5 * f64::from(SIDE);
    for ring in -DIVISIONS..=DIVISIONS {
        let class = if ring == 0 { "ring base" } else { "ring" };
        let radius = BASE + DIVISION * f64::from(ring);
        let _ = writeln!(grid, "<circle class=\"{class}\" cx=\"{middle}\" cy=\"{middle}\" r=\"{radius}\"/>");
    }
    let outer = BASE + DIVISION * f64::from(DIVISIONS);
    let inner = BASE - DIVISION * f64::from(DIVISIONS);
    for (x, y) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
        let at = |radius: f64| (middle + radius * x, middle + radius * y);
        let ((x1, y1), (x2, y2)) = (at(inner), at(outer));
        let _ = writeln!(grid, "<line class=\"ring\" x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"/>");
    }
    let mut label = |x: f64, y: f64, anchor: &str, words: &str| {
        let words = text(words);
        let _ = writeln!(
            grid,
            "<text class=\"label\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-size=\"11\">{words}</text>"
        );
    };
    let edge = f64::from(DIVISIONS) * division_um;
    let corner = middle - FRAC_1_SQRT_2 * outer;
    label(corner - 2.0, corner - 2.0, "end", &format!("{} µm", signed(edge, 1)));
    label(middle, middle + 4.0, "middle", &signed(-edge, 1));
    let [x, y] = [x, y].map(|axis| format!("+{axis}"));
    label(middle + outer + 3.0, middle + 4.0, "start", &x);
    label(middle, middle - outer - 3.0, "middle", &y);
    grid
}
