//! Examination of logs: the faults of each in the order in which they are corrected.

use std::borrow::Cow;

use rayon::prelude::*;

use super::fault::{DataFault, FaultHandling};
use super::findings::{ChannelLocation, Findings};
use super::{
    agreement, dead, exchanged, hum, rate, repeated_rows, shifted, sign, slip, stuck, stuck_force, unit,
};
use crate::options::TraceOptions;
use files::error::InputError;
use files::log::{Channel, Log};
use model::machine::Machine;

use super::excluded::Excluded;

/// Logs whose faults are corrected.
#[derive(Clone, Debug, Default)]
pub struct Examined<'a> {
    /// Fit logs and validation logs. Logs without a fault are those that were given.
    pub logs: [Vec<Cow<'a, Log>>; 2],
    /// The faults.
    pub faults: Vec<DataFault>,
    /// Samples that are excluded.
    pub excluded: Vec<Excluded>,
}

impl<'a> Examined<'a> {
    /// Adds fit logs (set 0) or validation logs (set 1) with what was found in them.
    fn add(&mut self, set: usize, results: Vec<(Cow<'a, Log>, Findings)>) {
        for (log, findings) in results {
            self.logs[set].push(log);
            self.faults.extend(findings.faults);
            self.excluded.extend(findings.excluded);
        }
    }
}

/// Finds and interpolates lost rows, in logs at their own rate: thinned to that of the machine, a repeated row no longer equals the
/// one before it.
#[must_use]
pub fn interpolate_lost_rows<'a>(
    machine: &Machine,
    logs: [&'a [Log]; 2],
    options: &TraceOptions,
) -> Examined<'a> {
    let machine_sample_s = 1.0 / machine.sample_rate_hz;
    let of_log = |log: &'a Log| {
        let mut log = Cow::Borrowed(log);
        let mut findings = Findings::default();
        // A log whose rows are all repeated is left out or refused by `examine`.
        if rate::repeated(&log).is_none() {
            let margins = margins(&log, machine_sample_s, options);
            repeated_rows::correct(&mut log, margins, &mut findings);
        }
        (log, findings)
    };
    let mut examined = Examined::default();
    for (set, logs) in logs.into_iter().enumerate() {
        let results: Vec<(Cow<'a, Log>, Findings)> = logs.par_iter().map(of_log).collect();
        examined.add(set, results);
    }
    examined
}

/// Number of neighbours of a short and of a long gap that are excluded with it.
fn margins(log: &Log, machine_sample_s: f64, options: &TraceOptions) -> [usize; 2] {
    // The filter, and a second difference of its output.
    let margin_s = options.samples.smoothing_s + machine_sample_s;
    [margin_s, options.samples.settling_s].map(|seconds| samples(log, seconds))
}

/// Excludes the samples of logs at the rate of the machine for which their file had no row.
pub fn exclude_interpolated(machine: &Machine, examined: &mut Examined<'_>, options: &TraceOptions) {
    for log in examined.logs.iter_mut().flatten() {
        let margins = margins(log, 1.0 / machine.sample_rate_hz, options);
        let mut findings = Findings::default();
        repeated_rows::exclude_interpolated(log, margins, &mut findings);
        examined.excluded.extend(findings.excluded);
    }
}

/// Examines logs at the rate of the machine, whose lost rows are interpolated.
///
/// # Errors
/// If the rows of all fit logs are repeated.
pub fn examine<'a>(
    machine: &Machine,
    interpolated: Examined<'a>,
    options: &TraceOptions,
) -> Result<Examined<'a>, InputError> {
    let Examined { logs, faults, excluded } = interpolated;
    let mut examined = Examined { logs: Default::default(), faults, excluded };
    let of_log = |mut log: Cow<'a, Log>| {
        let findings = of_log(machine, &mut log, options);
        (log, findings)
    };
    for (set, logs) in logs.into_iter().enumerate() {
        let sampled = without_repeated_rows(logs, &mut examined.faults, set == 0)?;
        let mut results: Vec<(Cow<'a, Log>, Findings)> = sampled.into_par_iter().map(of_log).collect();
        if set == 0 {
            leave_out(&mut results, &mut examined.faults);
        }
        examined.add(set, results);
    }
    examined.faults.extend(hum::correct_all(&mut examined.logs));
    Ok(examined)
}

