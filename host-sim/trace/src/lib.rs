//! Identification of effects that a machine shows in its logs and that its declared model lacks.
//!
//! The steps of a trace:
//!
//! 1. [`data_faults`]: faults of the data are named, and corrected where that is possible.
//! 2. [`input`] and [`prepare`]: admission of logs, filtering of their signals.
//! 3. [`prediction`]: prediction of each stage by a model, from the measured signal upstream of the stage.
//! 4. [`fit`]: residuals, and fit of the declared values within their tolerance.
//! 5. [`search`]: addition of effects of the catalogue that held-out data support.
//! 6. [`validation`]: removal of effects at a limit, and of effects that the validation logs refute.
//! 7. [`analysis`]: analysis of the remaining residuals; [`alignment`]: names of the machine that the measuring chain imitates.
//! 8. [`mod@whole`]: of long logs, in stretches of which steps 2 to 7 search: fit and residuals of all samples.
//! 9. [`verdict`]: agreement of model and logs; [`json`]: the result as JSON.
//!
//! [`axis_trace`] executes these steps for one axis. [`outcome`] contains their results, [`options`] the thresholds, and
//! [`not_testable`] the effects that were not searched for.

pub mod alignment;
pub mod analysis;
pub mod axis_trace;
pub mod certainty;
pub mod data_faults;
mod displaced_head;
pub mod fit;
pub mod input;
pub mod json;
pub mod not_testable;
pub mod options;
pub mod outcome;
pub mod prediction;
pub mod prepare;
pub mod search;
pub mod stages;
pub mod task;
pub mod validation;
pub mod verdict;
pub mod whole;

/// Names of the effects that a trace may find.
pub use model::effects::names as effect_names;
/// The declared machine.
pub use model::machine::Machine;
pub use options::TraceOptions;
pub use outcome::Trace;
pub use task::{Request, Task};

use rayon::prelude::*;

use certainty::state_doubts;
use data_faults::Examined;
use files::error::InputError;
use files::log::Log;
use fit::axis_model::AxisModel;
use fit::held_effects;
use fit::scope_fit::Progress;
use input::admission::{self, Admitted};
use input::checks;
use input::parts::Parts;
use input::signals::Signals;
use prepare::Preparation;
use whole::WholeLogs;
use whole::refinement::refine;

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
) -> Result<Trace, InputError> {
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
) -> Result<Trace, InputError> {
    requested(machine, [fit, validate], Request { task: Task::Evaluate, tables: false }, progress)
}

/// Does what is requested, with the default thresholds, fit logs and validation logs.
///
/// # Errors
/// As [`trace`].
pub fn requested(
    machine: &Machine,
    logs: [&[Log]; 2],
    request: Request,
    progress: &Progress<'_>,
) -> Result<Trace, InputError> {
    run(&TraceOptions::default(), machine, logs, request, progress)
}

/// Traces a machine with the given thresholds, fit logs and validation logs.
///
/// # Errors
/// As [`trace`].
pub fn trace_with(
    options: &TraceOptions,
    machine: &Machine,
    logs: [&[Log]; 2],
    progress: &Progress<'_>,
) -> Result<Trace, InputError> {
    run(options, machine, logs, Request::default(), progress)
}

fn run(
    options: &TraceOptions,
    machine: &Machine,
    logs: [&[Log]; 2],
    request: Request,
    progress: &Progress<'_>,
) -> Result<Trace, InputError> {
    let Examined { logs, faults, excluded } = data_faults::interpolate_lost_rows(machine, logs, options);
    let Admitted { fit, validate, notes } = admission::at_machine_rate(machine, logs, &options.admission)?;
    let interpolated = Examined { logs: [fit, validate], faults, excluded };
    let Examined { logs: [fit, validate], mut faults, excluded } =
        data_faults::examine(machine, interpolated, options)?;
    let Admitted { fit, validate, mut notes } =
        admission::admit(machine, Admitted { fit, validate, notes }, &options.admission)?;
    for log in fit.iter().chain(&validate) {
        checks::is_longer_than_settling(log, options)?;
    }
    let names: Vec<String> = machine.axis.keys().cloned().collect();
    for name in names.iter().filter(|name| checks::is_at_rest(&fit, name, &options.admission)) {
        if fit.iter().any(|log| log.axis(name).is_some()) {
            notes.push(format!("{name}: did not move; only what other axes do to it can be seen."));
        }
    }
    for (name, axis) in &machine.axis {
        notes.extend(held_effects::notes(name, &axis.effect));
    }
    let first = fit.first().map(|log| log.source.clone());
    let parts = Parts::of([&fit, &validate], &options.admission);
    let preparation =
        Preparation { machine, names: &names, first: first.as_deref(), excluded: &excluded, options };
    let [fit_logs, validate_logs] = [0, 1].map(|set| {
        let searched = parts.searched(set, &options.admission);
        searched.par_iter().map(|piece| preparation.signals(piece)).collect::<Vec<Signals>>()
    });
    if parts.are_long {
        notes.extend(parts.note(&options.admission));
    }
    let model = |axis| AxisModel::new(axis, machine.rates(), options.model);
    let declared_axes = machine.axis.values().map(model).collect();
    let mut trace = Trace {
        axes: Vec::new(),
        fit_logs,
        validate_logs,
        names: names.clone(),
        machine: machine.clone(),
        declared_axes,
        options: *options,
        notes,
    };
    let (late_commands, late) = trace.correct_late_commands();
    faults.extend(late_commands);
    trace.trace_axes(request, progress);
    if parts.are_long {
        refine(&mut trace, &WholeLogs { parts: &parts, preparation, late }, progress);
    }
    alignment::decide(&mut trace);
    trace.assign(faults);
    state_doubts(&mut trace);
    trace.propose_motions();
    Ok(trace)
}

impl Trace {
    /// Traces all axes, at the same time unless their logs are long: memory would grow with their number.
    fn trace_axes(&mut self, request: Request, progress: &Progress<'_>) {
        let of_axis = |(i, axis): (usize, &model::machine::Axis)| {
            let [fit_data, validate] = [&self.fit_logs, &self.validate_logs].map(|logs| self.data(logs, i));
            axis_trace::trace(axis, [&fit_data, &validate], request, progress)
        };
        let axes: Vec<&model::machine::Axis> = self.machine.axis.values().collect();
        let samples: usize = self.fit_logs.iter().map(Signals::len).sum();
        self.axes = if samples * axes.len() <= self.options.admission.max_samples_at_once {
            axes.into_par_iter().enumerate().map(of_axis).collect()
        } else {
            axes.into_iter().enumerate().map(of_axis).collect()
        };
    }
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
        Log { source: "log.csv".to_owned(), start_s: 0.0, sample_time_s: 1e-3, axes: vec![axis] }
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
            trace.axes[0].residuals.iter().all(|error| error.stage != Stage::Force),
            "{:?}",
            trace.axes[0].residuals
        );
    }

    #[test]
    fn a_declared_effect_may_be_outside_its_search_range() {
        let effect = "[[axis.x.effect]]\nname = \"stribeck\"\nstatic_excess_n = 1.0\nvelocity_mm_s = 0.01\n";
        let trace = trace(&machine(effect), &[log(100.0)], &[], &|_| {}).unwrap();
        assert!(trace.axes[0].found.is_empty(), "{:?}", trace.axes[0].found);
    }
}
