//! The drift of a fit as effects: alike everywhere, growing along the axis, and what varies over position beside these.

use nalgebra::DVector;

use files::format::{signed, significant};

use super::course::Clock;
use super::effect::{Effect, Parameter};
use super::source::{Source, is_there};
use super::variant::Drift;

/// The effects of a drift.
pub(crate) fn of(source: &Source<'_>) -> Vec<Effect> {
    if source.fit.variant.drift == Drift::None {
        return Vec::new();
    }
    [uniform(source), growth(source), over_position(source)].into_iter().flatten().collect()
}

/// Change at all targets alike, from the first instant to the last.
fn uniform(source: &Source<'_>) -> Option<Effect> {
    let columns = source.columns().drift;
    let [mean_row, _] = source.line_rows();
    let (row, of_one) = match source.fit.variant.drift {
        Drift::Map => (mean_row, vec![1.0; columns.len()]),
        _ => (vec![1.0], vec![1.0]),
    };
    let found = source.value(&source.weights(&columns, &row));
    let part = found.0 * source.weights(&columns, &of_one);
    let timed = timed(source, found);
    let name =
        if source.clock == Clock::Seconds && timed.is_none() { "thermal_rate" } else { "thermal_drift" };
    let mut effect = source.effect(name, found.0.abs(), part).with_rivals(["laser_drift"]);
    match (source.clock, timed) {
        (Clock::Seconds, Some(amplitude)) => {
            effect.parameters.insert("amplitude_um", Parameter::number(amplitude.0, amplitude.1));
            effect.parameters.extend(time_constant(source).map(|constant| ("time_constant_s", constant)));
        }
        (Clock::Seconds, None) => {
            let minutes = (source.grid.course.span[1] - source.grid.course.span[0]) / 60.0;
            let rate = Parameter::number(found.0 / minutes, found.1 / minutes);
            effect.parameters.insert("um_per_min", rate);
        }
        (Clock::Runs, _) => {
            let runs = source.grid.course.span[1] - source.grid.course.span[0];
            effect.parameters.insert("amplitude_um", Parameter::number(found.0, found.1));
            effect.parameters.insert("um_per_run", Parameter::number(found.0 / runs, found.1 / runs));
            effect.parameters.extend(time_constant(source).map(|constant| ("time_constant_runs", constant)));
        }
    }
    effect.sentence =
        format!("all positions move by {} µm from the first run to the last", signed(found.0, 3));
    is_there(found).then_some(effect)
}

/// Change in proportion to the position.
fn growth(source: &Source<'_>) -> Option<Effect> {
    let columns = source.columns().drift;
    let [_, slope_row] = source.line_rows();
    let along: Vec<f64> = source.grid.lines().column(1).iter().copied().collect();
    let (row, of_one) = match source.fit.variant.drift {
        Drift::Line => (vec![0.0, 1.0], vec![0.0, 1.0]),
        Drift::Map => (slope_row, along),
        _ => return None,
    };
    let found = source.value(&source.weights(&columns, &row));
    let part = found.0 * source.weights(&columns, &of_one);
    let um = found.0.abs() * source.travel_m();
    let mut effect = source.effect("thermal_growth", um, part).with_rivals(["air_temperature"]);
    let timed = timed(source, found).filter(|_| source.clock == Clock::Seconds);
    let (value, half_width) = timed.unwrap_or(found);
    effect.parameters.insert("um_per_m", Parameter::number(value, half_width));
    let key = if source.clock == Clock::Seconds { "time_constant_s" } else { "time_constant_runs" };
    effect.parameters.extend(time_constant(source).map(|constant| (key, constant)));
    effect.sentence = format!("the axis grows by {} µm/m from the first run to the last", signed(found.0, 3));
    is_there(found).then_some(effect)
}

/// What varies over position beside a straight line: no laser and no air does that.
fn over_position(source: &Source<'_>) -> Option<Effect> {
    if source.fit.variant.drift != Drift::Map {
        return None;
    }
    let columns = source.columns().drift;
    let bent = source.grid.without_line();
    let row = |index: usize| bent.row(index).iter().copied().collect::<Vec<_>>();
    let (values, half_widths): (Vec<f64>, Vec<f64>) =
        (0..columns.len()).map(|index| source.value_at_knot(&source.weights(&columns, &row(index)))).unzip();
    let mut part = DVector::zeros(source.fit.coefficients.len());
    part.rows_mut(columns.start, columns.len()).copy_from_slice(&values);
    let um = numerics::peak_to_peak(values.iter().copied());
    let mut effect = source.effect("drift_map", um, part);
    effect.parameters.insert("positions_mm", source.knots());
    effect.parameters.insert("change_um", Parameter::list(values, &half_widths));
    effect.sentence = format!(
        "the curve over position changes by {} µm from the first run to the last",
        significant(um, 3)
    );
    Some(effect)
}

/// The time constant with its interval, if the runs show it.
fn time_constant(source: &Source<'_>) -> Option<Parameter> {
    let value = source.grid.course.time_constant?;
    Some(Parameter::Number { value, ci95: Some(source.time_constant_ci95?) })
}

/// Final value of A·(1 − exp(−t/τ)) on the clock of the session, from the change over the runs: A = change/(exp(−t₀/τ) − exp(−t₁/τ)).
/// `None` if the runs show no time constant.
fn timed(source: &Source<'_>, (change, half_width): (f64, f64)) -> Option<(f64, f64)> {
    let [low, high] = source.time_constant_ci95?;
    let [first, last] = source.grid.course.span;
    let factor = |constant: f64| 1.0 / (libm::exp(-first / constant) - libm::exp(-last / constant));
    let own = factor(source.grid.course.time_constant?);
    let of_constant = 0.5 * (factor(low) - factor(high)).abs() * change.abs();
    Some((own * change, libm::hypot(own * half_width, of_constant)))
}
