//! Plots of the residual of each stage: over time, and over the variables on which it depends.

use maud::{Markup, html};

use super::axis_view::{AxisView, is_at_noise, series};
use super::variable::{label, means, of_effect, of_residual};
use files::format::significant;
use model::effects::{Abscissa, Stage};
use pages::file_name;
use pages::markup::{figure, folded, legend, line_entry, note, surface_entry, text};
use pages::plot::{Chart, Ink, Layer};
use trace::Identification;
use trace::fit::fit_data::ResidualSeries;
use trace::stages::{residual_unit, stage_names};

/// Maximum number of sections of a log in a plot; for each section the minimum and maximum are drawn.
const MAX_PIECES: usize = 700;

/// Maximum number of plots of a stage in addition to the one over time.
const MAX_VARIABLES: usize = 3;

const NOTE: &str = "Measured minus modelled, each stage simulated from the measured signal upstream, on held-out \
                    motions. Before: the declared model, with its values fitted within their tolerance. After: with \
                    the effects found.";

/// The section's body; empty if no stage could be evaluated.
pub fn body(trace: &Identification, views: &[AxisView<'_>]) -> Markup {
    let panels = html! {
        @for view in views {
            @for stage in stages_of(view) { (panel(trace, view, stage)) }
        }
    };
    if panels.0.is_empty() {
        return panels;
    }
    let entries = [
        surface_entry("before-range", "before, over time"),
        line_entry("before", "before, mean"),
        line_entry("after", "after"),
        surface_entry("noise", "within ± 2σ of the sensors' noise"),
    ];
    html! { (note(NOTE)) (legend(&entries)) (panels) }
}

/// The plots of a stage under their heading; empty if no log has a residual of it.
fn panel(trace: &Identification, view: &AxisView<'_>, stage: Stage) -> Markup {
    let Some(log) = view.log_with_largest_residual(stage) else { return Markup::default() };
    let variables = variables(view, stage);
    let means: Vec<String> =
        variables.iter().filter_map(|abscissa| mean_chart(view, stage, abscissa)).collect();
    let (class, width) = if means.is_empty() { ("wide", 960) } else { ("", 590) };
    let (chart, caption) = time_chart(trace, view, stage, log, width);
    let name = format!("{}, {}", view.trace.axis, stage_names(&[stage]));
    let plots = html! {
        div.stage {
            (figure(class, &chart, &caption))
            @for (i, chart) in means.iter().enumerate() { (figure(if i == 0 { "" } else { "right" }, chart, "")) }
        }
    };
    // What the effects found made as small as noise is a result, and not folded away.
    let is_noise = view.trace.residual(stage).is_some_and(|error| is_at_noise(view.trace, error));
    if is_noise && !view.is_changed(stage) {
        return folded(&format!("{name}: at the noise of the sensors"), &plots);
    }
    html! {
        h3 { (text(&name)) " " span.small { (text(meaning(stage))) } }
        (plots)
    }
}

/// The stages of an axis in the order of the chain.
fn stages_of(view: &AxisView<'_>) -> Vec<Stage> {
    let mut stages: Vec<Stage> = view.trace.residuals.iter().map(|error| error.stage).collect();
    stages.sort();
    stages
}

fn meaning(stage: Stage) -> &'static str {
    match stage {
        Stage::Motor => "motor reading minus prediction of the closed loop from the command",
        Stage::Table => "linear scale minus prediction from the measured motor",
        Stage::Tool => "tool probe minus prediction from the measured table",
        Stage::Force => "drive force minus prediction from the measured motion",
    }
}

/// The variables on which the effects found at a stage, or its remaining residual, depend.
fn variables(view: &AxisView<'_>, stage: Stage) -> Vec<Abscissa> {
    let mut variables = Vec::new();
    for found in view.trace.found.iter().filter(|found| found.stage == stage) {
        let abscissa = of_effect(&found.effect, view);
        if !variables.contains(&abscissa) && variables.len() < MAX_VARIABLES {
            variables.push(abscissa);
        }
    }
    if variables.is_empty() && view.is_changed(stage) {
        let touching = view.trace.found.iter().find(|found| found.effect.stages().contains(&stage));
        variables.extend(touching.map(|found| of_effect(&found.effect, view)));
    }
    if variables.is_empty() {
        let remainder = view.trace.unexplained.iter().find(|remainder| remainder.stage == stage);
        variables.extend(remainder.and_then(|r| of_residual(r.variable, view)));
    }
    variables
}

