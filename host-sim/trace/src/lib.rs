//! Identification of effects that a machine shows in its logs and that its declared model lacks.
//!
//! A trace is a pipeline of values. Each step is a folder with an entry, which takes a value and returns the next one:
//!
//! | step | takes | returns | does |
//! |---|---|---|---|
//! | [`mod@admit`] | [`Logs`] | [`Admitted`](admit::Admitted) | interpolates lost rows, thins logs to the rate of the machine |
//! | [`mod@repair`] | [`Admitted`](admit::Admitted) | [`Repaired`](repair::Repaired) | reports and corrects faults of the data, refuses logs that cannot be traced, filters signals |
//! | [`mod@fit`] | [`AxisData`](fit::axis_data::AxisData) | [`Baseline`](fit::Baseline) | fits the declared values within their tolerance |
//! | [`mod@search`] | [`Baseline`](fit::Baseline) | [`SearchedAxis`] | adds effects of the catalogue that the fit logs support |
//! | [`fit_together`] | [`SearchedAxis`] | [`Hypotheses`](search::Hypotheses) | fits everything, beside the models found of the other axes |
//! | [`mod@judge`] | [`Hypotheses`](search::Hypotheses) | [`Findings`](judge::Findings) | drops effects at a limit and effects that the validation logs refute, analyses the remaining residual |
//! | [`mod@result`] | [`Findings`](judge::Findings) | [`Identification`] | states the evidence against the effects, proposes motions that distinguish rivals |
//!
//! `fit`, `search` and the first part of `judge` see the logs of one axis; all axes are traced at the same time. After the search, each axis is fitted
//! beside the models found of the others.
//!
//! Modules used by several steps are beside them: signals ([`input`]), [`prediction`] of each stage by a model, from the measured signal
//! upstream of the stage, [`data_faults`], [`analysis`] of residuals, the removal of effects from a model ([`dropped`]),
//! thresholds ([`options`]).

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod admit;
pub mod analysis;
pub mod data_faults;
pub mod dropped;
pub mod fit;
pub mod input;
pub mod judge;
pub mod options;
pub mod prediction;
pub mod repair;
pub mod result;
pub mod search;
pub mod stages;
pub mod task;

/// Names of the effects that a trace may find.
pub use model::effects::names as effect_names;
/// The declared machine.
pub use model::machine::Machine;
pub use options::TraceOptions;
pub use result::{AxisIdentification, Identification, certainty, json, verdict};
pub use task::{Logs, Progress, Request, Task};

use admit::admit;
use files::error::InputError;
use files::log::Log;
use fit::fit;
use judge::{judge, judge_together};
use repair::repair;
use result::identify;
use search::{SearchedAxis, fit_together, search};
use task::Job;

/// Traces a machine with the default thresholds. Without validation logs the last quarter of each log is held out.
///
/// `progress` is called with a message for each step, from several threads.
///
/// # Errors
/// If a log does not match the machine file (rate, axes), or cannot be traced.
pub fn trace(
    machine: &Machine,
    fit: &[Log],
    validate: &[Log],
    progress: &Progress<'_>,
) -> Result<Identification, InputError> {
    trace_with(&TraceOptions::default(), machine, [fit, validate], progress)
}

/// Evaluates a machine file on logs without searching for effects, see [`Task::Evaluate`].
///
/// # Errors
/// As [`trace`].
pub fn evaluate(
    machine: &Machine,
    fit: &[Log],
    validate: &[Log],
    progress: &Progress<'_>,
) -> Result<Identification, InputError> {
    requested(machine, [fit, validate], Request { task: Task::Evaluate, tables: false }, progress)
}

/// Does what is requested, with the default thresholds, fit logs and validation logs.
///
/// # Errors
/// As [`trace`].
pub fn requested(
    machine: &Machine,
    logs: Logs<'_>,
    request: Request,
    progress: &Progress<'_>,
) -> Result<Identification, InputError> {
    run(&Job { machine, options: &TraceOptions::default(), request, progress }, logs)
}

