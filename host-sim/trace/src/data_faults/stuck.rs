//! Stuck: the reading of a position is repeated while the axis moves.

use std::ops::Range;

use super::bridge::bridge;
use super::channels::{Accuracy, SENSORS, references};
use super::fault::{DataFault, FaultHandling, FaultKind};
use super::findings::{ChannelLocation, Findings};
use super::jumps;
use crate::options::FaultOptions;
use files::log::Channel;

/// Largest deviation of the jump after a repeated reading from the motion that was missed, as a fraction of it.
const MAX_CATCH_UP_ERROR: f64 = 0.35;

/// The ranges of samples whose value is that of the sample before the range.
fn repeated(values: &[f64]) -> Vec<Range<usize>> {
    let same = |sample: usize| values[sample].to_bits() == values[sample - 1].to_bits();
    let mut ranges = Vec::new();
    let mut sample = 1;
    while sample < values.len() {
        let start = sample;
        while sample < values.len() && same(sample) {
            sample += 1;
        }
        if sample > start {
            ranges.push(start..sample);
        }
        sample += 1;
    }
    ranges
}

/// Number of repetitions in a log from which they are regarded as frequent.
const FREQUENT: usize = 10;
/// Largest number of samples in a row whose neighbours are not excluded.
pub const MAX_INTERPOLATED: usize = 2;

/// Smallest number of readings for a travel that a spike does not affect.
const MIN_CONSTANT: usize = 20;

/// Travel within a stretch, spikes disregarded.
fn travel(values: &[f64]) -> f64 {
    numerics::quantile(values, 0.95) - numerics::quantile(values, 0.05)
}

/// Another position channel.
struct Other<'a> {
    values: &'a [f64],
    /// Smallest motion that counts.
    smallest: f64,
    /// Whether both this channel and the one that may be stuck are measured: a command may be constant while the axis is
    /// moved otherwise.
    are_sensors: bool,
}

impl Other<'_> {
    /// Whether this channel, another sensor, travels far while the reading is the same for a long time.
    fn travels_far(&self, range: &Range<usize>, options: &FaultOptions) -> bool {
        let far = (1e-3 * options.min_held_travel_um).max(self.smallest);
        let stretch = &self.values[range.start - 1..range.end];
        self.are_sensors && range.len() >= MIN_CONSTANT && travel(stretch) > far
    }

    /// Motion of this channel within a range, if the reading jumps afterwards by the motion that it has missed.
    ///
    /// A table within a backlash or a motor in a standstill repeats its reading as well, but does not jump by the missed
    /// motion afterwards.
    fn caught_up(&self, values: &[f64], range: &Range<usize>) -> Option<f64> {
        let (before, last) = (range.start - 1, range.end - 1);
        let [missed, jump] =
            [self.values.get(range.end)? - self.values[before], values.get(range.end)? - values[last]];
        let moved = (self.values[last] - self.values[before]).abs();
        // The other channel itself has no spike within the range.
        let moves = moved >= self.smallest && moved <= (1.0 + MAX_CATCH_UP_ERROR) * missed.abs();
        (moves && (jump - missed).abs() <= MAX_CATCH_UP_ERROR * missed.abs()).then_some(moved)
    }

    /// Whether this channel, another sensor whose reading is not repeated itself, shows that the axis stands while a third one moves. At the end of a
    /// backlash, the impact accelerates a table that stood: a reading which was the same by chance before it is followed by a jump.
    fn stands(&self, range: &Range<usize>, moved: f64) -> bool {
        let stretch = &self.values[range.start - 1..range.end];
        let [first, .., last] = stretch else { return false };
        let is_repeated = stretch.iter().all(|value| value.to_bits() == first.to_bits());
        self.are_sensors && !is_repeated && (last - first).abs() < 0.5 * moved
    }
}

