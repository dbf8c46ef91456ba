//! The circle of a trace: its radial deviation as measured, and what is unexplained before and after.

use maud::{Markup, html};

use super::axis_view::AxisView;
use super::radial_deviation::{Lap, Run, largest_circle};
use files::format::{signed, significant};
use files::log::Unit;
use pages::file_name;
use pages::markup::{figure, note};
use pages::polar::{class, directions, division_for, drawing, magnification};
use trace::Identification;

/// The section's body; empty if no log contains a circle of two linear axes with the required channels.
#[must_use]
pub fn body(trace: &Identification, views: &[AxisView<'_>]) -> Markup {
    let (Some((log, circle)), [x, y, ..]) = (largest_circle(trace.validate_logs()), views) else {
        return Markup::default();
    };
    if [x, y].iter().any(|view| view.trace.unit == Unit::Degree) {
        return Markup::default();
    }
    let run = Run { circle: &circle, log, signals: &trace.validate_logs()[log], axes: [x, y] };
    let Some((channel, measured)) = run.measured() else { return Markup::default() };
    let residuals = (!run.stages().is_empty())
        .then(|| [run.residual([&x.before, &y.before]), run.residual([&x.after, &y.after])]);
    html! {
        (note(&introduction(&run, channel, residuals.is_some())))
        div.circles {
            (picture(&run, "As measured", &measured, division(&[&measured])))
            @if let Some([before, after]) = &residuals {
                @let same = division(&[before, after]);
                (picture(&run, "Unexplained before", before, same))
                (picture(&run, "Unexplained after", after, same))
            }
        }
        (directions(measured.iter().map(|lap| lap.is_clockwise)))
    }
}

/// Explanation of the pictures.
fn introduction(run: &Run<'_>, channel: &str, has_residuals: bool) -> String {
    let [x, y] = run.axes.map(|axis| &axis.trace.axis);
    let mut introduction = format!(
        "{}: a circle of {} mm radius at {} mm/s, with +{x} to the right and +{y} up. Deviations outside the circle \
         are outwards. As measured: deviation of the {channel} from the commanded circle.",
        file_name(&run.signals.source),
        significant(1e3 * run.circle.radius, 3),
        significant(1e3 * run.speed(), 3),
    );
    if has_residuals {
        introduction += " Unexplained before: the deviation minus the prediction of the declared model. Unexplained \
                         after: the same with the effects found, at the same magnification.";
    }
    introduction
}

/// The smallest of 1, 2 and 5 times a power of ten µm at which all deviations are within the divisions.
fn division(all: &[&[Lap]]) -> f64 {
    let points = all.iter().copied().flatten().flat_map(|lap| &lap.points);
    division_for(numerics::max_abs(points.map(|point| point.1)))
}

/// One polar picture with its caption.
fn picture(run: &Run<'_>, title: &str, laps: &[Lap], division_um: f64) -> Markup {
    let points = || laps.iter().flat_map(|lap| &lap.points).map(|point| point.1);
    let [min, max] = numerics::min_max(points());
    let magnification = magnification(division_um, run.circle.radius);
    let caption = format!(
        "{title}: {} to {} µm. One division is {} µm, magnified {} times.",
        signed(min, 2),
        signed(max, 2),
        significant(division_um, 1),
        significant(magnification, 2),
    );
    let lines: Vec<(&str, &[(f64, f64)])> =
        laps.iter().map(|lap| (class(lap.is_clockwise), &lap.points[..])).collect();
    let title = format!("{title}: radial deviation over the angle");
    let axes = run.axes.map(|axis| axis.trace.axis.as_str());
    figure("", &drawing(&title, &caption, &lines, division_um, axes), &caption)
}
