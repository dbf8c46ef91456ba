//! Tables of the page of a trace: the residuals of all stages, the contour errors of the logs, and the comparison of effects found with the truth.

use maud::{Markup, html};

use contour::log_error::LogError;
use files::format::{signed, significant};
use model::effects::Effect;
use pages::markup::{Column, note, number_cell, paragraph, table, table_with, text, words_cell};
use trace::AxisIdentification;
use trace::judge::StageResidual;
use trace::judge::found_effect::FoundEffect;
use trace::stages::{residual_unit, stage_names};

const RESIDUALS_NOTE: &str = "Rms values. Fit: on the logs used in the fit. Validate: on held-out motions. Before: \
                              the declared model, with its values fitted within their tolerance. Noise: residual of \
                              a perfect model due to the sensors.";

/// Residuals before and after, by axis and stage; empty if no stage could be evaluated.
pub fn errors(axes: &[AxisIdentification]) -> Markup {
    if axes.iter().all(|axis| axis.residuals.is_empty()) {
        return Markup::default();
    }
    let parts = html! {
        thead {
            tr {
                th rowspan="2" scope="col" { "axis" }
                th rowspan="2" scope="col" { "channel" }
                th rowspan="2" scope="col" { "unit" }
                th.n colspan="2" scope="colgroup" { "before" }
                th.n colspan="2" scope="colgroup" { "after" }
                th.n rowspan="2" scope="col" { "noise" }
            }
            tr {
                @for _ in ["before", "after"] {
                    th.n scope="col" { "fit" }
                    th.n scope="col" { "validate" }
                }
            }
        }
        tbody {
            @for axis in axes {
                @for error in in_order_of_stages(axis) { (error_row(axis, error)) }
            }
        }
    };
    html! {
        (note(RESIDUALS_NOTE))
        (table_with("", "Residuals before and after", &parts))
    }
}

fn in_order_of_stages(axis: &AxisIdentification) -> Vec<&StageResidual> {
    let mut errors: Vec<&StageResidual> = axis.residuals.iter().collect();
    errors.sort_by_key(|error| error.stage);
    errors
}

fn error_row(axis: &AxisIdentification, error: &StageResidual) -> Markup {
    let (name, unit) = (stage_names(&[error.stage]), residual_unit(axis.unit, error.stage).0);
    let (before, after) = (&error.before, &error.after);
    html! {
        tr {
            th scope="row" { (text(&axis.axis)) }
            td { (name) }
            td { (unit) }
            (number_cell(&significant(before.fit, 3)))
            (number_cell(&significant(before.validate, 3)))
            (after_cell(before.fit, after.fit))
            (after_cell(before.validate, after.validate))
            (number_cell(&significant(error.noise, 3)))
        }
    }
}

/// A residual after the search, highlighted if it is at least 5 % smaller than before.
fn after_cell(before: f64, after: f64) -> Markup {
    html! { td.n.gained[after < 0.95 * before] { (text(&significant(after, 3))) } }
}

const CONTOUR_NOTE: &str = "Distance of the measured position from the path of the command, in the samples as logged; of a single \
                            axis, its following error. G: circular deviation of the largest full circle, the larger of its \
                            directions (ISO 230-4). H: circular hysteresis between its directions. Peak: the largest at a \
                            reversal. F: radial deviation about the programmed centre. Overshoot: the largest of all corners.";

/// The contour error of each log; empty without logs.
pub fn contour_errors(logs: &[LogError]) -> Markup {
    const WORDS: [&str; 2] = ["log", "channel"];
    const NUMBERS: [&str; 7] =
        ["rms, µm", "greatest, µm", "G, µm", "H, µm", "peak, µm", "F, µm", "overshoot, µm"];
    if logs.is_empty() {
        return Markup::default();
    }
    let columns: Vec<Column> =
        WORDS.map(Column::Words).into_iter().chain(NUMBERS.map(Column::Numbers)).collect();
    let rows = html! { @for log in logs { (contour_row(log)) } };
    html! { (note(CONTOUR_NOTE)) (table("Contour error of each log", &columns, &rows)) }
}

