//! The residual of each stage against time, and against what it follows.

use super::markup::{figure, key, note, text};
use super::number::significant;
use super::plot::{Chart, Ink, Layer};
use super::stages::{AxisView, part};
use super::variable::{Across, means};
use model::effects::Stage;
use trace::Trace;
use trace::stages::{residual_unit, stage_names};

/// Most pieces that a log is cut into for a picture; each is drawn by its least and greatest value.
const PIECES: usize = 700;

/// Most pictures beside the one over time.
const MOST_VARIABLES: usize = 3;

/// The section's body; empty where no stage could be formed.
pub fn body(trace: &Trace, views: &[AxisView<'_>]) -> String {
    let of_axis = |view| stages_of(view).into_iter().map(move |stage| panel(trace, view, stage));
    let panels: String = views.iter().flat_map(of_axis).collect();
    if panels.is_empty() {
        return panels;
    }
    let keys = [
        key("before-range", true, "before, over time"),
        key("before", false, "before, mean"),
        key("after", false, "after"),
        key("noise", true, "within ± 2σ of the sensors' noise"),
    ];
    let what = "Measured minus modelled, each stage driven by the measured signal upstream of it, on motions that \
                took part in no fit. Before: the declared model at its best within its tolerance. After: with the \
                effects found.";
    format!("{}<p class=\"legend\">{}</p>\n{panels}", note(what), keys.concat())
}

fn panel(trace: &Trace, view: &AxisView<'_>, stage: Stage) -> String {
    let name = &view.trace.axis;
    let Some(log) = view.telling_log(stage) else { return String::new() };
    let variables = variables(trace, view, stage);
    let beside: Vec<String> =
        variables.iter().filter_map(|&across| curve(trace, view, stage, across)).collect();
    let over_time = over_time(trace, view, stage, log, if beside.is_empty() { 960 } else { 590 });
    let mut pictures = figure(if beside.is_empty() { "wide" } else { "" }, &over_time.0, &over_time.1);
    for (i, picture) in beside.iter().enumerate() {
        pictures += &figure(if i == 0 { "" } else { "right" }, picture, "");
    }
    format!(
        "<h3>{}, {} <span class=\"small\">{}</span></h3>\n<div class=\"stage\">\n{pictures}</div>\n",
        text(name),
        stage_names(&[stage]),
        text(meaning(stage))
    )
}

/// The stages of an axis in the order of the chain.
fn stages_of(view: &AxisView<'_>) -> Vec<Stage> {
    let mut stages: Vec<Stage> = view.trace.errors.iter().map(|error| error.stage).collect();
    stages.sort();
    stages
}

fn meaning(stage: Stage) -> &'static str {
    match stage {
        Stage::Motor => "motor reading minus what the model's loop makes of the command",
        Stage::Table => "table scale minus what the model makes of the measured motor",
        Stage::Tool => "tool probe minus what the model makes of the measured table",
        Stage::Force => "drive force minus what the measured motion needs",
    }
}

/// What the effects found at a stage follow, or what is left there does.
fn variables(trace: &Trace, view: &AxisView<'_>, stage: Stage) -> Vec<Across> {
    let own = view.evidence.axis;
    let mut variables = Vec::new();
    for found in view.trace.found.iter().filter(|found| found.stage == stage) {
        let across = Across::of_effect(&found.effect, view);
        if !variables.contains(&across) && variables.len() < MOST_VARIABLES {
            variables.push(across);
        }
    }
    if variables.is_empty() && view.is_changed(stage) {
        let touching = view.trace.found.iter().find(|found| found.effect.stages().contains(&stage));
        variables.extend(touching.map(|found| Across::of_effect(&found.effect, view)));
    }
    if variables.is_empty() {
        let rest = view.trace.unexplained.iter().find(|rest| rest.channel == stage);
        variables.extend(rest.and_then(|rest| Across::of_rest(rest.variable, trace.names.len(), own)));
    }
    variables
}

