//! Checks that a log belongs to the machine and contains usable motion.

use std::borrow::Cow;

use crate::options::{AdmissionOptions, TraceOptions};
use files::error::InputError;
use files::log::{AxisLog, Channel, Log, Unit};
use model::machine::{Axis, Machine};

/// Largest travel of an axis in any position channel of a log, mm or degrees.
fn travel(log: &Log, axis: &str) -> f64 {
    let Some(axis) = log.axis(axis) else { return 0.0 };
    let channels = [&axis.command, &axis.motor, &axis.table].into_iter().flatten();
    numerics::max(channels.map(|values| numerics::peak_to_peak(values.iter().copied()))).max(0.0)
}

/// Whether an axis does not move in any log.
#[must_use]
pub fn is_at_rest(logs: &[Cow<'_, Log>], axis: &str, options: &AdmissionOptions) -> bool {
    logs.iter().all(|log| travel(log, axis) < options.min_travel_mm)
}

/// Checks that a log belongs to the machine and contains usable motion.
///
/// # Errors
/// For an axis that the machine lacks, an axis with a gain schedule, which the equations of a trace do not have, too little or too much
/// travel, a sensor reading that does not change, or too few samples.
pub fn check(machine: &Machine, log: &Log, options: &AdmissionOptions) -> Result<(), InputError> {
    let refuse = |what: String, found: String| Err(InputError::expected(&log.source, what, found));
    for axis in &log.axes {
        if !machine.axis.contains_key(&axis.name) {
            let names: Vec<&str> = machine.axis.keys().map(String::as_str).collect();
            return refuse(
                format!("axes of the machine file ({})", names.join(", ")),
                format!("axis {}", axis.name),
            );
        }
    }
    let lacks_temperature = |axis: &&AxisLog| {
        let declared = machine.axis.get(&axis.name).into_iter().flat_map(|axis| &axis.effect);
        axis.temperature.is_none() && declared.into_iter().any(|effect| effect.kind().reads_temperature)
    };
    if let Some(axis) = log.axes.iter().find(lacks_temperature) {
        return refuse(
            format!(
                "the column {}, on which the friction of the machine file depends",
                axis.column(Channel::Temperature)
            ),
            "none".to_owned(),
        );
    }
    let is_scheduled = |axis: &Axis| axis.settings.schedule.ratio.is_some();
    if let Some((name, _)) = machine.axis.iter().find(|(_, axis)| is_scheduled(axis)) {
        return refuse(
            "a log of a machine whose velocity gains are constant".to_owned(),
            format!("axis.{name}.gain_schedule_ratio in the machine file"),
        );
    }
    let [min, max] = [options.min_travel_mm, options.max_travel_mm];
    let farthest = numerics::max_abs(log.axes.iter().map(|axis| travel(log, &axis.name)));
    if !(min..=max).contains(&farthest) {
        return refuse(
            format!("motion over {min} to {max} mm (or deg) on some axis"),
            format!("{farthest:.6}"),
        );
    }
    for axis in &log.axes {
        let of = |channel: Channel| {
            axis.channel(channel).map(|values| numerics::peak_to_peak(values.iter().copied()))
        };
        let [command, motor, table] = [Channel::Command, Channel::Motor, Channel::Table].map(of);
        for (name, sensor, other) in [("motor", motor, table.or(command)), ("table", table, motor)] {
            let (Some(sensor), Some(other)) = (sensor, other) else { continue };
            if other > options.max_travel_beside_stuck_mm && sensor < min {
                return refuse(
                    format!(
                        "a {name} reading of {} that changes while the axis moves over {other:.3} mm (or deg)",
                        axis.name
                    ),
                    "a constant reading".to_owned(),
                );
            }
        }
    }
    if log.len() < options.min_samples {
        return refuse(format!("at least {} samples", options.min_samples), log.len().to_string());
    }
    Ok(())
}

/// Checks that more of a log is left than the settling time at its start, which is not evaluated.
///
/// # Errors
/// For a log that is shorter.
pub fn is_longer_than_settling(log: &Log, options: &TraceOptions) -> Result<(), InputError> {
    let duration_s = log.len() as f64 * log.sample_time_s;
    let settling_s = options.samples.settling_s;
    if duration_s > settling_s {
        return Ok(());
    }
    let what = format!("a log longer than the {settling_s} s at its start that are not evaluated");
    Err(InputError::expected(&log.source, what, format!("{duration_s:.3} s")))
}

/// Checks that each axis has the same unit in all logs.
///
/// # Errors
/// For an axis that is linear in one log and rotary in another.
pub fn same_units(fit: &[Cow<'_, Log>], validate: &[Cow<'_, Log>]) -> Result<(), InputError> {
    let logs: Vec<&Log> = fit.iter().chain(validate).map(AsRef::as_ref).collect();
    for (i, log) in logs.iter().enumerate() {
        for axis in &log.axes {
            let differs = |other: &&&Log| other.axis(&axis.name).is_some_and(|first| first.unit != axis.unit);
            if let Some(other) = logs[..i].iter().find(differs) {
                let unit = |unit: Unit| unit.suffix(Channel::Motor);
                let first_unit = other.axis(&axis.name).map_or("", |first| unit(first.unit));
                let what = format!("axis {} in {first_unit}, as in {}", axis.name, other.source);
                return Err(InputError::expected(&log.source, what, unit(axis.unit)));
            }
        }
    }
    Ok(())
}