fn contour_row(log: &LogError) -> Markup {
    let error = &log.error;
    let shown = |value: Option<f64>| value.map_or("–".to_owned(), |um| significant(um, 3));
    let laps = error.circles.iter().flat_map(|circle| &circle.laps).flat_map(|lap| lap.radial_um);
    let radial_um: Vec<f64> = laps.collect();
    let radial = if radial_um.is_empty() {
        "–".to_owned()
    } else {
        numerics::min_max(radial_um).map(|um| signed(um, 2)).join(" to ")
    };
    html! {
        tr {
            th scope="row" { (text(&log.log)) }
            td { (log.channel.word()) @if error.is_along_axis { " (one axis: following error)" } }
            (number_cell(&significant(error.rms_um, 3)))
            (number_cell(&significant(error.max_um, 3)))
            (number_cell(&shown(error.circular_um())))
            (number_cell(&shown(error.hysteresis_um())))
            (number_cell(&shown(error.reversal_peak_um())))
            (number_cell(&radial))
            (number_cell(&shown(error.overshoot_um())))
        }
    }
}

/// Comparison of the true effects with those found, with the error of each parameter.
pub fn truth(axes: &[AxisIdentification], truth: &[(String, Effect)]) -> Markup {
    let rows = html! {
        @for (axis, effect) in truth { (truth_row(axes, axis, effect)) }
        @for axis in axes {
            @for found in false_effects(axis, truth) {
                (row([&axis.axis, "none", &found.effect.sentence(&found.half_widths, false), ""]))
            }
        }
    };
    if rows.0.is_empty() {
        return paragraph("The machine had no undeclared effect.");
    }
    html! {
        h3 { "Comparison with the true effects, which the tracer did not know" }
        (table("True effects and those found", &["axis", "truth", "found", "error"].map(Column::Words), &rows))
    }
}

/// False effects: found, but not present in the machine.
fn false_effects<'a>(axis: &'a AxisIdentification, truth: &[(String, Effect)]) -> Vec<&'a FoundEffect> {
    let is_true = |found: &FoundEffect| {
        truth.iter().any(|(name, effect)| *name == axis.axis && effect.is_same(&found.effect))
    };
    axis.found.iter().filter(|found| !is_true(found)).collect()
}

fn truth_row(axes: &[AxisIdentification], name: &str, effect: &Effect) -> Markup {
    let found = axes.iter().find(|axis| axis.axis == name).map_or(&[][..], |axis| &axis.found);
    let (shown, errors) = match found.iter().find(|found| found.effect.is_same(effect)) {
        Some(found) => (found.effect.sentence(&found.half_widths, false), parameter_errors(effect, found)),
        None => ("not found".to_owned(), String::new()),
    };
    row([name, &effect.sentence(&[], false), &shown, &errors])
}

fn row([axis, truth, found, errors]: [&str; 4]) -> Markup {
    html! {
        tr {
            th scope="row" { (text(axis)) }
            (words_cell(truth))
            (words_cell(found))
            (words_cell(errors))
        }
    }
}

/// Error of each parameter that is not declared: of a phase in degrees within ±180, otherwise in percent of the true
/// value.
fn parameter_errors(truth: &Effect, found: &FoundEffect) -> String {
    let values = truth.values().into_iter().zip(found.effect.values());
    let errors =
        truth.declared_parameters().into_iter().zip(values).filter_map(|(parameter, (truth, found))| {
            let error = found - truth;
            let name = parameter.title();
            if parameter.period.is_some() {
                let wrapped = numerics::wrapped(error, std::f64::consts::TAU);
                Some(format!("{name} {}°", signed(wrapped.to_degrees(), 2)))
            } else if error.abs() <= 1e-9 * truth.abs() {
                None
            } else {
                Some(format!("{name} {} %", signed(100.0 * error / truth.abs(), 2)).trim_start().to_owned())
            }
        });
    errors.collect::<Vec<_>>().join(", ")
}
