//! A force whose reading is stuck.

use super::bridge::bridge;
use super::fault::FaultKind;
use super::findings::{ChannelLocation, Findings};
use crate::options::FaultOptions;
use files::log::Channel;

/// Number of samples before and after a range from which the noise is determined.
const CONTEXT: usize = 64;

/// Finds and reports stuck readings of a force, and interpolates them.
///
/// Unlike a position, a force does not follow from another channel. A force whose noise exceeds its resolution before and
/// after does not repeat its value by chance for many samples. The force at its limit is constant and no fault.
pub fn correct(
    values: &mut [f64],
    place: &ChannelLocation<'_>,
    margin: usize,
    options: &FaultOptions,
    findings: &mut Findings,
) {
    let sample_s = place.log.sample_time_s;
    let min_samples = (options.min_stuck_s / sample_s - 0.5).max(10.0);
    let positions = super::channels::reference(place.axis(), Channel::Force);
    let limit = numerics::max_abs(values.iter().copied());
    let resolution = super::channels::Accuracy::of(values).resolution;
    let mut start = 1;
    for end in 1..=values.len() {
        if end < values.len() && values[end].to_bits() == values[end - 1].to_bits() {
            continue;
        }
        let range = start..end;
        start = end + 1;
        if (range.len() as f64) < min_samples || values[range.start].abs() >= 0.99 * limit {
            continue;
        }
        let travel = positions.map_or(0.0, |mm| numerics::peak_to_peak(mm[range.clone()].iter().copied()));
        let before = &values[range.start.saturating_sub(CONTEXT)..range.start];
        let after = &values[range.end..(range.end + CONTEXT).min(values.len())];
        let is_noisy =
            |values: &[f64]| values.len() == CONTEXT && super::channels::noise(values) > resolution;
        if travel > 1e-3 * options.min_held_travel_um && is_noisy(before) && is_noisy(after) {
            findings.faults.push(place.fault_at(
                FaultKind::Stuck,
                range.start,
                range.len() as f64 * sample_s,
            ));
            findings.exclude(place, &range, margin);
            bridge(values, None, &range);
        }
    }
}