/// The SVG element of the residual of one log over time, and its caption.
fn time_chart(
    trace: &Identification,
    view: &AxisView<'_>,
    stage: Stage,
    log: usize,
    width: u32,
) -> (String, String) {
    let signals = &trace.validate_logs()[log];
    let (unit, _) = residual_unit(view.trace.unit, stage);
    let seconds = |i: usize| signals.start_s + i as f64 * signals.sample_s;
    let layer = |ink, points| Layer { ink, points, is_marked: false };
    let mut layers = Vec::new();
    if view.is_changed(stage) {
        let (skipped, values) = view.settled(&view.before, stage, log);
        layers.push(layer(Ink::BeforeRange, outline(values, |i| seconds(skipped + i))));
    }
    let (skipped, values) = view.settled(&view.after, stage, log);
    layers.push(layer(Ink::After, envelope(values, |i| seconds(skipped + i))));
    let caption = format!("{}: {}.", file_name(&signals.source), rms_before_and_after(view, stage, log));
    let chart = Chart {
        size: (width, 190),
        title: &format!("Residual of {}, {} over time", view.trace.axis, stage_names(&[stage])),
        description: &caption,
        x: "time, s",
        y: &format!("residual, {unit}"),
        noise: Some(2.0 * view.data.noise_of_log(&view.trace.model, stage, log)),
        layers,
    };
    (chart.svg(), caption)
}

fn rms_before_and_after(view: &AxisView<'_>, stage: Stage, log: usize) -> String {
    let (unit, _) = residual_unit(view.trace.unit, stage);
    let rms = |all: &[ResidualSeries]| {
        let rms = series(all, stage, log).map(|series| view.data.rms(std::slice::from_ref(series), stage));
        format!("{} {unit}", significant(rms.unwrap_or(0.0), 3))
    };
    if view.is_changed(stage) {
        format!("{} rms before, {} after", rms(&view.before), rms(&view.after))
    } else {
        format!("{} rms, unchanged by the effects found", rms(&view.after))
    }
}

/// The SVG element of the mean residual over a variable; `None` if the variable was not measured.
fn mean_chart(view: &AxisView<'_>, stage: Stage, abscissa: &Abscissa) -> Option<String> {
    let runs = |ink, parts| {
        let layer = move |points| Layer { ink, points, is_marked: true };
        means(view, parts, stage, abscissa).into_iter().map(layer)
    };
    let before = runs(Ink::Before, &view.before).filter(|_| view.is_changed(stage));
    let layers: Vec<Layer> = before.chain(runs(Ink::After, &view.after)).collect();
    if layers.is_empty() {
        return None;
    }
    let label = label(abscissa, view);
    let chart = Chart {
        size: (354, 190),
        title: &format!("Mean residual of {}, {} over {label}", view.trace.axis, stage_names(&[stage])),
        description: "All validation logs together.",
        x: &label,
        y: &format!("mean residual, {}", residual_unit(view.trace.unit, stage).0),
        noise: Some(0.0),
        layers,
    };
    Some(chart.svg())
}

/// Samples of each section; the last section may be shorter.
fn piece_length(samples: usize) -> usize {
    samples.div_ceil(MAX_PIECES).max(1)
}

/// Minimum and maximum of each section, in the order in which they occur.
fn envelope(values: &[f64], x: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
    let length = piece_length(values.len());
    let mut points = Vec::new();
    for start in (0..values.len()).step_by(length) {
        let range = start..(start + length).min(values.len());
        let (min, max) = positions_of_extremes(values, range);
        let (first, last) = (min.min(max), min.max(max));
        points.push((x(first), values[first]));
        if last != first {
            points.push((x(last), values[last]));
        }
    }
    points
}

/// Corners of the surface between minimum and maximum of each section. Neighbouring sections share a sample, so that the
/// surface has no gap where the signal is steep.
fn outline(values: &[f64], x: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
    let length = piece_length(values.len());
    let mut upper = Vec::new();
    let mut lower = Vec::new();
    for start in (0..values.len()).step_by(length) {
        let range = start..(start + length + 1).min(values.len());
        let middle = x(start + (range.len() - 1) / 2);
        let (min, max) = positions_of_extremes(values, range);
        upper.push((middle, values[max]));
        lower.push((middle, values[min]));
    }
    upper.into_iter().chain(lower.into_iter().rev()).collect()
}

/// Positions of the minimum and the maximum in a range that is not empty.
fn positions_of_extremes(values: &[f64], range: std::ops::Range<usize>) -> (usize, usize) {
    let start = range.start;
    range.fold((start, start), |(min, max), i| {
        (if values[i] < values[min] { i } else { min }, if values[i] > values[max] { i } else { max })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_envelope_keeps_every_peak() {
        let mut values = vec![0.0; 100_000];
        values[77_777] = 5.0;
        values[12_345] = -3.0;
        let points = envelope(&values, |i| i as f64);
        assert!(points.len() <= 2 * MAX_PIECES);
        assert!(points.contains(&(77_777.0, 5.0)) && points.contains(&(12_345.0, -3.0)));
        assert!(points.is_sorted_by(|a, b| a.0 < b.0));
        let surface = outline(&values, |i| i as f64);
        assert!(surface.iter().any(|p| p.1 >= 5.0) && surface.iter().any(|p| p.1 <= -3.0));
        assert!(envelope(&[], |i| i as f64).is_empty() && outline(&[], |i| i as f64).is_empty());
    }
}
