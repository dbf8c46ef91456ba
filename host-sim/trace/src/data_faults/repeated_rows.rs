//! Repeated rows: the logger lost samples and wrote the previous row again, for all channels, or for all that are measured, as a
//! control knows its commands; of all axes, or of one that is read over a bus of its own.
//!
//! In contrast to a channel that is [`stuck`](super::stuck), no other channel of the row tells where the axis was. The lost rows are
//! interpolated between their neighbours, as the filters and the simulated loop need a value, and excluded from all residuals.

use std::borrow::Cow;
use std::ops::Range;

use super::channels::{Accuracy, POSITIONS};
use super::fault::{DataFault, FaultHandling, FaultKind};
use super::findings::{ChannelLocation, Findings};
use super::stuck::MAX_INTERPOLATED;
use files::log::{AxisLog, Channel, Log};
use model::effects::Stage;

/// Largest number of successive rows that are interpolated. Of a longer gap the motion is not known.
const MAX_ROWS: usize = 100;
/// Number of successive rows from which the interpolation is a motion that the machine did not make: the drive train then
/// oscillates in the model, and the settling time is left out.
const MIN_LONG: usize = 20;
/// Smallest number of gaps at which an axis jumps by the motion that was missed. An axis at rest repeats its rows, too. One gap is
/// enough if it has [`MIN_ALONE`] rows, or if this many channels are repeated.
const MIN_JUMPS: usize = 3;
/// Number of rows that are not equal by chance before a jump.
const MIN_ALONE: usize = 5;
/// Number of channels that are not equal by chance before a jump.
const MIN_CHANNELS: usize = 3;
/// Smallest change across a gap, in steps of a channel. What changes by less is equal by the rounding of its readings.
const MIN_CHANGE: f64 = 1.5;
/// A jump is greater than the steps before and after by this factor. After one lost row it is twice as large.
const MIN_JUMP: f64 = 1.5;
/// Smallest jump in steps of the encoder, and in standard deviations of the noise.
const MIN_STEPS: f64 = 3.0;
const MIN_NOISE: f64 = 8.0;

const ALL_STAGES: &[Stage] = &[Stage::Motor, Stage::Table, Stage::Tool, Stage::Force];

/// The channels of all axes: index of the axis, channel, values.
fn columns(log: &Log) -> impl Iterator<Item = (usize, Channel, &[f64])> {
    let of_axis = |(index, axis)| {
        Channel::ALL
            .into_iter()
            .filter_map(move |channel| AxisLog::channel(axis, channel).map(|values| (index, channel, values)))
    };
    log.axes.iter().enumerate().flat_map(of_axis)
}

const fn is_measured(channel: Channel) -> bool {
    !matches!(channel, Channel::Command | Channel::AddedForce | Channel::Temperature)
}

/// The measured channels of an axis, or all of the log if only one is measured: that one may be [`stuck`](super::stuck) by itself.
fn of_axis(log: &Log, axis: usize) -> Vec<(Channel, &[f64])> {
    let all = || columns(log).map(|(_, channel, values)| (channel, values));
    let of_axis = columns(log).filter(|(index, channel, _)| *index == axis && is_measured(*channel));
    let of_axis: Vec<_> = of_axis.map(|(_, channel, values)| (channel, values)).collect();
    if of_axis.len() > 1 { of_axis } else { all().collect() }
}

/// The measured channels of all axes, or all channels if only one is measured.
fn of_log(log: &Log) -> Vec<(Channel, &[f64])> {
    let all: Vec<_> = columns(log).map(|(_, channel, values)| (channel, values)).collect();
    let measured: Vec<_> = all.iter().copied().filter(|(channel, _)| is_measured(*channel)).collect();
    if measured.len() > 1 { measured } else { all }
}

