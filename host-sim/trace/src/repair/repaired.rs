//! Logs without the faults that can be corrected, and their signals.

use std::borrow::Cow;

use rayon::prelude::*;

use super::preparation::Preparation;
use crate::admit::admitted::Admitted;
use crate::admit::checks;
use crate::admit::usable::usable;
use crate::data_faults::examine::{Examined, examine};
use crate::data_faults::excluded::Excluded;
use crate::data_faults::fault::DataFault;
use crate::data_faults::late_command::{self, Late};
use crate::fit::axis_data::AxisData;
use crate::fit::axis_model::AxisModel;
use crate::fit::declared_machine::DeclaredMachine;
use crate::fit::held_effects;
use crate::input::parts::Parts;
use crate::input::signals::Signals;
use crate::task::Job;
use files::error::InputError;
use files::log::Log;

/// Logs without the faults that can be corrected, and the signals in which effects are searched for.
#[derive(Clone, Debug)]
pub struct Repaired<'a> {
    /// The declared machine.
    pub declared: DeclaredMachine,
    /// Fit logs and validation logs (none if the fit logs are split).
    pub logs: [Vec<Cow<'a, Log>>; 2],
    /// Signals of what is fitted and of what is held out; of long logs, in the stretches that are searched.
    pub signals: [Vec<Signals>; 2],
    /// The faults, corrected or not.
    pub faults: Vec<DataFault>,
    /// Sentences on logs that were shortened or thinned, and on missing or excluded data.
    pub notes: Vec<String>,
    excluded: Vec<Excluded>,
    late: Vec<Late>,
}

impl Repaired<'_> {
    /// The parts of the logs that are fitted and held out.
    #[must_use]
    pub fn parts(&self) -> Parts<'_> {
        let [fit, validate] = &self.logs;
        Parts::of([fit, validate], &self.declared.options.admission)
    }

    /// Two steps of each axis, the second of which sees the models after the first step of all axes. Of long logs, one axis follows the
    /// other, as memory would grow with their number.
    pub fn map_axes<T: Send, U: Send>(
        &self,
        first: impl Fn(&AxisData<'_>) -> T + Sync + Send,
        model: impl Fn(&T) -> &AxisModel,
        second: impl Fn(&AxisData<'_>, T) -> U + Sync + Send,
    ) -> Vec<U> {
        let [fit, validate] = &self.signals;
        let declared_axes = self.declared.machine.axis.values().enumerate();
        let axes: Vec<AxisData<'_>> = declared_axes
            .map(|(index, declared)| {
                let [fit, validate] = [fit, validate].map(|logs| self.declared.data(logs, index));
                AxisData { declared, fit, validate }
            })
            .collect();
        let samples: usize = fit.iter().map(Signals::len).sum();
        let at_once = samples * axes.len() <= self.declared.options.admission.max_samples_at_once;
        let results = mapped(axes.iter().collect(), at_once, &first);
        let models: Vec<AxisModel> = results.iter().map(|result| model(result).clone()).collect();
        let pairs = axes.iter().zip(results).collect();
        mapped(pairs, at_once, |(axis, result): (&AxisData<'_>, T)| second(&axis.beside(&models), result))
    }

    /// Preparation of further signals of the logs, and the commands that are late in them.
    #[must_use]
    pub fn preparation(&self) -> (Preparation<'_>, &[Late]) {
        (preparation(&self.declared, &self.logs, &self.excluded), &self.late)
    }
}

/// The results for all items, which are computed at the same time or one after the other.
fn mapped<A: Send, B: Send>(items: Vec<A>, at_once: bool, of: impl Fn(A) -> B + Sync + Send) -> Vec<B> {
    if at_once { items.into_par_iter().map(of).collect() } else { items.into_iter().map(of).collect() }
}

/// Corrects the faults of admitted logs, refuses logs that cannot be traced, and prepares the signals of the others.
///
/// # Errors
/// If a log does not match the machine file or the other logs, or contains no usable motion.
pub fn repair<'a>(job: &Job<'_>, admitted: Admitted<'a>) -> Result<Repaired<'a>, InputError> {
    let Admitted { examined, notes } = admitted;
    let corrected = Admitted { examined: examine(job.machine, examined, job.options)?, notes };
    let Admitted { examined, mut notes } = usable(job.machine, corrected, &job.options.admission)?;
    let Examined { logs, mut faults, excluded } = examined;
    for log in logs.iter().flatten() {
        checks::is_longer_than_settling(log, job.options)?;
    }
    notes.extend(notes_on_axes(job, &logs[0]));
    let declared = DeclaredMachine::new(job.machine, job.options);
    let admission = &job.options.admission;
    let parts = Parts::of([&logs[0], &logs[1]], admission);
    let preparation = preparation(&declared, &logs, &excluded);
    let signals = [0, 1].map(|set| {
        let searched = parts.searched(set, admission);
        searched.par_iter().map(|piece| preparation.signals(piece)).collect::<Vec<Signals>>()
    });
    if parts.are_long {
        notes.extend(parts.note(admission));
    }
    let late_command::Shifted { signals, faults: late_commands, late } =
        late_command::shifted_back(&declared, signals);
    faults.extend(late_commands);
    Ok(Repaired { declared, logs, signals, faults, notes, excluded, late })
}

fn preparation<'a>(
    declared: &'a DeclaredMachine,
    logs: &'a [Vec<Cow<'_, Log>>; 2],
    excluded: &'a [Excluded],
) -> Preparation<'a> {
    Preparation {
        machine: &declared.machine,
        names: &declared.names,
        first: logs[0].first().map(|log| log.source.as_str()),
        excluded,
        options: &declared.options,
    }
}

/// Sentences on axes that do not move in the fit logs, and on declared effects that are not fitted.
fn notes_on_axes(job: &Job<'_>, fit: &[Cow<'_, Log>]) -> Vec<String> {
    let is_logged = |name: &str| fit.iter().any(|log| log.axis(name).is_some());
    let rests = |name: &&String| checks::is_at_rest(fit, name, &job.options.admission) && is_logged(name);
    let at_rest = job.machine.axis.keys().filter(rests);
    let at_rest =
        at_rest.map(|name| format!("{name}: did not move; only what other axes do to it can be seen."));
    let held = job.machine.axis.iter().flat_map(|(name, axis)| held_effects::notes(name, &axis.effect));
    at_rest.chain(held).collect()
}
