//! Dead: the reading is constant while the axis moves.

use std::borrow::Cow;

use super::channels::{SENSORS, references};
use super::fault::{FaultHandling, FaultKind};
use super::findings::{ChannelLocation, Findings};
use super::ratio::ratio;
use crate::options::TraceOptions;
use files::log::{AxisLog, Channel, Log};

fn travel(values: &[f64]) -> f64 {
    numerics::peak_to_peak(values.iter().copied())
}

/// Whether a channel is constant while a sensor, or the command of an axis with one other sensor, travels far. A constant
/// command is not a fault: an axis may be moved by hand.
fn is_dead(axis: &AxisLog, channel: Channel, sample_s: f64, options: &TraceOptions) -> bool {
    let Some(values) = axis.channel(channel) else { return false };
    let limits = &options.admission;
    if channel == Channel::Force {
        let moves = |sensor| {
            axis.channel(sensor).is_some_and(|v: &[f64]| travel(v) > limits.max_travel_beside_stuck_mm)
        };
        // Acceleration and friction change the force of any motion that reverses or stops.
        return travel(values) == 0.0 && SENSORS.into_iter().any(moves);
    }
    if travel(values) >= limits.min_travel_mm {
        return false;
    }
    // A reading in m of which little is left follows the others nevertheless.
    let follows = |other: &[f64]| {
        ratio(values, other, sample_s).is_some_and(|ratio| {
            ratio.factor.abs() > f64::MIN_POSITIVE && ratio.spread < options.faults.max_factor_spread
        })
    };
    references(axis, channel)
        .any(|(_, other)| travel(other) > limits.max_travel_beside_stuck_mm && !follows(other))
}

/// Whether a stage of an axis can be evaluated with the channels that are left.
fn is_testable(has: impl Fn(Channel) -> bool) -> bool {
    let (motor, table) = (has(Channel::Motor), has(Channel::Table));
    let driven = motor && (table || has(Channel::Command) || has(Channel::Force));
    driven || (motor || table) && has(Channel::Tool)
}

/// Reports the dead channels of a log and removes them. If nothing of any axis could be evaluated then, they are kept, and
/// the log is refused on admission.
pub fn remove(log: &mut Cow<'_, Log>, options: &TraceOptions, findings: &mut Findings) {
    let mut dead = Vec::new();
    for (axis, channels) in log.axes.iter().enumerate() {
        let of_axis = SENSORS.into_iter().chain([Channel::Force]);
        dead.extend(
            of_axis
                .filter(|&c| is_dead(channels, c, log.sample_time_s, options))
                .map(|channel| (axis, channel)),
        );
    }
    let testable = log.axes.iter().enumerate().any(|(index, axis)| {
        is_testable(|channel| axis.channel(channel).is_some() && !dead.contains(&(index, channel)))
    });
    if !testable {
        return;
    }
    for &(axis, channel) in &dead {
        let place = ChannelLocation { log, axis, channel };
        findings.faults.push(place.fault(FaultKind::Dead, None, FaultHandling::Removed));
        *log.to_mut().axes[axis].channel_mut(channel) = None;
    }
}