/// The logs whose rows are not repeated; the others are reported, or refused if no fit log would be left.
fn without_repeated_rows<'a>(
    logs: Vec<Cow<'a, Log>>,
    faults: &mut Vec<DataFault>,
    is_fit: bool,
) -> Result<Vec<Cow<'a, Log>>, InputError> {
    let (broken, sound): (Vec<_>, Vec<_>) =
        logs.into_iter().map(|log| (rate::repeated(&log), log)).partition(|(every, _)| every.is_some());
    for (every, log) in broken {
        let every = every.unwrap_or(1);
        if is_fit && sound.is_empty() {
            return Err(rate::error(&log, every));
        }
        faults.extend(rate::faults(&log, every));
    }
    Ok(sound.into_iter().map(|(_, log)| log).collect())
}

/// Leaves out each fit log with a removed channel if the logs without one are at least as long: a stage can be fitted only if
/// all logs have its channels.
fn leave_out(results: &mut Vec<(Cow<'_, Log>, Findings)>, faults: &mut Vec<DataFault>) {
    let has_removed =
        |findings: &Findings| findings.faults.iter().any(|f| f.treatment == FaultHandling::Removed);
    let sound = results.iter().filter(|(_, findings)| !has_removed(findings)).map(|(log, _)| log.len());
    let sound: usize = sound.sum();
    results.retain_mut(|(log, findings)| {
        let stays = !has_removed(findings) || log.len() > sound;
        if !stays {
            let left_out = |fault: DataFault| DataFault { treatment: FaultHandling::LogLeftOut, ..fault };
            faults.extend(findings.faults.drain(..).map(left_out));
        }
        stays
    });
}

/// Number of samples of a log in a time, s.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
fn samples(log: &Log, seconds: f64) -> usize {
    (seconds / log.sample_time_s).round() as usize
}

/// Finds and corrects the faults of a log.
fn of_log(machine: &Machine, log: &mut Cow<'_, Log>, options: &TraceOptions) -> Findings {
    let mut findings = Findings::default();
    let faults = &options.faults;
    // The filter, and a second difference of its output.
    let margin = samples(log, options.samples.smoothing_s) + 1;
    dead::remove(log, options, &mut findings);
    exchanged::correct(log, faults, &mut findings);
    for axis in 0..log.axes.len() {
        for (channel, factor) in agreement::disagreeing(&log.axes[axis], log.sample_time_s, faults) {
            let correct = |values: &mut [f64], place: &ChannelLocation<'_>, findings: &mut Findings| {
                if sign::is_reversed(channel, factor, faults) {
                    sign::correct(values, place, findings);
                    return true;
                }
                unit::correct(values, factor, place, findings)
            };
            change(log, (axis, channel), &mut findings, correct);
        }
    }
    unit::correct_forces(machine, log, options, &mut findings);
    shifted::correct(log, margin, faults, &mut findings);
    for axis in 0..log.axes.len() {
        for channel in [Channel::Motor, Channel::Table, Channel::Tool, Channel::Command] {
            change(log, (axis, channel), &mut findings, |values, place, findings| {
                let is_usable = stuck::correct(values, place, margin, faults, findings);
                if is_usable {
                    slip::correct(values, place, margin, faults, findings);
                }
                is_usable
            });
        }
        change(log, (axis, Channel::Force), &mut findings, |values, place, findings| {
            stuck_force::correct(values, place, margin, faults, findings);
            true
        });
    }
    findings
}

/// Applies a correction to a channel of a log, which is copied only if a fault is found. The correction returns whether the
/// channel can be used; otherwise it is removed.
fn change(
    log: &mut Cow<'_, Log>,
    (axis, channel): (usize, Channel),
    findings: &mut Findings,
    correct: impl Fn(&mut [f64], &ChannelLocation<'_>, &mut Findings) -> bool,
) {
    let Some(mut values) = log.axes[axis].channel(channel).map(<[f64]>::to_vec) else { return };
    let count = findings.faults.len();
    let is_usable = correct(&mut values, &ChannelLocation { log, axis, channel }, findings);
    if findings.faults.len() > count {
        *log.to_mut().axes[axis].channel_mut(channel) = is_usable.then_some(values);
    }
}
