//! Detection of logs that contain the same recording.
//!
//! A log must not validate a fit to itself, nor be counted twice. A copy may lack rows or a channel, or start at another time;
//! its measured values are the same.

use std::collections::HashSet;

use crate::options::AdmissionOptions;
use files::error::InputError;
use files::log::{AxisLog, Channel, Log};

/// Measured channels. The command is excluded, as it is the same in any two runs of one motion.
const MEASURED: [Channel; 4] = [Channel::Motor, Channel::Table, Channel::Tool, Channel::Force];

/// Refuses a log that is a copy of an earlier one.
///
/// # Errors
/// For the first such log; the error names the original.
pub fn refuse<'a>(logs: impl Iterator<Item = &'a Log>, options: &AdmissionOptions) -> Result<(), InputError> {
    let mut known: Vec<&Log> = Vec::new();
    for log in logs {
        for other in &known {
            if let Some(fraction) = shared(other, log, options) {
                // Rounded down, so that 100 % means all rows.
                let percent = (100.0 * fraction).floor();
                let found =
                    format!("{percent:.0} % of the rows of the shorter log shared with {}", other.source);
                return Err(InputError::expected(&log.source, "a different recording", found));
            }
        }
        known.push(log);
    }
    Ok(())
}

/// Fraction of the shorter log's passages in motion that the other log also contains; `None` if it is too small for a copy.
#[must_use]
pub fn shared(a: &Log, b: &Log, options: &AdmissionOptions) -> Option<f64> {
    let (a, b) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    let [short, long] = common(a, b).map(|channels| passages(&channels, options.copied_rows));
    let fraction = short.intersection(&long).count() as f64 / short.len() as f64;
    (fraction > options.max_shared).then_some(fraction)
}

/// The measured channels that both logs have, in the same order.
fn common<'a>(a: &'a Log, b: &'a Log) -> [Vec<&'a [f64]>; 2] {
    let of = |axis: &'a AxisLog, channel| axis.channel(channel);
    let mut both = [Vec::new(), Vec::new()];
    for axis in &a.axes {
        let Some(other) = b.axis(&axis.name) else { continue };
        for channel in MEASURED {
            if let (Some(a), Some(b)) = (of(axis, channel), of(other, channel)) {
                both[0].push(a);
                both[1].push(b);
            }
        }
    }
    both
}

/// Hashes of all passages of `count` consecutive rows in which any channel changes.
fn passages(channels: &[&[f64]], count: usize) -> HashSet<u64> {
    let rows = channels.first().map_or(0, |channel| channel.len());
    // Adding zero converts −0 to +0.
    let row = |i: usize| channels.iter().fold(0, |hash, channel| hashed(hash, (channel[i] + 0.0).to_bits()));
    let rows: Vec<u64> = (0..rows).map(row).collect();
    let moves = |rows: &&[u64]| rows.iter().any(|row| *row != rows[0]);
    let of_rows = |rows: &[u64]| rows.iter().fold(0, |hash, row| hashed(hash, *row));
    rows.windows(count).filter(moves).map(of_rows).collect()
}

/// Combines a hash with a value by the finalizer of `SplitMix64`, in which a change of any bit changes about half of the
/// bits.
const fn hashed(hash: u64, value: u64) -> u64 {
    let mut z = hash.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ value;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::Unit;

    fn shared(a: &Log, b: &Log) -> Option<f64> {
        super::shared(a, b, &AdmissionOptions::default())
    }

    /// A log of 0.3 s at rest and 1.7 s of an oscillation, read by an encoder of this resolution, with a micrometre of noise
    /// that depends on `seed`.
    fn log(seed: f64, resolution_mm: f64) -> Log {
        let noise = |i: u32| 1e-3 * ((f64::from(i) * 12.9898 + seed).sin() * 43_758.545).fract();
        let time = |i: u32| 1e-3 * f64::from(i.saturating_sub(300));
        let mut x = AxisLog::new("x", Unit::Millimetre);
        x.command = Some((0..2000).map(|i| 5.0 * (6.0 * time(i)).sin()).collect());
        let read = |mm: f64| (mm / resolution_mm).round() * resolution_mm;
        x.motor = Some((0..2000).map(|i| read(5.0 * (6.0 * time(i)).sin() + noise(i))).collect());
        x.force = Some((0..2000).map(|i| 50.0 * (6.0 * time(i)).cos() + noise(i)).collect());
        Log::new("l.csv", 0.0, 1e-3, [x])
    }

    fn without(log: &Log, drops: impl Fn(usize) -> bool) -> Log {
        let mut less = log.clone();
        for axis in &mut less.axes {
            for channel in Channel::ALL {
                if let Some(samples) = axis.channel_mut(channel) {
                    let kept = samples.iter().enumerate().filter(|(i, _)| !drops(*i));
                    *samples = kept.map(|(_, value)| *value).collect();
                }
            }
        }
        less
    }

    #[test]
    fn a_log_with_rows_or_a_channel_removed_is_a_copy() {
        let whole = log(1.0, 1e-6);
        assert_eq!(shared(&whole, &whole), Some(1.0));
        let later = without(&whole, |i| i < 500);
        assert_eq!(shared(&whole, &later), Some(1.0));
        assert_eq!(shared(&later, &whole), Some(1.0));
        // One row in forty is removed: of 39 passages that begin between two gaps, 15 contain a gap.
        let holes = without(&whole, |i| i % 40 == 20);
        let fraction = shared(&whole, &holes).unwrap();
        assert!((fraction - 24.0 / 39.0).abs() < 0.01, "{fraction}");
        let mut fewer = whole.clone();
        fewer.axes[0].force = None;
        assert_eq!(shared(&whole, &fewer), Some(1.0));
    }

    #[test]
    fn the_same_motion_twice_is_not_a_copy() {
        assert_eq!(shared(&log(1.0, 1e-6), &log(2.0, 1e-6)), None);
        // With 1 µm of noise and a resolution of 5 µm, more than four of five rows agree, but not sixteen in sequence.
        let [mut a, mut b] = [1.0, 2.0].map(|seed| log(seed, 5e-3));
        (a.axes[0].force, b.axes[0].force) = (None, None);
        let [motor, again] = [&a, &b].map(|log| log.axes[0].motor.clone().unwrap());
        let equal = motor.iter().zip(&again).skip(300).filter(|(a, b)| a.to_bits() == b.to_bits()).count();
        assert!(equal > 1360, "{equal} of 1700 rows");
        assert_eq!(shared(&a, &b), None);
    }

    #[test]
    fn a_log_that_shares_less_than_half_is_not_a_copy() {
        let whole = log(1.0, 1e-6);
        // 1200 rows each, of which 400, all in motion, are common.
        let [first, last] = [without(&whole, |i| i >= 1200), without(&whole, |i| i < 800)];
        assert_eq!(shared(&first, &last), None);
        let [first, last] = [without(&whole, |i| i >= 1700), without(&whole, |i| i < 500)];
        assert!(shared(&first, &last).is_some());
    }
}
