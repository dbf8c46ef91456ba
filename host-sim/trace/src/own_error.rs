//! What tracing itself leaves of a machine that is the model to the last bit.
//!
//! The driven mechanics are given a filtered motor, which turns round less sharply than the machine's, and take steps that
//! damp: after a jerk or a reversal a few hundredths of a micrometre stay that no effect has made. The fitted model,
//! run in its own loop behind the same command, gives logs of such a machine; traced like the measured ones, what stays
//! of them is that error. It hangs on the last digits of the model so little that it is taken once for
//! each effect that is found.

use super::axis_model::AxisModel;
use super::follow::delayed;
use super::predict::aged;
use super::residual::{Evidence, Part, rms};
use super::scope::Scope;
use super::signals::{AxisSignals, Signals, Smooth};
use model::effects::{Channel, Stage};

/// The error in a scope of driven stages, of all logs; none where the scope is another or a loop does not run.
#[must_use]
pub fn of(evidence: &Evidence<'_>, model: &AxisModel, scope: &Scope) -> Vec<Part> {
    if !scope.stages.iter().all(|stage| matches!(stage, Stage::Table | Stage::Force)) {
        return Vec::new();
    }
    let logs: Vec<Signals> =
        (0..evidence.logs.len()).map_while(|log| as_the_model_has_it(evidence, model, log)).collect();
    if logs.len() < evidence.logs.len() {
        return Vec::new();
    }
    Evidence { logs: &logs, own: &[], aside: &[], ..*evidence }.residuals(model, scope)
}

/// The error of a model that was fitted without it by an earlier trace, if the logs are explained better so: its values
/// stand for nothing where it is not taken out. None for a model that was declared.
#[must_use]
pub fn known(evidence: &Evidence<'_>, model: &AxisModel, scope: &Scope) -> Vec<Part> {
    if !model.was_fitted() {
        return Vec::new();
    }
    let own = of(evidence, model, scope);
    let with = evidence.residuals(model, scope);
    let without = Evidence { own: &own, ..*evidence }.residuals(model, scope);
    if is_less(evidence, [&with, &without], scope) { own } else { Vec::new() }
}

/// A log with the channels of an axis as the model in its loop gives them.
fn as_the_model_has_it(evidence: &Evidence<'_>, model: &AxisModel, log: usize) -> Option<Signals> {
    let parameters = model.parameters();
    let measured = &evidence.logs[log];
    let signals = &measured.axes[evidence.axis];
    let motor = signals.motor.as_ref()?;
    let simulated = evidence.in_loop(model, &parameters, signals)?;
    let sample_s = measured.sample_s;
    let smooth = |values: Vec<f64>, like: &Smooth| Smooth::new(values, sample_s, like.reach());

    let zero_m = 1e-6 * model.table_zero_um;
    let table_m = delayed(simulated.table_m, parameters.latency_s(Channel::Table), sample_s);
    let late = parameters.latency_s(Channel::Force) / sample_s;
    let force_n = aged(&simulated.force_n, late);
    let axis = AxisSignals {
        motor: Some(smooth(simulated.motor_m, motor)),
        table: signals.table.as_ref().map(|like| smooth(table_m.iter().map(|m| m + zero_m).collect(), like)),
        force: signals.force.as_ref().map(|like| smooth(force_n, like)),
        ..signals.clone()
    };
    let mut like_measured = measured.clone();
    like_measured.axes[evidence.axis] = axis.with_path(motor.noise, sample_s);
    Some(like_measured)
}

/// Whether the second of two residuals of a scope is less than the first.
#[must_use]
pub fn is_less(evidence: &Evidence<'_>, residuals: [&[Part]; 2], scope: &Scope) -> bool {
    let [before, after] = residuals.map(|parts| size(evidence, parts, scope));
    after < before
}

/// Sum of the logarithms of the residuals of a scope's stages.
#[must_use]
pub fn size(evidence: &Evidence<'_>, parts: &[Part], scope: &Scope) -> f64 {
    scope.stages.iter().map(|&stage| rms(parts, stage, evidence).max(1e-12).ln()).sum()
}