/// The picture over time of one log, and its caption.
fn over_time(trace: &Trace, view: &AxisView<'_>, stage: Stage, log: usize, width: u32) -> (String, String) {
    let signals = &trace.validate_logs[log];
    let (unit, _) = residual_unit(view.trace.unit, stage);
    let seconds = |i: usize| signals.start_s + i as f64 * signals.sample_s;
    let is_changed = view.is_changed(stage);
    let mut layers = Vec::new();
    if is_changed {
        let (skipped, values) = view.settled(&view.before, stage, log);
        layers.push(Layer {
            ink: Ink::BeforeRange,
            points: outline(values, |i| seconds(skipped + i)),
            is_marked: false,
        });
    }
    let (skipped, values) = view.settled(&view.after, stage, log);
    layers.push(Layer {
        ink: Ink::After,
        points: envelope(values, |i| seconds(skipped + i)),
        is_marked: false,
    });

    let source = super::file_name(&signals.source);
    let error = |parts| {
        let error = part(parts, stage, log).map(|part| view.evidence.rms(std::slice::from_ref(part), stage));
        format!("{} {unit}", significant(error.unwrap_or(0.0), 3))
    };
    let noise = view.evidence.noise_of_log(&view.trace.model, stage, log);
    let figures = if is_changed {
        format!("{} rms before, {} after", error(&view.before), error(&view.after))
    } else {
        format!("{} rms; what was found does not change it", error(&view.after))
    };
    let caption = format!("{source}: {figures}.");
    let chart = Chart {
        size: (width, 190),
        title: &format!("Residual of {}, {} over time", view.trace.axis, stage_names(&[stage])),
        description: &caption,
        x: "time, s",
        y: &format!("residual, {unit}"),
        noise: 2.0 * noise,
        layers,
    };
    (chart.svg(), caption)
}

/// The mean over a variable.
fn curve(trace: &Trace, view: &AxisView<'_>, stage: Stage, across: Across) -> Option<String> {
    let runs = |ink, parts| {
        let layer = move |points| Layer { ink, points, is_marked: true };
        means(view, parts, stage, across).into_iter().map(layer)
    };
    let before = runs(Ink::Before, &view.before).filter(|_| view.is_changed(stage));
    let layers: Vec<Layer> = before.chain(runs(Ink::After, &view.after)).collect();
    if layers.is_empty() {
        return None;
    }
    let label = across.label(&trace.names);
    let chart = Chart {
        size: (354, 190),
        title: &format!("Mean residual of {}, {} over {label}", view.trace.axis, stage_names(&[stage])),
        description: "All validation logs together.",
        x: &label,
        y: &format!("mean residual, {}", residual_unit(view.trace.unit, stage).0),
        noise: 0.0,
        layers,
    };
    Some(chart.svg())
}

/// Samples of each piece, the last of which may be shorter.
fn piece(samples: usize) -> usize {
    samples.div_ceil(PIECES).max(1)
}

/// Least and greatest value of each piece, in the order in which they occur.
fn envelope(values: &[f64], x: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
    let length = piece(values.len());
    let mut points = Vec::new();
    for start in (0..values.len()).step_by(length) {
        let range = start..(start + length).min(values.len());
        let (least, most) = extremes(values, range);
        let (first, last) = (least.min(most), least.max(most));
        points.push((x(first), values[first]));
        if last != first {
            points.push((x(last), values[last]));
        }
    }
    points
}

/// The surface between the least and the greatest value of each piece; pieces share their ends, so
/// that a steep line has a surface, too.
fn outline(values: &[f64], x: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
    let length = piece(values.len());
    let mut above = Vec::new();
    let mut below = Vec::new();
    for start in (0..values.len()).step_by(length) {
        let range = start..(start + length + 1).min(values.len());
        let middle = x(start + (range.len() - 1) / 2);
        let (least, most) = extremes(values, range);
        above.push((middle, values[most]));
        below.push((middle, values[least]));
    }
    above.into_iter().chain(below.into_iter().rev()).collect()
}

/// Where a range that is not empty has its least and its greatest value.
fn extremes(values: &[f64], range: std::ops::Range<usize>) -> (usize, usize) {
    let start = range.start;
    range.fold((start, start), |(least, most), i| {
        (if values[i] < values[least] { i } else { least }, if values[i] > values[most] { i } else { most })
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
        assert!(points.len() <= 2 * PIECES);
        assert!(points.contains(&(77_777.0, 5.0)) && points.contains(&(12_345.0, -3.0)));
        assert!(points.is_sorted_by(|a, b| a.0 < b.0));
        let around = outline(&values, |i| i as f64);
        assert!(around.iter().any(|p| p.1 >= 5.0) && around.iter().any(|p| p.1 <= -3.0));
        assert!(envelope(&[], |i| i as f64).is_empty() && outline(&[], |i| i as f64).is_empty());
    }
}
