//! From a log to the effect that its machine has and its model lacks.
//!
//! [`signals`] prepares the logs; [`predict`] drives the declared model with measured signals;
//! [`residual`] is what it leaves; [`fit`] moves the declared values within their tolerance;
//! [`candidates`] tries the catalogue, [`held_out`] says what is worth adding; [`axis`] is the search
//! for one axis, [`unexplained`] what stays, [`repeatability`] how much of it could be explained at all,
//! [`free_run`] what the model is worth without feedback; [`report`] is the whole for people and programs.

pub mod axis;
pub mod candidates;
pub mod fit;
pub mod free_run;
pub mod held_out;
pub mod model;
pub mod predict;
pub mod repeatability;
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
        // What the bodies do to an axis is among its effects now: both would do it twice.
        let mut machine = Machine { structure: None, ..self.machine.clone() };
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
    for (i, log) in fit.iter().enumerate() {
        if let Some(twin) = fit[..i].iter().find(|other| other.axes == log.axes) {
            // Counted twice, its chances would look like evidence.
            return Err(InputError::expected(
                &log.source,
                "a log of its own",
                format!("the data of {}", twin.source),
            ));
        }
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
    // Less is presliding and noise, more a slip of the unit.
    const LEAST_TRAVEL_MM: f64 = 0.01;
    const MOST_TRAVEL_MM: f64 = 1e6;
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
    let travels =
        log.axes.iter().flat_map(|axis| [&axis.command, &axis.motor, &axis.table]).flatten().map(|places| {
            let least = places.iter().copied().fold(f64::INFINITY, f64::min);
            places.iter().copied().fold(f64::NEG_INFINITY, f64::max) - least
        });
    let travel = travels.fold(0.0, f64::max);
    if !(LEAST_TRAVEL_MM..=MOST_TRAVEL_MM).contains(&travel) {
        return refuse(
            format!("motion over {LEAST_TRAVEL_MM} to {MOST_TRAVEL_MM} mm (or deg) on some axis"),
            format!("{travel}"),
        );
    }
    if log.len() < LEAST_SAMPLES {
        return refuse(format!("at least {LEAST_SAMPLES} samples"), log.len().to_string());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{AxisLog, Unit};

    fn machine(effect: &str) -> Machine {
        let text = format!(
            "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ntable_mass_kg = 100.0\ncoulomb_n = 20.0\n\
             viscous_n_s_per_m = 100.0\nplant_tolerance_percent = 10.0\n{effect}"
        );
        Machine::parse(&text, "m.toml").unwrap()
    }

    /// 3 s of a rigid axis that swings over `travel_mm` under the force that its model says.
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
    fn a_log_in_which_nothing_moves_tells_nothing() {
        let error = trace(&machine(""), &[log(0.0)], &[], &|_| {}).unwrap_err();
        assert!(error.to_string().starts_with("log.csv: expected motion over 0.01"), "{error}");
    }

    #[test]
    fn the_same_log_twice_is_no_evidence() {
        let error = trace(&machine(""), &[log(100.0), log(100.0)], &[], &|_| {}).unwrap_err();
        assert!(error.to_string().contains("a log of its own"), "{error}");
    }

    #[test]
    fn a_declared_effect_may_lie_where_no_fit_would_go() {
        let effect = "[[axis.x.effect]]\nname = \"stribeck\"\nstatic_excess_n = 1.0\nvelocity_mm_s = 0.01\n";
        let trace = trace(&machine(effect), &[log(100.0)], &[], &|_| {}).unwrap();
        assert!(trace.axes[0].found.is_empty(), "{:?}", trace.axes[0].found);
    }
}
