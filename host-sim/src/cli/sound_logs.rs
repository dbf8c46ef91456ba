//! Logs whose positions are compared, without the faults of their data: a channel that is not that of its axis is refused, spikes
//! are left out. The faults are those that a trace finds.

use contour::logged::{POSITIONS, has};
use files::error::InputError;
use files::format::significant;
use files::log::{Channel, Log};
use model::machine::Machine;
use trace::data_faults::{DataFault, FaultKind, examine, interpolate_lost_rows};
use trace::options::TraceOptions;

/// Logs before or after a change, and a sentence for each fault of their data.
pub struct SoundLogs {
    /// The logs, without spikes.
    pub logs: Vec<Log>,
    /// The sentences.
    pub remarks: Vec<String>,
}

impl SoundLogs {
    /// Examines the logs of a machine.
    ///
    /// # Errors
    /// The axis and the fault of a command, or of the measured position nearest to the tool, that is not that of its axis.
    pub fn of(logs: Vec<Log>, machine: &Machine) -> Result<Self, InputError> {
        let mut sound = Self { logs: Vec::with_capacity(logs.len()), remarks: Vec::new() };
        for log in logs {
            let (log, remarks) = without_faults(log, machine)?;
            sound.logs.push(log);
            sound.remarks.extend(remarks);
        }
        Ok(sound)
    }
}

fn without_faults(mut log: Log, machine: &Machine) -> Result<(Log, Vec<String>), InputError> {
    let Some(measured) = POSITIONS.into_iter().find(|channel| has(&log, *channel)) else {
        return Ok((log, Vec::new()));
    };
    // As a log of the validation: that of a fit is refused if its rows are repeated, before its fault is named.
    let options = TraceOptions::default();
    let interpolated = interpolate_lost_rows(machine, [&[], std::slice::from_ref(&log)], &options);
    let examined = examine(machine, interpolated, &options)?;
    let concerns = |fault: &&DataFault| fault.channel.is_none_or(|c| c == measured || c == Channel::Command);
    let faults: Vec<&DataFault> = examined.faults.iter().filter(concerns).collect();
    if let Some(fault) = faults.iter().find(|fault| is_wrong_channel(fault.kind)) {
        let expected = "commands and measured positions that belong to their axes";
        return Err(InputError::expected(&log.source, expected, place(fault) + ": " + fault.kind.name()));
    }
    let spikes = faults.iter().filter(|fault| fault.kind == FaultKind::Spike);
    let mended: Vec<(String, Channel, Option<Vec<f64>>)> = spikes
        .filter_map(|fault| {
            let channel = fault.channel?;
            let values = examined.logs[1].first()?.axis(&fault.axis)?.channel(channel)?.to_vec();
            Some((fault.axis.clone(), channel, Some(values)))
        })
        .collect();
    let remarks = faults.iter().map(|fault| sentence(&log, fault)).collect();
    for (name, channel, values) in mended {
        if let Some(axis) = log.axes.iter_mut().find(|axis| axis.name == name) {
            *axis.channel_mut(channel) = values;
        }
    }
    Ok((log, remarks))
}

/// Whether a fault makes all readings of a channel those of something else. A late channel is not: the model can have its latency.
const fn is_wrong_channel(kind: FaultKind) -> bool {
    match kind {
        FaultKind::Exchanged | FaultKind::Sign | FaultKind::Unit | FaultKind::Rate | FaultKind::Dead => true,
        FaultKind::Slip | FaultKind::Stuck | FaultKind::Spike | FaultKind::Shifted | FaultKind::Hum => false,
    }
}

/// Axis and channel of a fault.
fn place(fault: &DataFault) -> String {
    let channel = fault.channel.map_or("all channels", Channel::word);
    format!("{} {channel}", fault.axis)
}

fn sentence(log: &Log, fault: &DataFault) -> String {
    let at = fault.at_s.map_or(String::new(), |s| format!(" at {s:.3} s"));
    let size = fault.size.map_or(String::new(), |size| significant(size, 3));
    let (what, done) = match fault.kind {
        FaultKind::Spike => {
            let number =
                if fault.count == 1 { "a spike".to_owned() } else { format!("{} spikes", fault.count) };
            (format!("{number} of up to {size} µm{at}"), "left out")
        }
        FaultKind::Slip => (format!("a slip of {size} µm{at}"), "part of the error"),
        FaultKind::Stuck => (format!("readings that are repeated for {size} s{at}"), "part of the error"),
        kind => (format!("{}{at}", kind.name()), "part of the error"),
    };
    format!("{}: {}: {what}, {done}.", log.source, place(fault))
}
