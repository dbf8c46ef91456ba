//! The page of `verify`: contour errors before, predicted and after, and the circles before and after on one scale.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use contour::ContourError;
use contour::circle::CircleError;
use contour::verification::{Change, VerifiedMotion};
use files::format::{fixed, signed, significant};
use files::output::OutputError;
use pages::markup::{
    Column, figure, legend, line_entry, list, note, number_cell, paragraph, section, table, text,
};
use pages::polar::{division_for, drawing, magnification};

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(folder: &Path, machine: &str, motions: &[VerifiedMotion]) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(machine, motions))
}

/// The page. The same motions give the same bytes.
#[must_use]
pub fn html(machine: &str, motions: &[VerifiedMotion]) -> String {
    let sections = html! {
        (section("Contour error", &errors(motions)))
        @for motion in motions { (section(&format!("The circle of {}", motion.name), &circles(motion))) }
    };
    let lead = paragraph(&summary(motions));
    pages::render(&format!("Before and after: {machine}"), &lead, &sections)
}

/// How many motions became better, worse, or neither.
#[must_use]
pub fn summary(motions: &[VerifiedMotion]) -> String {
    let count = |change: Change| motions.iter().filter(|motion| motion.change() == change).count();
    let predicted = motions.iter().filter_map(VerifiedMotion::is_as_predicted);
    let (within, all) = predicted.fold((0, 0), |(within, all), is| (within + usize::from(is), all + 1));
    let predictions = if all == 0 {
        "No prediction is given for them.".to_owned()
    } else {
        format!("{within} of {all} predictions hold.")
    };
    format!(
        "Contour error of {} {}: smaller in {}, larger in {}, not distinguishable in {}. {predictions}",
        motions.len(),
        if motions.len() == 1 { "motion" } else { "motions" },
        count(Change::Better),
        count(Change::Worse),
        count(Change::Unchanged)
    )
}

/// One sentence for each motion that became worse or is not as predicted, and for each that is not measured at the tool.
#[must_use]
pub fn remarks(motions: &[VerifiedMotion]) -> Vec<String> {
    motions.iter().flat_map(remarks_on).collect()
}

fn remarks_on(motion: &VerifiedMotion) -> Vec<String> {
    let name = &motion.name;
    let mut remarks = Vec::new();
    if motion.change() == Change::Worse {
        remarks.push(format!(
            "{name}: the error became larger, from {} to {} µm rms.",
            significant(motion.before.rms_um, 3),
            significant(motion.after.rms_um, 3)
        ));
    }
    if let (Some(false), Some(predicted)) = (motion.is_as_predicted(), &motion.predicted) {
        remarks.push(format!(
            "{name}: {} µm rms were measured, {} µm ± {} % predicted.",
            significant(motion.after.rms_um, 3),
            significant(predicted.after_um, 3),
            significant(predicted.bound_percent, 2)
        ));
    }
    if motion.channel != contour::logged::POSITIONS[0] {
        remarks.push(format!(
            "{name}: measured at the {}; errors between it and the tool are not in these figures.",
            motion.channel.word()
        ));
    }
    if motion.before.is_along_axis {
        remarks.push(format!("{name}: one axis; the error is along it, the following error."));
    }
    remarks
}

fn errors(motions: &[VerifiedMotion]) -> Markup {
    const NUMBERS: [&str; 9] = [
        "rms before, µm",
        "predicted",
        "after",
        "greatest before, µm",
        "predicted",
        "after",
        "G before, µm",
        "predicted",
        "after",
    ];
    let columns: Vec<Column> =
        std::iter::once(Column::Words("motion")).chain(NUMBERS.map(Column::Numbers)).collect();
    let rows = html! {
        @for motion in motions {
            tr {
                th scope="row" { (text(&motion.name)) }
                @for value in figures(motion) {
                    (number_cell(&value.map_or("–".to_owned(), |um| fixed(um, 2))))
                }
            }
        }
    };
    html! {
        (note("G: circular deviation, the larger of both directions (ISO 230-4)."))
        (table(&columns, &rows))
        @let remarks = remarks(motions);
        @if !remarks.is_empty() { (list(&remarks)) }
    }
}

/// Rms, greatest error and circular deviation: each before, predicted and after, µm.
#[must_use]
pub fn figures(motion: &VerifiedMotion) -> [Option<f64>; 9] {
    let predicted = motion.predicted.as_ref();
    let circular = motion.circular_um();
    [
        Some(motion.before.rms_um),
        predicted.map(|p| p.after_um),
        Some(motion.after.rms_um),
        Some(motion.before.max_um),
        predicted.and_then(|p| p.max_after_um),
        Some(motion.after.max_um),
        circular.map(|[before, _]| before),
        circular.and(predicted).and_then(|p| p.circular_after_um),
        circular.map(|[_, after]| after),
    ]
}

/// The largest circle before and after; empty if the motion has none.
fn circles(motion: &VerifiedMotion) -> Markup {
    let errors = [("Before", &motion.before), ("After", &motion.after)];
    html! {
        (note(&format!("Measured at the {}.", motion.channel.word())))
        (on_one_scale(&errors, &motion.axes))
    }
}

/// The largest circle of each contour error, beside each other on one scale; empty if one has no circle.
pub(crate) fn on_one_scale(errors: &[(&str, &ContourError)], axes: &[String]) -> Markup {
    let largest = |error: &ContourError| -> Option<CircleError> {
        error.circles.iter().max_by(|a, b| a.radius.total_cmp(&b.radius)).cloned()
    };
    let circles: Option<Vec<(&str, CircleError)>> =
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

fn picture(title: &str, circle: &CircleError, division_um: f64, axes: &[String]) -> Markup {
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