/// Traces a machine with the given thresholds, fit logs and validation logs.
///
/// # Errors
/// As [`trace`].
pub fn trace_with(
    options: &TraceOptions,
    machine: &Machine,
    logs: Logs<'_>,
    progress: &Progress<'_>,
) -> Result<Identification, InputError> {
    run(&Job { machine, options, request: Request::default(), progress }, logs)
}

fn run(job: &Job<'_>, logs: Logs<'_>) -> Result<Identification, InputError> {
    let machine = &job.machine.clone().named_as_logs(logs.into_iter().flatten());
    let job = &Job { machine, ..*job };
    let admitted = admit(job, logs)?;
    let repaired = repair(job, admitted)?;
    let of_axes = repaired.map_axes(
        |axis| search(job, axis, fit(job, axis)),
        SearchedAxis::model,
        |axis, searched| judge(job, axis, fit_together(job, axis, searched)),
    );
    let findings = judge_together(job, &repaired, of_axes);
    Ok(identify(repaired, findings))
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::{AxisLog, Unit};
    use model::effects::Stage;

    fn machine(effect: &str) -> Machine {
        let text = format!(
            "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ntable_mass_kg = 100.0\ncoulomb_n = 20.0\n\
             viscous_n_s_per_m = 100.0\nplant_tolerance_percent = 10.0\n{effect}"
        );
        Machine::parse(&text, "m.toml").unwrap()
    }

    /// 3 s of a rigid axis that oscillates over `travel_mm` under the force of its model.
    fn log(travel_mm: f64) -> Log {
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        let omega = 4.0;
        let phase = |i: u32| omega * 1e-3 * f64::from(i);
        axis.motor = Some((0..3000).map(|i| 0.5 * travel_mm * phase(i).sin()).collect());
        let force = |i: u32| {
            let amplitude_m = 0.5e-3 * travel_mm;
            let velocity = amplitude_m * omega * phase(i).cos();
            20.0 * velocity.signum() + 100.0 * velocity - 100.0 * amplitude_m * omega * omega * phase(i).sin()
        };
        axis.force = Some((0..3000).map(force).collect());
        Log::new("log.csv", 0.0, 1e-3, [axis])
    }

    #[test]
    fn a_log_without_motion_is_refused() {
        let error = trace(&machine(""), &[log(0.0)], &[], &|_| {}).unwrap_err();
        assert!(error.to_string().starts_with("log.csv: expected motion over 0.01"), "{error}");
    }

    #[test]
    fn the_same_log_twice_is_refused() {
        let error = trace(&machine(""), &[log(100.0), log(100.0)], &[], &|_| {}).unwrap_err();
        assert!(error.to_string().contains("a different recording"), "{error}");
    }

    /// Without masses neither the loop nor the force can be simulated, whatever effects are declared.
    #[test]
    fn an_axis_without_masses_is_traced_with_a_declared_friction() {
        let text = "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ncontroller = \"p\"\nposition_gain_per_s = 40.0\n\
                    velocity_gain_n_s_per_m = 2e4\n[[axis.x.effect]]\nname = \"stribeck\"\nstatic_excess_n = 1.0\n\
                    velocity_mm_s = 1.0\n[axis.x.nominal]\n";
        let machine = Machine::parse(text, "m.toml").unwrap();
        let mut log = log(100.0);
        log.axes[0].command = log.axes[0].motor.clone();
        log.axes[0].table = log.axes[0].motor.clone();
        let trace = trace(&machine, &[log], &[], &|_| {}).unwrap();
        assert!(
            trace.axes()[0].residuals.iter().all(|error| error.stage != Stage::Force),
            "{:?}",
            trace.axes()[0].residuals
        );
    }

    #[test]
    fn a_declared_effect_may_be_outside_its_search_range() {
        let effect = "[[axis.x.effect]]\nname = \"stribeck\"\nstatic_excess_n = 1.0\nvelocity_mm_s = 0.01\n";
        let trace = trace(&machine(effect), &[log(100.0)], &[], &|_| {}).unwrap();
        assert!(trace.axes()[0].found.is_empty(), "{:?}", trace.axes()[0].found);
    }
}
