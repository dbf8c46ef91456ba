//! From a log to the effect that its machine has and its model lacks.
//!
//! [`signals`] prepares the logs; [`predict`] drives the declared model with measured signals;
//! [`residual`] is what it leaves; [`fit`] moves the declared values within their tolerance;
//! [`candidates`] tries the catalogue, [`held_out`] says what is worth adding; [`axis`] is the search
//! for one axis, [`unexplained`] what stays; [`report`] is the whole for people and programs.

pub mod axis;
pub mod candidates;
pub mod fit;
pub mod held_out;
pub mod model;
pub mod predict;
pub mod report;
pub mod residual;
pub mod scope;
pub mod signals;
pub mod unexplained;

use rayon::prelude::*;

use crate::error::InputError;
use crate::log::Log;
use crate::machine::Machine;
use crate::servo;
use axis::AxisTrace;
use residual::Evidence;
use signals::Signals;

/// Share of a log that is held out where no validation log is given.
const HELD_OUT: f64 = 0.25;

/// Everything that tracing found.
#[derive(Clone, Debug)]
pub struct Trace {
    /// One an axis, in the order of the machine file.
    pub axes: Vec<AxisTrace>,
    /// The logs that were fitted.
    pub fit_logs: Vec<Signals>,
    /// The logs that were not.
    pub validate_logs: Vec<Signals>,
    /// Names of the axes.
    pub names: Vec<String>,
    /// The declared machine.
    pub machine: Machine,
}

impl Trace {
    /// The machine with fitted values and with the effects found.
    #[must_use]
    pub fn better_machine(&self) -> Machine {
        let mut machine = self.machine.clone();
        for trace in &self.axes {
            if let Some(axis) = machine.axis.get_mut(&trace.axis) {
                *axis = trace.model.axis.clone();
            }
        }
        machine
    }

    /// What an axis was explained from, or validated on.
    #[must_use]
    pub fn evidence<'a>(&'a self, logs: &'a [Signals], axis: usize) -> Evidence<'a> {
        Evidence { logs, names: &self.names, axis, rates: servo::rates(&self.machine) }
    }
}

/// Traces a machine. Without validation logs the last quarter of each log is held out.
///
/// `say` is told what is being tried, from several threads.
///
/// # Errors
/// When a log does not fit the machine file: its rate, its axes.
pub fn trace(
    machine: &Machine,
    fit: &[Log],
    validate: &[Log],
    say: &(dyn Fn(&str) + Sync),
) -> Result<Trace, InputError> {
    for log in fit.iter().chain(validate) {
        check(machine, log)?;
    }
    let names: Vec<String> = machine.axis.keys().cloned().collect();
    let prepared = |logs: &[Log]| logs.par_iter().map(|log| Signals::new(log, &names)).collect::<Vec<_>>();
    let (fit_logs, validate_logs) = if validate.is_empty() {
        let (first, last): (Vec<Log>, Vec<Log>) = fit.iter().map(split).unzip();
        (prepared(&first), prepared(&last))
    } else {
        (prepared(fit), prepared(validate))
    };
    let mut trace = Trace { axes: Vec::new(), fit_logs, validate_logs, names, machine: machine.clone() };
    let of_axis = |(i, axis): (usize, &crate::machine::Axis)| {
        let evidence = trace.evidence(&trace.fit_logs, i);
        axis::trace(axis, &evidence, &trace.evidence(&trace.validate_logs, i), say)
    };
    let axes: Vec<&crate::machine::Axis> = machine.axis.values().collect();
    trace.axes = axes.into_par_iter().enumerate().map(of_axis).collect();
    Ok(trace)
}

/// A log in front of the held-out part, and the held-out part.
fn split(log: &Log) -> (Log, Log) {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of the length")]
    let cut = ((1.0 - HELD_OUT) * log.len() as f64).round() as usize;
    (log.slice(0..cut), log.slice(cut..log.len()))
}

/// Refuses a log that is not of this machine, or that nothing can be learned from.
fn check(machine: &Machine, log: &Log) -> Result<(), InputError> {
    const LEAST_SAMPLES: usize = 200;
    let refuse = |what: String, found: String| Err(InputError::expected(&log.source, what, found));
    let rate = 1.0 / log.sample_time_s;
    // Printed times round: a per mille is far beyond that and far below any other rate.
    if (rate / machine.sample_rate_hz - 1.0).abs() > 1e-3 {
        return refuse(
            format!("samples at the machine's sample_rate_hz of {}", machine.sample_rate_hz),
            format!("{rate:.6} Hz"),
        );
    }
    for axis in &log.axes {
        if !machine.axis.contains_key(&axis.name) {
            let names: Vec<&str> = machine.axis.keys().map(String::as_str).collect();
            return refuse(
                format!("axes of the machine file ({})", names.join(", ")),
                format!("axis {}", axis.name),
            );
        }
    }
    if log.len() < LEAST_SAMPLES {
        return refuse(format!("at least {LEAST_SAMPLES} samples"), log.len().to_string());
    }
    Ok(())
}
