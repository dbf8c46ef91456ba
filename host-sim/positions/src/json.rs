//! The result as JSON.

use serde::Serialize;

use super::analysis::{Analysis, Residual};
use super::effect::Effect;
use super::iso::{Figures, Position};
use super::measured::Test;

/// The document of `positions --json`.
#[derive(Serialize)]
pub struct Document<'a> {
    iso_230_2_um: &'a Figures,
    residual_um: &'a Residual,
    effects: &'a [Effect],
    unexplained: Vec<Unexplained<'a>>,
    scatter_um: Option<f64>,
    axis: &'a str,
    fit: Files<'a>,
    validate: Vec<Files<'a>>,
    targets: Vec<Target>,
    notes: Vec<&'a str>,
}

/// A file and what is in it.
#[derive(Serialize)]
struct Files<'a> {
    file: &'a str,
    runs: usize,
    readings: usize,
}

/// What no effect takes.
#[derive(Serialize)]
struct Unexplained<'a> {
    channel: &'static str,
    axis: &'a str,
    rms_um: f64,
    share_percent: f64,
    variable: &'static str,
}

/// A target with the figures of its approaches.
#[derive(Serialize)]
struct Target {
    #[serde(rename = "target_mm")]
    mm: f64,
    positive: Option<Way>,
    negative: Option<Way>,
    reversal_um: Option<f64>,
}

#[derive(Serialize)]
struct Way {
    approaches: usize,
    mean_um: f64,
    standard_deviation_um: Option<f64>,
}

/// The document of a result.
#[must_use]
pub fn of(analysis: &Analysis) -> Document<'_> {
    let Analysis { residual, .. } = analysis;
    let share = residual.after.fit / residual.before.fit.max(f64::MIN_POSITIVE);
    Document {
        iso_230_2_um: &analysis.figures,
        residual_um: residual,
        effects: &analysis.effects,
        unexplained: vec![Unexplained {
            // A laser measures where the tool or the workpiece is.
            channel: "tool",
            axis: &analysis.axis,
            rms_um: residual.after.fit,
            share_percent: 100.0 * share * share,
            variable: "none",
        }],
        scatter_um: analysis.scatter_um,
        axis: &analysis.axis,
        fit: files(&analysis.test),
        validate: analysis.validate.iter().map(files).collect(),
        targets: analysis.positions.iter().map(target).collect(),
        notes: analysis.figure_notes.iter().chain(&analysis.notes).map(String::as_str).collect(),
    }
}

/// A file by the last part of its path: results do not show the folders of their author.
fn files(test: &Test) -> Files<'_> {
    let file = test.source.rsplit(['/', '\\']).next().unwrap_or(&test.source);
    Files { file, runs: test.runs(), readings: test.readings.len() }
}

fn target(position: &Position) -> Target {
    let [positive, negative] = position.ways.map(|way| {
        way.map(|way| Way {
            approaches: way.count,
            mean_um: way.mean_um,
            standard_deviation_um: way.deviation_um,
        })
    });
    Target { mm: position.target_mm, positive, negative, reversal_um: position.reversal_um() }
}
