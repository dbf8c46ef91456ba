//! A row for each parameter: the errors of all cases, and the coverage of the confidence intervals.

use maud::{Markup, html};

use crate::summary::{Parameter, Proportion};
use pages::markup::{Attributes, svg, text};

/// Height of a row, width of the names next to the rows, height of the labels above them, in pixels of the page.
const ROW: u32 = 22;
const LEFT: u32 = 300;
const TOP: u32 = 30;
/// Widths of the two parts and of the space between them.
const ERRORS: f64 = 400.0;
const GAP: f64 = 50.0;
const COVERAGE: f64 = 200.0;
/// Ends of the scale of errors, powers of ten of percent.
const DECADES: (i32, i32) = (-3, 2);

const TITLE: &str = "Errors of the parameters and coverage of their confidence intervals";
const DESCRIPTION: &str = "On the left the relative error of each case on a logarithmic scale, with the median; on \
                           the right the coverage of the 95 % confidence intervals, with its own 95 % interval.";

/// The SVG element, for parameters that the machine file does not determine; empty if there are none.
pub fn picture(parameters: &[Parameter]) -> String {
    let rows: Vec<_> = parameters.iter().filter_map(|p| p.coverage.map(|coverage| (p, coverage))).collect();
    if rows.is_empty() {
        return String::new();
    }
    let bottom = TOP + ROW * u32::try_from(rows.len()).unwrap_or(0);
    let body = html! {
        (scales(bottom))
        @for (top, (parameter, coverage)) in (TOP..).step_by(ROW as usize).zip(&rows) {
            (name(parameter, top))
            (errors(parameter, top))
            (coverage_interval(*coverage, top))
        }
    };
    svg((980, bottom + 6), Attributes::default(), (TITLE, DESCRIPTION), &body)
}

/// Labelled vertical lines of both scales.
fn scales(bottom: u32) -> Markup {
    let label = |decade: i32| {
        let decimals = if decade < 0 { decade.unsigned_abs() as usize } else { 0 };
        format!("{:.decimals$} %", 10_f64.powi(decade))
    };
    html! {
        @for decade in DECADES.0..=DECADES.1 {
            (tick(error_x(10_f64.powi(decade)), bottom, &label(decade), "grid"))
        }
        @for (fraction, class) in [(0.0, "grid"), (0.5, "grid"), (0.95, "axis")] {
            (tick(coverage_x(fraction), bottom, &format!("{:.0} %", 100.0 * fraction), class))
        }
    }
}

fn tick(x: f64, bottom: u32, label: &str, class: &str) -> Markup {
    let x = format!("{x:.1}");
    html! {
        line class=(class) x1=(x) y1=(TOP) x2=(x) y2=(bottom) {}
        text.label font-size="11" text-anchor="middle" x=(x) y=(TOP - 10) { (text(label)) }
    }
}

fn name(parameter: &Parameter, top: u32) -> Markup {
    let name = format!("{} {}", parameter.effect, parameter.parameter).replace('_', " ");
    html! {
        text.label font-size="12" text-anchor="end" x=(LEFT - 14) y=(top + ROW / 2 + 4) { (text(&name)) }
    }
}

/// A point for each error, and a stroke for the median.
fn errors(parameter: &Parameter, top: u32) -> Markup {
    let median = format!("{:.1}", error_x(100.0 * parameter.error.median));
    html! {
        @for error in &parameter.errors {
            circle.after fill-opacity="0.5" cx=(format_args!("{:.1}", error_x(100.0 * error))) cy=(top + ROW / 2) r="3" {}
        }
        line.median x1=(median) y1=(top + 4) x2=(median) y2=(top + ROW - 4) {}
    }
}

/// The coverage as a point on its confidence interval.
fn coverage_interval(coverage: Proportion, top: u32) -> Markup {
    let [low, high] = coverage.interval().map(|end| format!("{:.1}", coverage_x(end)));
    let middle = top + ROW / 2;
    html! {
        line.after x1=(low) y1=(middle) x2=(high) y2=(middle) {}
        circle.after cx=(format_args!("{:.1}", coverage_x(coverage.fraction()))) cy=(middle) r="3.5" {}
    }
}

/// Position of an error in percent; one beyond the scale is drawn at its end.
fn error_x(percent: f64) -> f64 {
    let (low, high) = (f64::from(DECADES.0), f64::from(DECADES.1));
    let decade = libm::log10(percent.max(f64::MIN_POSITIVE)).clamp(low, high);
    f64::from(LEFT) + ERRORS * (decade - low) / (high - low)
}

/// Position of a coverage from 0 to 1.
fn coverage_x(fraction: f64) -> f64 {
    f64::from(LEFT) + ERRORS + GAP + COVERAGE * fraction
}
