//! Shifted: a sensor is logged later or earlier than any latency that is searched for.

use std::borrow::Cow;

use super::bridge::bridge;
use super::channels::{SENSORS, references, thinned};
use super::difference::deviation;
use super::fault::{FaultHandling, FaultKind};
use super::findings::{ChannelLocation, Findings};
use crate::options::FaultOptions;
use files::log::{Channel, Log};

/// Largest shift that is looked for, s.
const MAX_SHIFT_S: f64 = 2.0;
/// Steps of the search per smallest shift.
const STEPS: f64 = 20.0;

/// Deviation of `values[i + shift] − reference[i]` from its median, over every `every`th sample.
fn difference(values: &[f64], reference: &[f64], shift: isize, every: usize) -> f64 {
    let pairs = (0..reference.len()).step_by(every).filter_map(|i| {
        let shifted = i.checked_add_signed(shift)?;
        Some(values.get(shifted)? - reference[i])
    });
    deviation(&pairs.collect::<Vec<f64>>())
}

/// The number of samples by which a channel is late relative to a reference, if that is far more than a latency and nothing
/// else explains the difference.
fn shift(values: &[f64], reference: &[f64], sample_s: f64, options: &FaultOptions) -> Option<isize> {
    #[expect(clippy::cast_possible_truncation, reason = "a few thousand samples")]
    let samples = |seconds: f64| (seconds / sample_s).round() as isize;
    let smallest = samples(options.min_shift_s).max(2);
    let largest = samples(MAX_SHIFT_S).min(isize::try_from(values.len() / 4).unwrap_or(0));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1")]
    let step = (smallest as f64 / STEPS).round().max(1.0) as usize;
    let unshifted = difference(&thinned(values), &thinned(reference), 0, step);
    if unshifted < options.min_shifted_mm {
        return None;
    }
    let coarse: Vec<(isize, f64)> =
        (-largest..=largest).step_by(step).map(|by| (by, difference(values, reference, by, step))).collect();
    let &(near, _) = coarse.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let step = isize::try_from(step).ok()?;
    let fine = (near - step..=near + step).map(|by| (by, difference(values, reference, by, 1)));
    let (best, least) = fine.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let is_unique = coarse.iter().all(|(by, size)| (by - best).abs() < smallest || *size > 10.0 * least);
    let is_far = best.abs() >= smallest && least < options.max_shifted_remainder * unshifted;
    (is_unique && is_far).then_some(best)
}

/// The number of samples by which a sensor is late relative to all other sensors of its axis.
fn late_by(place: &ChannelLocation<'_>, options: &FaultOptions) -> Option<isize> {
    let values = place.axis().channel(place.channel)?;
    let sensors = references(place.axis(), place.channel).filter(|(other, _)| *other != Channel::Command);
    let mut shifts = sensors.map(|(_, other)| shift(values, other, place.log.sample_time_s, options));
    let by = shifts.next()??;
    // To within a latency of their own.
    shifts.all(|other| other.is_some_and(|other| (other - by).abs() <= 1 + by.abs() / 10)).then_some(by)
}

/// Reports sensors that are shifted in time against the other sensors of their axis, and shifts them back. If only two
/// sensors are logged, it is the one farther from the motor. The samples beyond the ends are excluded.
pub fn correct(log: &mut Cow<'_, Log>, margin: usize, options: &FaultOptions, findings: &mut Findings) {
    for axis in 0..log.axes.len() {
        for channel in SENSORS.into_iter().rev() {
            let place = ChannelLocation { log, axis, channel };
            let Some(by) = late_by(&place, options) else { continue };
            let Some(values) = place.axis().channel(channel) else { continue };
            let mut corrected = shifted(values, by);
            let ms = 1e3 * by as f64 * log.sample_time_s;
            findings.faults.push(place.fault(FaultKind::Shifted, Some(ms), FaultHandling::Corrected));
            let (late, count) = (by.unsigned_abs().min(values.len()), values.len());
            let missing = if by > 0 { count - late..count } else { 0..late };
            let reference = references(place.axis(), channel).map(|(_, values)| values).next();
            bridge(&mut corrected, reference, &missing);
            findings.exclude(&place, &missing, margin);
            *log.to_mut().axes[axis].channel_mut(channel) = Some(corrected);
        }
    }
}

/// The values that were logged `by` samples later; the nearest value where they were not logged.
#[must_use]
pub fn shifted(values: &[f64], by: isize) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let at = |i: usize| {
        let shifted = i.checked_add_signed(by).unwrap_or(0);
        values[shifted.min(last)]
    };
    (0..values.len()).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::{AxisLog, Unit};

    /// Two moves of different size; the table is logged late.
    fn log(late: isize) -> Log {
        let ramp = |i: f64, start: f64, length: f64| ((i - start) / length).clamp(0.0, 1.0);
        let at = |i: u32| {
            let i = f64::from(i);
            30.0 * ramp(i, 1000.0, 700.0) - 50.0 * ramp(i, 3000.0, 900.0)
        };
        let motor: Vec<f64> = (0..6000).map(at).collect();
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        axis.table = Some(shifted(&motor, -late));
        axis.motor = Some(motor);
        Log::new("l", 0.0, 1e-3, [axis])
    }

    #[test]
    fn a_table_that_is_far_too_late_is_shifted_back_and_a_latency_is_not() {
        for (late, expected) in [(250, Some(250.0)), (-400, Some(-400.0)), (0, None), (20, None), (-80, None)]
        {
            let mut log = Cow::Owned(log(late));
            let mut findings = Findings::default();
            correct(&mut log, 6, &FaultOptions::default(), &mut findings);
            assert_eq!(findings.faults.first().and_then(|fault| fault.size), expected, "{late}");
            if expected.is_some() {
                assert_eq!(log.axes[0].table, log.axes[0].motor);
            }
        }
    }
}