/// The ranges of rows that equal the row before the range in each of these columns.
fn repeated<'a>(columns: impl Iterator<Item = &'a [f64]>, rows: usize) -> Vec<Range<usize>> {
    let columns: Vec<&[f64]> = columns.collect();
    let is_repeated =
        |row: usize| columns.iter().all(|values| values[row].to_bits() == values[row - 1].to_bits());
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for row in (1..rows).filter(|&row| is_repeated(row)) {
        match ranges.last_mut() {
            Some(last) if last.end == row => last.end += 1,
            _ => ranges.push(row..row + 1),
        }
    }
    ranges
}

/// Whether a position jumps after the range by the motion that was missed.
fn jumps(values: &[f64], range: &Range<usize>, smallest: f64) -> bool {
    let change = |row: usize| Some(values.get(row)? - values.get(row.checked_sub(1)?)?);
    let beside = [range.start.checked_sub(1).and_then(change), change(range.end + 1)];
    let (Some(jump), [Some(before), Some(after)]) = (change(range.end), beside) else { return false };
    jump.abs() > smallest && jump.abs() > MIN_JUMP * before.abs().max(after.abs())
}

/// The rows that were lost of these columns.
fn lost(columns: &[(Channel, &[f64])], rows: usize) -> Vec<Range<usize>> {
    let accuracy: Vec<Accuracy> = columns.iter().map(|(_, values)| Accuracy::of(values)).collect();
    let columns: Vec<_> = columns.iter().zip(accuracy).collect();
    let changes = |range: &Range<usize>| {
        columns.iter().any(|((_, values), Accuracy { resolution, .. })| {
            (values[range.end] - values[range.start]).abs() > MIN_CHANGE * resolution
        })
    };
    let jumps = |range: &&Range<usize>| {
        columns.iter().filter(|((channel, _), _)| POSITIONS.contains(channel)).any(
            |((_, values), Accuracy { noise, resolution })| {
                jumps(values, range, (MIN_STEPS * resolution).max(MIN_NOISE * noise))
            },
        )
    };
    let mut ranges = repeated(columns.iter().map(|((_, values), _)| *values), rows);
    ranges
        .retain(|range| range.len() <= MAX_ROWS && range.start > 1 && range.end + 1 < rows && changes(range));
    let shown = ranges.iter().filter(jumps);
    let are_many = columns.len() >= MIN_CHANNELS;
    let is_decisive = shown.clone().any(|range| are_many || range.len() >= MIN_ALONE);
    if is_decisive || shown.count() >= MIN_JUMPS { ranges } else { Vec::new() }
}

/// Finds and reports repeated rows, and interpolates them. `margin` is the number of neighbours that are excluded beside a gap
/// that a filter does not bridge, `settling` that beside a long gap.
///
/// Axes may be read over buses of their own: the rows of each are looked at by themselves. An axis that shows no jump, as it
/// stands still, has lost those of the log.
pub fn correct(log: &mut Cow<'_, Log>, [margin, settling]: [usize; 2], findings: &mut Findings) {
    let of_all = lost(&of_log(log), log.len());
    let of_axes: Vec<Vec<Range<usize>>> = (0..log.axes.len())
        .map(|axis| lost(&of_axis(log, axis), log.len()))
        .map(|ranges| if ranges.is_empty() { of_all.clone() } else { ranges })
        .collect();
    for (axis, ranges) in of_axes.iter().enumerate() {
        let Some(first) = ranges.first() else { continue };
        let rows: usize = ranges.iter().map(Range::len).sum();
        let place = ChannelLocation { log, axis, channel: Channel::Motor };
        let fault = place.fault_at(FaultKind::Stuck, first.start, rows as f64 * log.sample_time_s);
        let fault =
            DataFault { channel: None, count: ranges.len(), treatment: FaultHandling::Corrected, ..fault };
        findings.faults.push(fault);
        for range in ranges {
            let margin = match range.len() {
                ..=MAX_INTERPOLATED => 0,
                MIN_LONG.. => settling,
                _ => margin,
            };
            findings.exclude_stages(&place, range, margin, ALL_STAGES);
        }
        interpolate_axis(log.to_mut(), axis, ranges, is_constant);
    }
}

