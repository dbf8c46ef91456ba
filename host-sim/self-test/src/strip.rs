//! Parameters one under the other: the error of each case, and how often the confidence interval held the truth.

use crate::summary::Parameter;
use report::markup::{svg, text};

const ROW: u32 = 22;
const BESIDE: u32 = 300;
const ABOVE: u32 = 30;
/// Widths of the two parts and of the space between them.
const ERRORS: f64 = 400.0;
const GAP: f64 = 50.0;
const COVERAGE: f64 = 200.0;
/// Ends of the scale of errors, powers of ten of percent.
const DECADES: (i32, i32) = (-3, 2);

/// The picture of what the machine file does not give away; nothing where there is no such parameter.
pub fn picture(parameters: &[Parameter]) -> String {
    let rows: Vec<_> = parameters.iter().filter_map(|p| p.coverage.map(|coverage| (p, coverage))).collect();
    if rows.is_empty() {
        return String::new();
    }
    let bottom = ABOVE + ROW * u32::try_from(rows.len()).unwrap_or(0);
    let start = f64::from(BESIDE);
    let share_start = start + ERRORS + GAP;
    let share = |share: f64| share_start + COVERAGE * share;
    let mut body = String::new();
    for decade in DECADES.0..=DECADES.1 {
        let said = if decade < 0 {
            format!("{:.*}", decade.unsigned_abs() as usize, 10_f64.powi(decade))
        } else {
            format!("{:.0}", 10_f64.powi(decade))
        };
        body += &tick(place(10_f64.powi(decade)), bottom, &format!("{said} %"), "grid");
    }
    for (at, class) in [(0.0, "grid"), (0.5, "grid"), (0.95, "axis")] {
        body += &tick(share(at), bottom, &format!("{:.0} %", 100.0 * at), class);
    }
    for (y, (parameter, coverage)) in (ABOVE..).step_by(ROW as usize).zip(&rows) {
        let middle = y + ROW / 2;
        let name = format!("{} {}", parameter.effect, parameter.parameter).replace('_', " ");
        body += &format!(
            "<text class=\"label\" font-size=\"12\" text-anchor=\"end\" x=\"{}\" y=\"{}\">{}</text>\n",
            BESIDE - 14,
            middle + 4,
            text(&name)
        );
        for error in &parameter.errors {
            let x = place(100.0 * error);
            body += &format!(
                "<circle class=\"after\" fill-opacity=\"0.5\" cx=\"{x:.1}\" cy=\"{middle}\" r=\"3\"/>\n"
            );
        }
        let x = place(100.0 * parameter.error.median);
        body += &format!(
            "<line class=\"median\" x1=\"{x:.1}\" y1=\"{}\" x2=\"{x:.1}\" y2=\"{}\"/>\n",
            y + 4,
            y + ROW - 4
        );
        let [low, high] = coverage.interval().map(share);
        body += &format!(
            "<line class=\"after\" x1=\"{low:.1}\" y1=\"{middle}\" x2=\"{high:.1}\" y2=\"{middle}\"/>\n<circle \
             class=\"after\" cx=\"{:.1}\" cy=\"{middle}\" r=\"3.5\"/>\n",
            share(coverage.share())
        );
    }
    svg(
        (980, bottom + 6),
        "Errors of the parameters and coverage of their confidence intervals",
        "On the left the relative error of each case on a logarithmic scale, with the median; on the right the share of \
         the truths inside the 95 % confidence intervals, with its own 95 % interval.",
        &body,
    )
}

/// Where an error of so many percent stands; what is beyond the scale, at its end.
fn place(percent: f64) -> f64 {
    let (low, high) = (f64::from(DECADES.0), f64::from(DECADES.1));
    let decade = percent.max(f64::MIN_POSITIVE).log10().clamp(low, high);
    f64::from(BESIDE) + ERRORS * (decade - low) / (high - low)
}

fn tick(x: f64, bottom: u32, said: &str, class: &str) -> String {
    format!(
        "<line class=\"{class}\" x1=\"{x:.1}\" y1=\"{ABOVE}\" x2=\"{x:.1}\" y2=\"{bottom}\"/>\n<text class=\"label\" \
         font-size=\"11\" text-anchor=\"middle\" x=\"{x:.1}\" y=\"{}\">{}</text>\n",
        ABOVE - 10,
        text(said)
    )
}
