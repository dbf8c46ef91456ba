//! From a log to the effect that its machine has and its model lacks.
//!
//! [`admission`] says which logs can be used; [`signals`] prepares them; [`predict`] drives the declared model with measured signals;
//! [`residual`] is what it leaves; [`fit`] moves the declared values within their tolerance;
//! [`candidates`] tries the catalogue, [`held_out`] says what is worth adding; [`axis`] is the search
//! for one axis, [`last_fit`] fits all that was found,
//! [`limits`], [`refute`] and [`settle`] take back what is no measurement or does not hold on other logs;
//! [`unexplained`] is what stays, [`verdict`] what all of it comes to, [`repeatability`] how much of it could be explained at all, [`untested`]
//! what was not looked for, [`free_run`] what the model is worth without feedback; [`json`] is the whole for programs.

pub mod added;
pub mod admission;
pub mod axis;
pub mod axis_model;
pub mod candidates;
pub mod copies;
pub mod empirical;
pub mod fit;
pub mod follow;
pub mod free_run;
pub mod held_out;
pub mod in_loop;
pub mod intervals;
pub mod json;
pub mod last_fit;
pub mod last_tick;
pub mod limits;
pub mod look_alike;
pub mod motor_path;
pub mod own_error;
pub mod predict;
pub mod refute;
pub mod repeatability;
pub mod residual;
pub mod rotary;
pub mod scope;
pub mod search;
pub mod set_aside;
pub mod settle;
pub mod signals;
pub mod trim;
pub mod unexplained;
pub mod untested;
pub mod verdict;
pub mod wound;

/// The names that a trace may answer with.
pub use model::effects::NAMES as EFFECT_NAMES;
/// What a trace is given as declared.
pub use model::machine::Machine;

use std::borrow::Cow;

use rayon::prelude::*;

use admission::Admitted;
use axis::AxisTrace;
use files::error::InputError;
use files::log::Log;
use model::servo;
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
    /// What the user has to know of the logs: what was left out, thinned or lacking.
    pub notes: Vec<String>,
}

impl Trace {
    /// The machine with fitted values and with the effects found.
    #[must_use]
    pub fn better_machine(&self) -> Machine {
        // What the bodies do to an axis is among its effects now: both would do it twice.
        let mut machine = Machine { structure: None, ..self.machine.clone() };
        for trace in &self.axes {
            if let Some(axis) = machine.axis.get_mut(&trace.axis) {
                *axis = trace.model.written();
            }
        }
        machine
    }

    /// Finds for effects that the logs cannot tell apart the motions that would.
    fn propose(&mut self) {
        let better = self.better_machine();
        let logs = &self.fit_logs;
        for (number, axis) in self.axes.iter_mut().enumerate() {
            for alike in &mut axis.look_alikes {
                let mut other = better.clone();
                if let Some(of_axis) = other.axis.get_mut(&axis.axis) {
                    *of_axis = alike.with_rival.axis.clone();
                }
                alike.proposal = look_alike::propose([&better, &other], number, logs);
            }
        }
    }

    /// What an axis was explained from, or validated on.
    #[must_use]
    pub fn evidence<'a>(&'a self, logs: &'a [Signals], axis: usize) -> Evidence<'a> {
        Evidence { logs, names: &self.names, axis, rates: servo::rates(&self.machine), aside: &[], own: &[] }
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
    let Admitted { fit, validate, mut notes } = admission::admit(machine, fit, validate)?;
    let names: Vec<String> = machine.axis.keys().cloned().collect();
    let prepared =
        |logs: &[Cow<'_, Log>]| logs.par_iter().map(|log| Signals::new(log, &names)).collect::<Vec<_>>();
    let (mut fit_logs, mut validate_logs) = if validate.is_empty() {
        let (first, last): (Vec<_>, Vec<_>) =
            fit.iter().map(|log| split(log)).map(|(a, b)| (Cow::Owned(a), Cow::Owned(b))).unzip();
        (prepared(&first), prepared(&last))
    } else {
        (prepared(&fit), prepared(&validate))
    };
    let first = fit.first().map(|log| log.source.as_str());
    admission::mark(machine, &mut fit_logs, first);
    admission::mark(machine, &mut validate_logs, first);
    for name in names.iter().filter(|name| admission::stands(&fit, name)) {
        if fit.iter().any(|log| log.axis(name).is_some()) {
            notes.push(format!("{name}: did not move; only what other axes do to it can be seen."));
        }
    }
    let mut trace =
        Trace { axes: Vec::new(), fit_logs, validate_logs, names, machine: machine.clone(), notes };
    let of_axis = |(i, axis): (usize, &model::machine::Axis)| {
        let evidence = trace.evidence(&trace.fit_logs, i);
        axis::trace(axis, &evidence, &trace.evidence(&trace.validate_logs, i), say)
    };
    let axes: Vec<&model::machine::Axis> = machine.axis.values().collect();
    trace.axes = axes.into_par_iter().enumerate().map(of_axis).collect();
    trace.propose();
    Ok(trace)
}

/// A log in front of the held-out part, and the held-out part.
fn split(log: &Log) -> (Log, Log) {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of the length")]
    let cut = ((1.0 - HELD_OUT) * log.len() as f64).round() as usize;
    (log.slice(0..cut), log.slice(cut..log.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::{AxisLog, Unit};

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