/// Excludes rows that were interpolated when the file was read, with what a filter and a second difference make of them, and interpolates them again
/// by cubics, as a straight line has corners. A jump of the force between two rows is lost: its acceleration is wrong beside the row.
pub fn exclude_interpolated(log: &mut Cow<'_, Log>, [margin, settling]: [usize; 2], findings: &mut Findings) {
    let ranges = log.interpolated.clone();
    if ranges.is_empty() {
        return;
    }
    for axis in 0..log.axes.len() {
        let place = ChannelLocation { log, axis, channel: Channel::Motor };
        for range in &ranges {
            let margin = if range.len() < MIN_LONG { margin } else { settling };
            findings.exclude_stages(&place, range, margin, ALL_STAGES);
        }
        interpolate_axis(log.to_mut(), axis, &ranges, |_, _| true);
    }
}

/// Interpolates the channels of an axis over lost rows, where `is_lost_in` holds for the values of the channel and the range.
fn interpolate_axis(
    log: &mut Log,
    axis: usize,
    ranges: &[Range<usize>],
    is_lost_in: impl Fn(&[f64], &Range<usize>) -> bool,
) {
    let mut is_lost = vec![false; log.len()];
    for range in ranges {
        is_lost[range.clone()].fill(true);
    }
    for channel in Channel::ALL {
        let Some(values) = log.axes[axis].channel_mut(channel).as_mut() else { continue };
        let resolution = Accuracy::of(values).resolution;
        for range in ranges {
            if let Some(knots) = knots(range, &is_lost).filter(|_| is_lost_in(values, range)) {
                interpolate(values, range, knots, resolution);
            }
        }
    }
}

/// Whether the values of a range are that before it. A command may go on.
fn is_constant(values: &[f64], range: &Range<usize>) -> bool {
    values[range.start - 1..range.end].windows(2).all(|two| two[0].to_bits() == two[1].to_bits())
}

/// The nearest two rows before a range and the nearest two after it that are not lost.
fn knots(range: &Range<usize>, is_lost: &[bool]) -> Option<[usize; 4]> {
    let mut before = (0..range.start).rev().filter(|&row| !is_lost[row]);
    let mut after = (range.end..is_lost.len()).filter(|&row| !is_lost[row]);
    let [last, next] = [before.next()?, after.next()?];
    Some([before.next()?, last, next, after.next()?])
}

