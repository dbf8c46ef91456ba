//! The error of the tracer's own simulation of the driven stages.
//!
//! The input of the driven mechanics is the filtered motor, whose reversals are smoother than those of the machine, and the
//! integration steps add damping. After a jerk or a reversal, this causes an error of some hundredths of a micrometre. To
//! compute it, the fitted model is simulated in closed loop with the same command. The resulting logs are those of a machine
//! that equals the model, so that their residual is this error. As it depends only weakly on the model, it is computed once
//! for each effect found.

use super::axis_model::AxisModel;
use super::fit_data::{FitData, ResidualSeries};
use super::least_squares::{self, Fitted};
use super::scope::{Scope, ShownIn};
use super::tool_bias;
use crate::input::signals::{AxisSignals, Signals};
use crate::input::smoothing::Smooth;
use model::effects::{Channel, Stage};
use numerics::resample::{delayed_cubic, delayed_linear};

/// The error in the driven stages or in the tool stage of all scopes.
#[must_use]
pub fn of_all(data: &FitData<'_>, model: &AxisModel, scopes: &[Scope]) -> Vec<ResidualSeries> {
    scopes.iter().flat_map(|scope| of(data, model, scope)).collect()
}

/// The error in the driven stages or in the tool stage of a scope, for all logs; empty for another scope or if a loop cannot
/// be simulated.
#[must_use]
pub fn of(data: &FitData<'_>, model: &AxisModel, scope: &Scope) -> Vec<ResidualSeries> {
    if scope.shown_in != ShownIn::default() {
        return Vec::new();
    }
    let is_driven = |stage: &Stage| matches!(stage, Stage::Table | Stage::Force);
    let simulated = match &scope.stages[..] {
        [Stage::Tool] if tool_bias::is_needed(model) => tool_bias::simulated,
        stages if stages.iter().all(is_driven) => simulated,
        _ => return Vec::new(),
    };
    // A log without the channels of the scope has no residual.
    let is_evaluated = |log: usize| scope.stages.iter().any(|&stage| data.has(stage, log));
    let of_log =
        |log| if is_evaluated(log) { simulated(data, model, log) } else { Some(data.logs[log].clone()) };
    let Some(logs) = (0..data.logs.len()).map(of_log).collect::<Option<Vec<Signals>>>() else {
        return Vec::new();
    };
    // The simulated logs are those of the model without its tables.
    let without_tables = model.with_tables(Vec::new());
    FitData { logs: &logs, bias: &[], exclusions: &[], ..*data }.residuals(&without_tables, scope)
}

/// The error of a model of a file that an earlier trace wrote, if subtracting it lowers the residuals: the values of such a
/// file were fitted with the error subtracted, but possibly to other logs. Empty for other files.
#[must_use]
pub fn of_fitted_file(data: &FitData<'_>, model: &AxisModel, scope: &Scope) -> Vec<ResidualSeries> {
    if !model.was_fitted() {
        return Vec::new();
    }
    let bias = of(data, model, scope);
    let with = data.residuals(model, scope);
    let without = FitData { bias: &bias, ..*data }.residuals(model, scope);
    if is_less(data, [&with, &without], scope) { bias } else { Vec::new() }
}

/// Decrease of the logarithm of a residual from which another start of a fit is better: 1 %.
const MIN_GAIN_OF_START: f64 = 0.01;

/// Fits the free parameters of a scope before any search; also returns the error that was subtracted.
#[must_use]
pub fn first_fit(data: &FitData<'_>, start: &AxisModel, scope: &Scope) -> (Fitted, Vec<ResidualSeries>) {
    let bias = of_fitted_file(data, start, scope);
    (from_best_start(&FitData { bias: &bias, ..*data }, start, scope), bias)
}

/// Fits the free parameters of a scope from a model, and from its other starts where one leaves less.
#[must_use]
pub fn from_best_start(data: &FitData<'_>, start: &AxisModel, scope: &Scope) -> Fitted {
    let fit = |start: &AxisModel| least_squares::fit(data, start, scope, least_squares::STEPS);
    let mut best = fit(start);
    for other in start.other_starts(scope) {
        let other = fit(&other);
        let [kept, new] = [&best, &other].map(|fitted| log_rms(data, &fitted.residuals, scope));
        if new < kept - MIN_GAIN_OF_START {
            best = other;
        }
    }
    best
}

/// A log in which the axis's channels are those of the model in its closed loop.
fn simulated(data: &FitData<'_>, model: &AxisModel, log: usize) -> Option<Signals> {
    let parameters = model.parameters();
    let measured = &data.logs[log];
    let signals = &measured.axes[data.axis];
    let motor = signals.motor.as_ref()?;
    let simulated = data.closed_loop(model, &parameters, signals)?;
    let sample_s = measured.sample_s;
    let smooth = |values: Vec<f64>, like: &Smooth| like.of_other(values, sample_s);

    let zero_m = 1e-6 * model.table_zero_um;
    let table_m = delayed_cubic(simulated.table_m, parameters.latency_s(Channel::Table), sample_s);
    let late = parameters.latency_s(Channel::Force) / sample_s;
    let force_n = delayed_linear(&simulated.force_n, late);
    let axis = AxisSignals {
        motor: Some(smooth(simulated.motor_m, motor)),
        table: signals.table.as_ref().map(|like| smooth(table_m.iter().map(|m| m + zero_m).collect(), like)),
        force: signals.force.as_ref().map(|like| smooth(force_n, like)),
        ..signals.clone()
    };
    let mut result = measured.clone();
    result.axes[data.axis] = axis.with_motor_noise(motor.noise, sample_s, &data.options.samples);
    Some(result)
}

/// Whether the second of two residuals of a scope is smaller than the first.
#[must_use]
pub fn is_less(data: &FitData<'_>, residuals: [&[ResidualSeries]; 2], scope: &Scope) -> bool {
    let [before, after] = residuals.map(|residuals| log_rms(data, residuals, scope));
    after < before
}

/// Sum over a scope's stages of the logarithm of their residual's rms.
#[must_use]
pub fn log_rms(data: &FitData<'_>, residuals: &[ResidualSeries], scope: &Scope) -> f64 {
    scope.stages.iter().map(|&stage| libm::log(data.rms(residuals, stage).max(1e-12))).sum()
}
