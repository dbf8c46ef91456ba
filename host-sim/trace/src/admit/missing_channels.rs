//! Channels that some logs have and others lack.
//!
//! A stage is evaluated on the logs that have its channels. The tool is predicted from the tables of its own and of the other
//! axes: a log that lacks one of them, where other logs have it, says nothing of the tool.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use files::error::InputError;
use files::log::{AxisLog, Channel, Log};
use model::machine::Machine;

/// Removes the tool from logs without the position that drives its prediction on the fit logs. Returns a note for each.
pub fn remove_undriven_tools([fit, validate]: [&mut Vec<Cow<'_, Log>>; 2]) -> Vec<String> {
    let [of_fit, of_validate] = [&*fit, &*validate].map(|logs| undriven(logs, fit));
    let mut notes = Vec::new();
    for (logs, undriven) in [(fit, of_fit), (validate, of_validate)] {
        for Undriven { log, axis, lacking } in undriven {
            let log = logs[log].to_mut();
            let (source, axis) = (log.source.clone(), &mut log.axes[axis]);
            axis.tool = None;
            notes.push(format!(
                "{source}: {} tool is not used, as there is no {lacking} to predict it from.",
                axis.name
            ));
        }
    }
    notes
}

/// Removes the temperature of an axis that another log, fitted or held out, lacks: a model with it would describe some logs and not
/// the others. Returns a note for each axis.
pub fn remove_partial_temperatures([fit, validate]: [&mut Vec<Cow<'_, Log>>; 2]) -> Vec<String> {
    let logs = || fit.iter().chain(&*validate);
    let lacking: BTreeMap<String, String> = logs()
        .flat_map(|log| log.axes.iter().map(move |axis| (axis, log)))
        .filter(|(axis, _)| axis.temperature.is_none())
        .map(|(axis, log)| (axis.name.clone(), log.source.clone()))
        .collect();
    let mut notes = BTreeSet::new();
    for log in fit.iter_mut().chain(&mut *validate) {
        let is_partial = |axis: &AxisLog| axis.temperature.is_some() && lacking.contains_key(&axis.name);
        if !log.axes.iter().any(is_partial) {
            continue;
        }
        for axis in log.to_mut().axes.iter_mut().filter(|axis| is_partial(axis)) {
            axis.temperature = None;
            let source = &lacking[&axis.name];
            notes.insert(format!("{} temperature is not used, as {source} has none.", axis.name));
        }
    }
    notes.into_iter().collect()
}

/// A tool that cannot be predicted like that of the fit logs.
struct Undriven {
    /// Index of the log.
    log: usize,
    /// Index of its axis.
    axis: usize,
    /// What is missing.
    lacking: String,
}

fn undriven(logs: &[Cow<'_, Log>], fit: &[Cow<'_, Log>]) -> Vec<Undriven> {
    let mut all = Vec::new();
    for (index, log) in logs.iter().enumerate() {
        for (axis, of_axis) in log.axes.iter().enumerate().filter(|(_, axis)| axis.tool.is_some()) {
            if let Some(lacking) = lacking_upstream(log, of_axis, fit) {
                all.push(Undriven { log: index, axis, lacking });
            }
        }
    }
    all
}

/// The position that a log lacks, where a fit log has it beside the tool of this axis.
fn lacking_upstream(log: &Log, axis: &AxisLog, fit: &[Cow<'_, Log>]) -> Option<String> {
    let has_tool = |other: &&Cow<'_, Log>| other.axis(&axis.name).is_some_and(|axis| axis.tool.is_some());
    let with_tool = || fit.iter().filter(has_tool);
    let has_table = |other: &Cow<'_, Log>| other.axis(&axis.name).is_some_and(|axis| axis.table.is_some());
    if axis.table.is_none() && with_tool().any(has_table) {
        return Some(format!("{} table", axis.name));
    }
    let has_position = |axis: &AxisLog| axis.table.is_some() || axis.motor.is_some();
    let is_lacking =
        |other: &&AxisLog| has_position(other) && !log.axis(&other.name).is_some_and(has_position);
    let lacking = with_tool().flat_map(|other| &other.axes).find(is_lacking)?;
    Some(format!("{} table or motor", lacking.name))
}

/// Notes on channels of some fit logs that another fit log or a validation log lacks.
///
/// # Errors
/// For a validation log without any channel in common with the fit logs.
pub fn notes(
    machine: &Machine,
    fit: &[Cow<'_, Log>],
    validate: &[Cow<'_, Log>],
) -> Result<Vec<String>, InputError> {
    let has =
        |log: &Log, name: &str, channel| log.axis(name).is_some_and(|axis| axis.channel(channel).is_some());
    let fitted: Vec<(&str, Channel)> = machine
        .axis
        .keys()
        .flat_map(|name| Channel::ALL.map(|channel| (name.as_str(), channel)))
        .filter(|(_, channel)| *channel != Channel::AddedForce)
        .filter(|(name, channel)| fit.iter().any(|log| has(log, name, *channel)))
        .collect();
    let missing = |log: &Log| -> Vec<String> {
        let missing = fitted.iter().filter(|(name, channel)| !has(log, name, *channel));
        missing.map(|(name, channel)| format!("{name} {}", channel.word())).collect()
    };
    let mut notes = Vec::new();
    for log in fit {
        let missing = missing(log);
        if !missing.is_empty() {
            notes.push(format!(
                "{}: has no {}, for which the other fit logs are used.",
                log.source,
                missing.join(", ")
            ));
        }
    }
    for log in validate {
        let missing = missing(log);
        if missing.len() == fitted.len() && !fitted.is_empty() {
            let what = "at least one channel of the fit logs";
            return Err(InputError::expected(&log.source, what, "none"));
        }
        if !missing.is_empty() {
            notes.push(format!("{}: has no {}, and judges nothing of it.", log.source, missing.join(", ")));
        }
    }
    Ok(notes)
}
