//! The residuals of all stages as a table, and what was found beside the truth.

use super::markup::{note, text};
use super::number::{fixed, signed};
use super::{parameters, words};
use model::effects::Effect;
use trace::effect_identity::is_same;
use trace::outcome::{AxisTrace, StageError};
use trace::stages::{residual_unit, stage_names};
use trace::validation::found::Found;

/// Errors before and after, by axis and stage; empty where no stage could be formed.
pub fn errors(axes: &[AxisTrace]) -> String {
    let of_axis = |axis: &AxisTrace| -> String {
        let mut errors: Vec<&StageError> = axis.errors.iter().collect();
        errors.sort_by_key(|error| error.stage);
        errors.into_iter().map(|error| row(axis, error)).collect()
    };
    let rows: String = axes.iter().map(of_axis).collect();
    if rows.is_empty() {
        return rows;
    }
    let what = "Root mean square. Fit: on the logs that the models were fitted to. Validate: on motions that took \
                part in no fit. Before: the declared model at its best within its tolerance. Noise: \
                what the sensors make of a perfect model.";
    format!(
        "{}<table>\n<thead>\n<tr><th rowspan=\"2\" scope=\"col\">axis</th><th rowspan=\"2\" \
         scope=\"col\">channel</th><th rowspan=\"2\" scope=\"col\">unit</th><th class=\"n\" colspan=\"2\" \
         scope=\"colgroup\">before</th><th class=\"n\" colspan=\"2\" scope=\"colgroup\">after</th><th class=\"n\" \
         rowspan=\"2\" scope=\"col\">noise</th></tr>\n<tr><th class=\"n\" scope=\"col\">fit</th><th class=\"n\" \
         scope=\"col\">validate</th><th class=\"n\" scope=\"col\">fit</th><th class=\"n\" scope=\"col\">validate</th>\
         </tr>\n</thead>\n<tbody>\n{rows}</tbody>\n</table>\n",
        note(what)
    )
}

fn row(axis: &AxisTrace, error: &StageError) -> String {
    let (name, unit) = (stage_names(&[error.stage]), residual_unit(axis.unit, error.stage).0);
    let cell = |value: f64| format!("<td class=\"n\">{}</td>", fixed(value, 3));
    // What the effects found made smaller stands out.
    let gained = |before: f64, after: f64| {
        let value = cell(after);
        if after < 0.95 * before { value.replace("\"n\"", "\"n gained\"") } else { value }
    };
    let (before, after) = (&error.before, &error.after);
    let figures = [
        cell(before.fit),
        cell(before.validate),
        gained(before.fit, after.fit),
        gained(before.validate, after.validate),
        cell(error.noise),
    ]
    .concat();
    format!("<tr><th scope=\"row\">{}</th><td>{name}</td><td>{unit}</td>{figures}</tr>\n", text(&axis.axis))
}

/// What the machine had in truth beside what was found, with the error of each parameter.
pub fn truth(axes: &[AxisTrace], truth: &[(String, Effect)]) -> String {
    let of_axis = |name: &str| axes.iter().find(|axis| axis.axis == name).map_or(&[][..], |axis| &axis.found);
    let mut rows = String::new();
    for (axis, effect) in truth {
        let found = of_axis(axis).iter().find(|found| is_same(&found.effect, effect));
        let (said, errors) = match found {
            Some(found) => {
                (words::effect(&found.effect, &found.half_widths), parameter_errors(effect, found))
            }
            None => ("not found".to_owned(), String::new()),
        };
        rows += &truth_row(axis, &words::effect(effect, &[]), &said, &errors);
    }
    for axis in axes {
        let is_false =
            |found: &&Found| !truth.iter().any(|(a, e)| *a == axis.axis && is_same(e, &found.effect));
        for found in axis.found.iter().filter(is_false) {
            rows +=
                &truth_row(&axis.axis, "not there", &words::effect(&found.effect, &found.half_widths), "");
        }
    }
    if rows.is_empty() {
        return "<p>In truth the machine had no effect that its declared model lacks.</p>\n".to_owned();
    }
    format!(
        "<h3>The truth, which nobody had told the tracer</h3>\n<table>\n<thead><tr><th scope=\"col\">axis</th><th \
         scope=\"col\">truth</th><th scope=\"col\">found</th><th scope=\"col\">error</th></tr></thead>\n\
         <tbody>\n{rows}</tbody>\n</table>\n"
    )
}

fn truth_row(axis: &str, truth: &str, found: &str, errors: &str) -> String {
    let [axis, truth, found, errors] = [axis, truth, found, errors].map(text);
    format!("<tr><th scope=\"row\">{axis}</th><td>{truth}</td><td>{found}</td><td>{errors}</td></tr>\n")
}

/// Error of each parameter that is not known beforehand: an angle in degrees, else in percent of the
/// truth.
fn parameter_errors(truth: &Effect, found: &Found) -> String {
    const TURN: f64 = std::f64::consts::TAU;
    let pairs = truth.parameters().into_iter().zip(found.effect.parameters());
    let errors = pairs.filter_map(|((key, truth), (_, found))| {
        let error = found - truth;
        let (name, _) = parameters::parameter(key);
        if key.starts_with("phase") {
            let apart = (error + 0.5 * TURN).rem_euclid(TURN) - 0.5 * TURN;
            Some(format!("{name} {}°", signed(apart.to_degrees(), 2)))
        } else if error.abs() <= 1e-9 * truth.abs() {
            None
        } else {
            Some(format!("{name} {} %", signed(100.0 * error / truth.abs(), 2)).trim_start().to_owned())
        }
    });
    errors.collect::<Vec<_>>().join(", ")
}