/// Whether the readings of a range are stuck by the motion of other channels.
fn is_stuck(others: &[Other<'_>], values: &[f64], range: &Range<usize>, options: &FaultOptions) -> bool {
    let is_known_to_stand = |moved: f64| others.iter().any(|other| other.stands(range, moved));
    others.iter().any(|other| other.travels_far(range, options))
        || others
            .iter()
            .filter_map(|other| other.caught_up(values, range))
            .any(|moved| !is_known_to_stand(moved))
}

/// The stuck ranges of a channel. If it repeats readings often, smaller missed motions are regarded as well, as far as noise
/// and resolution show them.
fn find(values: &[f64], place: &ChannelLocation<'_>, options: &FaultOptions) -> Vec<Range<usize>> {
    let repeated = repeated(values);
    let stuck = |is_frequent: bool| -> Vec<Range<usize>> {
        let other = |(channel, other): (Channel, _)| Other {
            values: other,
            smallest: if is_frequent {
                visible(values, other)
            } else {
                jumps::smallest(values, Some(other), options)
            },
            are_sensors: [channel, place.channel].iter().all(|channel| SENSORS.contains(channel)),
        };
        let others: Vec<Other<'_>> = references(place.axis(), place.channel).map(other).collect();
        repeated.iter().filter(|range| is_stuck(&others, values, range, options)).cloned().collect()
    };
    let ranges = stuck(false);
    if ranges.len() < FREQUENT { ranges } else { stuck(true) }
}

/// Smallest motion of another channel that shows a repeated reading: six standard deviations of the noise, two steps.
fn visible(values: &[f64], other: &[f64]) -> f64 {
    let [own, other] = [values, other].map(Accuracy::of);
    (6.0 * own.noise.max(other.noise)).max(2.0 * own.resolution.max(other.resolution))
}

/// Finds and reports stuck readings, and replaces them by the motion of the nearest other channel. Returns whether the
/// channel can be used.
pub fn correct(
    values: &mut [f64],
    place: &ChannelLocation<'_>,
    margin: usize,
    options: &FaultOptions,
    findings: &mut Findings,
) -> bool {
    let ranges = find(values, place, options);
    if ranges.is_empty() {
        return true;
    }
    let sample_s = place.log.sample_time_s;
    let held: usize = ranges.iter().map(Range::len).sum();
    let is_usable = held as f64 <= options.max_held * values.len() as f64;
    let (long, short): (Vec<_>, Vec<_>) =
        ranges.iter().partition(|range| range.len() as f64 * sample_s > options.min_stuck_s - 0.5 * sample_s);
    let fault = |ranges: &[&Range<usize>]| -> Option<DataFault> {
        let samples: usize = ranges.iter().map(|range| range.len()).sum();
        let fault = place.fault_at(FaultKind::Stuck, ranges.first()?.start, samples as f64 * sample_s);
        let treatment = if is_usable { FaultHandling::Corrected } else { FaultHandling::Removed };
        Some(DataFault { count: ranges.len(), treatment, ..fault })
    };
    findings.faults.extend(long.iter().filter_map(|range| fault(&[range])));
    findings.faults.extend(fault(&short));
    let reference = references(place.axis(), place.channel).map(|(_, values)| values).next();
    for range in &ranges {
        bridge(values, reference, range);
        if is_usable {
            // A reading or two that are interpolated do not disturb the filter.
            findings.exclude(place, range, if range.len() > MAX_INTERPOLATED { margin } else { 0 });
        }
    }
    is_usable
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::{AxisLog, Log, Unit};

    /// 5 s of a motor and its table with a backlash, read with a resolution.
    fn log(backlash_mm: f64, resolution_mm: f64) -> Log {
        let motor: Vec<f64> = (0..5000).map(|i| 20.0 * (3e-3 * f64::from(i)).sin()).collect();
        let mut at = 0.0;
        let table = motor.iter().map(|&mm| {
            at = f64::clamp(at, mm - backlash_mm, mm);
            at
        });
        let read = |mm: f64| (mm / resolution_mm).round() * resolution_mm;
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        axis.table = Some(table.map(read).collect());
        axis.motor = Some(motor.into_iter().map(read).collect());
        Log::new("l", 10.0, 1e-3, [axis])
    }

    fn found(log: &Log) -> (Findings, Vec<f64>, bool) {
        let place = ChannelLocation { log, axis: 0, channel: Channel::Table };
        let mut values = log.axes[0].table.clone().unwrap();
        let mut findings = Findings::default();
        let is_usable = correct(&mut values, &place, 6, &FaultOptions::default(), &mut findings);
        (findings, values, is_usable)
    }

    fn hold(log: &mut Log, range: Range<usize>) {
        let table = log.axes[0].table.as_mut().unwrap();
        let value = table[range.start - 1];
        table[range].fill(value);
    }

    #[test]
    fn a_stuck_scale_is_found_with_its_time_and_restored() {
        let whole = log(0.0, 1e-5);
        let mut stuck = whole.clone();
        // 60 mm/s at the start, 100 ms; and 400 ms across a reversal at 523 ms, from which it returns.
        hold(&mut stuck, 100..200);
        hold(&mut stuck, 1400..1800);
        let (findings, values, is_usable) = found(&stuck);
        assert!(is_usable);
        let faults: Vec<_> =
            findings.faults.iter().map(|f| (f.kind, f.at_s.unwrap(), f.size.unwrap())).collect();
        assert_eq!(faults.len(), 2, "{faults:?}");
        for ((kind, at_s, size), (start_s, held_s)) in faults.into_iter().zip([(10.1, 0.1), (11.4, 0.4)]) {
            assert!(
                kind == FaultKind::Stuck && (at_s - start_s).abs() < 1e-9 && (size - held_s).abs() < 1e-9
            );
        }
        let table = whole.axes[0].table.as_ref().unwrap();
        assert!(
            values.iter().zip(table).all(|(a, b)| (a - b).abs() < 2.1e-5),
            "both readings are rounded to 1e-5"
        );
    }

    #[test]
    fn repeated_samples_are_one_fault_with_their_total_duration() {
        let mut log = log(0.0, 1e-5);
        // Every 50th sample while the axis moves fast, cos(3t) > 0.7: 42 mm/s or more.
        let fast: Vec<usize> =
            (50..5000).step_by(50).filter(|&i| (3e-3 * i as f64).cos().abs() > 0.7).collect();
        for &sample in &fast {
            hold(&mut log, sample..sample + 1);
        }
        let (findings, _, is_usable) = found(&log);
        let [fault] = &findings.faults[..] else { panic!("{:?}", findings.faults) };
        assert_eq!((fault.kind, fault.count, is_usable), (FaultKind::Stuck, fast.len(), true));
        assert!((fault.size.unwrap() - 1e-3 * fast.len() as f64).abs() < 1e-9);
    }

    #[test]
    fn backlash_and_coarse_encoders_are_not_stuck() {
        for (backlash_mm, resolution_mm) in [(0.03, 5e-4), (0.5, 1e-5), (0.0, 5e-3), (0.2, 2e-3)] {
            let (findings, ..) = found(&log(backlash_mm, resolution_mm));
            assert!(findings.faults.is_empty(), "{backlash_mm} {resolution_mm}: {:?}", findings.faults);
        }
    }

    /// The tool repeats a reading by chance while the table stands in a gap of 100 µm, and is then moved twice as far as the motor in a sample: it has not
    /// missed the motion of the motor. Without the table, whose reading tells, it is reported; and where the table has moved, too.
    #[test]
    fn a_reading_that_is_the_same_by_chance_while_the_table_stands_is_not_stuck() {
        let at: Vec<f64> = (0..200).map(|i| 2.5e-4 * f64::from(i * i)).collect();
        // It stands at 2.5 mm until the backlash ends after sample 101.
        let noise = |i: usize| 1e-5 * [0.0, 1.0, -2.0, 3.0][i % 4];
        let behind = |i: usize| if i < 102 { at[i].min(2.5) } else { at[i] } + noise(i);
        let standing: Vec<f64> = (0..200).map(behind).collect();
        let mut repeated = standing.clone();
        repeated[101] = repeated[100];
        let find = |table: Option<&[f64]>| {
            let mut axis = AxisLog::new("x", Unit::Millimetre);
            axis.motor = Some(at.clone());
            axis.table = table.map(<[f64]>::to_vec);
            axis.tool = Some(repeated.clone());
            let log = Log::new("l", 0.0, 1e-3, [axis]);
            let place = ChannelLocation { log: &log, axis: 0, channel: Channel::Tool };
            find(&repeated, &place, &FaultOptions::default())
        };
        assert_eq!(find(Some(&standing)), []);
        let reported = 101..102;
        assert_eq!(find(None), std::slice::from_ref(&reported));
        assert_eq!(find(Some(&at)), [reported]);
    }

    #[test]
    fn a_reading_that_is_held_half_of_the_time_is_not_used() {
        let mut log = log(0.0, 1e-5);
        for sample in (2..5000).step_by(2) {
            hold(&mut log, sample..sample + 1);
        }
        let (findings, _, is_usable) = found(&log);
        assert!(!is_usable && findings.faults[0].treatment == FaultHandling::Removed);
        assert!(findings.excluded.is_empty());
    }
}