/// Replaces the values of a range by those of the cubic through the values of four rows, in steps of the encoder.
fn interpolate(values: &mut [f64], range: &Range<usize>, knots: [usize; 4], resolution: f64) {
    let knots = knots.map(|row| (row as f64, values[row]));
    for row in range.clone() {
        let at = row as f64;
        let basis = |i: usize| -> f64 {
            let others = (0..4).filter(|&j| j != i);
            others.map(|j| (at - knots[j].0) / (knots[i].0 - knots[j].0)).product()
        };
        let value: f64 = (0..4).map(|i| knots[i].1 * basis(i)).sum();
        values[row] = if resolution > 0.0 { (value / resolution).round() * resolution } else { value };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::Unit;

    const RESOLUTION_MM: f64 = 1e-3;

    /// 5 s of an axis with 60 mm/s at most that stands still for the last second, read in steps of 1 µm.
    fn log() -> Log {
        let at = |i: u32| 20.0 * (3e-3 * f64::from(i.min(4000))).sin();
        let read = |mm: f64| (mm / RESOLUTION_MM).round() * RESOLUTION_MM;
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        axis.command = Some((0..5000).map(at).collect());
        axis.motor = Some((0..5000).map(|i| read(at(i))).collect());
        axis.table = Some((0..5000).map(|i| read(at(i) + 0.1)).collect());
        Log::new("l", 10.0, 1e-3, [axis])
    }

    /// The log with rows replaced by the row before them.
    fn losing(rows: &[Range<usize>]) -> Log {
        let mut log = log();
        for channel in [Channel::Command, Channel::Motor, Channel::Table] {
            let values = log.axes[0].channel_mut(channel).as_mut().unwrap();
            for range in rows {
                let last = values[range.start - 1];
                values[range.clone()].fill(last);
            }
        }
        log
    }

    fn corrected(log: &Log) -> (Cow<'_, Log>, Findings) {
        let (mut log, mut findings) = (Cow::Borrowed(log), Findings::default());
        correct(&mut log, [6, 300], &mut findings);
        (log, findings)
    }

    /// A control that knows its command repeats the measured channels alone: the motor must not be replaced by the motion of the table,
    /// which is repeated as well, and the command is kept.
    #[test]
    fn rows_are_lost_although_the_command_goes_on() {
        let mut broken = losing(&[100..101, 700..702, 1500..1501]);
        broken.axes[0].command.clone_from(&log().axes[0].command);
        let (log, findings) = corrected(&broken);
        assert_eq!((findings.faults.len(), findings.faults[0].count), (1, 3));
        assert_eq!(log.axes[0].command, broken.axes[0].command);
        let motor = |log: &Log| log.axes[0].motor.clone().unwrap();
        let error = numerics::max_abs(motor(&log).iter().zip(motor(&self::log())).map(|(a, b)| a - b));
        assert!(error < 2.1 * RESOLUTION_MM, "{error}");
        // A motor that is the only sensor may be stuck by itself.
        broken.axes[0].table = None;
        assert!(corrected(&broken).1.faults.is_empty());
    }

    /// Each axis loses rows of its own; the third axis is at rest and repeats all.
    #[test]
    fn axes_lose_rows_of_their_own() {
        let mut broken = losing(&[100..101, 700..702, 1500..1501]);
        let [mut y, mut at_rest] = [losing(&[200..201, 900..901, 1700..1701, 2500..2501]), log()];
        y.axes[0].name = "y".to_owned();
        at_rest.axes[0].name = "z".to_owned();
        for channel in [Channel::Command, Channel::Motor, Channel::Table] {
            at_rest.axes[0].channel_mut(channel).as_mut().unwrap().fill(1.0);
        }
        broken.axes.extend([y, at_rest].into_iter().flat_map(|log| log.axes));
        let (log, findings) = corrected(&broken);
        let counts: Vec<(&str, usize)> =
            findings.faults.iter().map(|fault| (fault.axis.as_str(), fault.count)).collect();
        assert_eq!(counts, [("x", 3), ("y", 4)]);
        for axis in &log.axes[..2] {
            let sound = self::log().axes[0].motor.clone().unwrap();
            let motor = axis.motor.as_ref().unwrap();
            let error = numerics::max_abs(motor.iter().zip(sound).map(|(a, b)| a - b));
            assert!(error < 2.1 * RESOLUTION_MM, "{}: {error}", axis.name);
        }
    }

    #[test]
    fn lost_rows_are_one_fault_and_interpolated() {
        let rows = [100..101, 700..702, 1500..1501, 2500..2510];
        let broken = losing(&rows);
        let (log, findings) = corrected(&broken);
        let [fault] = &findings.faults[..] else { panic!("{:?}", findings.faults) };
        assert_eq!((fault.kind, fault.channel, fault.count), (FaultKind::Stuck, None, 4));
        assert!((fault.at_s.unwrap() - 10.1).abs() < 1e-9 && (fault.size.unwrap() - 0.014).abs() < 1e-9);
        // The cubic through rounded values is off by at most 1.25 roundings of half a step between them, and is rounded itself;
        // across ten rows the fourth derivative adds (ωT)⁴·20 mm·(6·5)²/24 = 0.06 µm.
        for (values, sound) in [
            (&log.axes[0].motor, &self::log().axes[0].motor),
            (&log.axes[0].table, &self::log().axes[0].table),
        ] {
            let error =
                numerics::max_abs(values.iter().flatten().zip(sound.iter().flatten()).map(|(a, b)| a - b));
            assert!(error < 2.1 * RESOLUTION_MM, "{error}");
        }
        let command = |log: &Log| log.axes[0].command.clone().unwrap();
        let error = numerics::max_abs(command(&log).iter().zip(command(&self::log())).map(|(a, b)| a - b));
        assert!(error < 1e-4, "{error}");
        assert_eq!(findings.excluded.len(), 4);
        // Only the gap of ten rows spoils its neighbours: 22 samples.
        let excluded_s: f64 = findings.excluded.iter().map(|e| e.to_s - e.from_s).sum();
        assert!((excluded_s - 0.026).abs() < 1e-9, "{excluded_s}");
    }

    /// A row that the file does not have is excluded with the margin on both sides, 2·6 + 1 samples, a long gap with the settling of 300, and the
    /// values between are those of a cubic: off by at most L/8 of the errors of both slopes, a step per row each: 26/8·2 = 6.5 steps, and the rounding. What was measured is
    /// unchanged.
    #[test]
    fn rows_that_the_file_does_not_have_are_excluded_with_their_neighbours() {
        let sound = log();
        let mut broken = Log { interpolated: vec![700..701, 2000..2025], ..log() };
        broken.axes[0].motor.as_mut().unwrap()[700] += 0.5;
        let (mut log, mut findings) = (Cow::Borrowed(&broken), Findings::default());
        exclude_interpolated(&mut log, [6, 300], &mut findings);
        assert!(findings.faults.is_empty());
        let excluded_ms: Vec<f64> = findings.excluded.iter().map(|e| 1e3 * (e.to_s - e.from_s)).collect();
        assert!(
            (excluded_ms[0] - 13.0).abs() < 1e-6 && (excluded_ms[1] - 625.0).abs() < 1e-6,
            "{excluded_ms:?}"
        );
        // The log starts at 10 s.
        assert!((findings.excluded[0].from_s - (10.7 - 0.0065)).abs() < 1e-9);
        for (row, (own, truth)) in
            log.axes[0].motor.iter().flatten().zip(sound.axes[0].motor.iter().flatten()).enumerate()
        {
            let is_gap = broken.interpolated.iter().any(|range| range.contains(&row));
            let most = if is_gap { 8.0 * RESOLUTION_MM } else { 0.0 };
            assert!((own - truth).abs() <= most, "{row}: {own} {truth}");
        }
    }

    #[test]
    fn an_axis_at_rest_and_a_coarse_encoder_repeat_no_rows() {
        assert!(corrected(&log()).1.faults.is_empty());
        // Two gaps may be chance, one of five rows is not.
        assert!(corrected(&losing(&[100..101, 1500..1501])).1.faults.is_empty());
        assert_eq!(corrected(&losing(std::slice::from_ref(&(1500..1505)))).1.faults.len(), 1);
        // Nor is one of a single row in three channels.
        let mut of_three = losing(std::slice::from_ref(&(1500..1501)));
        let table = of_three.axes[0].table.clone();
        of_three.axes[0].tool = table;
        assert_eq!(corrected(&of_three).1.faults.len(), 1);
        // At rest all rows are equal but for a probe with noise, whose readings differ by chance.
        let mut noisy = log();
        let reading = |i: u32| if i % 10 < 2 { 0.0 } else { 1e-5 * f64::from(i * i % 7) };
        noisy.axes[0].tool = Some((0..5000).map(reading).collect());
        assert!(corrected(&noisy).1.faults.is_empty());
        // Without a command, below 1 mm/s rows are equal by rounding.
        let mut slow = log();
        slow.axes[0].command = None;
        for channel in [Channel::Motor, Channel::Table] {
            let values = slow.axes[0].channel_mut(channel).as_mut().unwrap();
            for mm in values {
                *mm = (0.01 * *mm / RESOLUTION_MM).round() * RESOLUTION_MM;
            }
        }
        assert!(corrected(&slow).1.faults.is_empty());
    }
}
