//! Exchanged: a channel of one axis is in the column of another axis and the reverse.

use std::borrow::Cow;

use super::channels::{POSITIONS, thinned};
use super::difference::deviation;
use super::fault::{FaultHandling, FaultKind};
use super::findings::{ChannelLocation, Findings};
use crate::options::FaultOptions;
use files::log::{Channel, Log};

/// Reduction of the smallest ratio for the command, whose difference from a sensor contains the following error.
const COMMAND_FACTOR: f64 = 0.15;

fn difference(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (thinned(a), thinned(b));
    deviation(&a.iter().zip(&*b).map(|(a, b)| a - b).collect::<Vec<f64>>())
}

/// Whether the channel of each of two axes is that of the other, by all their other position channels.
fn is_exchanged(log: &Log, [a, b]: [usize; 2], channel: Channel, options: &FaultOptions) -> bool {
    let of = |axis: usize, channel: Channel| log.axes[axis].channel(channel);
    let (Some(own_a), Some(own_b)) = (of(a, channel), of(b, channel)) else { return false };
    if log.axes[a].unit != log.axes[b].unit {
        return false;
    }
    let mut others = POSITIONS
        .into_iter()
        .filter(|other| *other != channel)
        .filter_map(|other| Some((other, of(a, other)?, of(b, other)?)))
        .peekable();
    others.peek().is_some()
        && others.all(|(other, of_a, of_b)| {
            // Difference of the motions of both axes: without one, nothing shows that they are exchanged.
            let separate = difference(of_a, of_b);
            let own = difference(own_a, of_a).min(difference(own_b, of_b));
            let crossed = difference(own_a, of_b).max(difference(own_b, of_a));
            let has_lag = [channel, other].contains(&Channel::Command);
            let ratio = options.min_exchanged_ratio * if has_lag { COMMAND_FACTOR } else { 1.0 };
            own > 0.5 * separate && own > ratio * crossed
        })
}

/// Reports channels that are exchanged between two axes, and exchanges them back. Of two channels that both could be the
/// exchanged one, it is the one farther from the command.
pub fn correct(log: &mut Cow<'_, Log>, options: &FaultOptions, findings: &mut Findings) {
    for a in 0..log.axes.len() {
        for b in a + 1..log.axes.len() {
            for channel in POSITIONS.into_iter().rev() {
                if !is_exchanged(log, [a, b], channel, options) {
                    continue;
                }
                for axis in [a, b] {
                    let place = ChannelLocation { log, axis, channel };
                    findings.faults.push(place.fault(FaultKind::Exchanged, None, FaultHandling::Corrected));
                }
                let axes = &mut log.to_mut().axes;
                let of_a = axes[a].channel_mut(channel).take();
                let of_b = axes[b].channel_mut(channel).take();
                *axes[a].channel_mut(channel) = of_b;
                *axes[b].channel_mut(channel) = of_a;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::{AxisLog, Unit};

    /// Two axes on a circle, or on a diagonal line.
    fn log(phase: f64) -> Log {
        let axis = |name: &str, phase: f64, sensors: &[Channel]| {
            let mut axis = AxisLog::new(name, Unit::Millimetre);
            for (number, &channel) in sensors.iter().enumerate() {
                let at = |i: u32| 30.0 * (3e-3 * f64::from(i) + phase).sin() + 0.01 * number as f64;
                *axis.channel_mut(channel) = Some((0..5000).map(at).collect());
            }
            axis
        };
        let axes = vec![axis("x", 0.0, &POSITIONS), axis("y", phase, &POSITIONS)];
        Log::new("l", 0.0, 1e-3, axes)
    }

    fn exchange(log: &mut Log, channel: Channel) {
        let [x, y] = &mut log.axes[..] else { panic!("two axes") };
        std::mem::swap(x.channel_mut(channel), y.channel_mut(channel));
    }

    #[test]
    fn exchanged_channels_are_exchanged_back() {
        for channel in POSITIONS {
            let whole = log(1.5);
            let mut broken: Cow<'_, Log> = Cow::Owned(whole.clone());
            exchange(broken.to_mut(), channel);
            let mut findings = Findings::default();
            correct(&mut broken, &FaultOptions::default(), &mut findings);
            let found: Vec<_> =
                findings.faults.iter().map(|f| (f.axis.as_str(), f.channel.unwrap(), f.kind)).collect();
            assert_eq!(found, [("x", channel, FaultKind::Exchanged), ("y", channel, FaultKind::Exchanged)]);
            assert_eq!(*broken, whole);
        }
    }

    #[test]
    fn whole_logs_and_axes_that_move_alike_are_left_as_they_are() {
        for (phase, exchanged) in [(1.5, false), (0.0, true)] {
            let mut log: Cow<'_, Log> = Cow::Owned(log(phase));
            if exchanged {
                exchange(log.to_mut(), Channel::Table);
            }
            let mut findings = Findings::default();
            correct(&mut log, &FaultOptions::default(), &mut findings);
            assert!(findings.faults.is_empty());
        }
    }
}
