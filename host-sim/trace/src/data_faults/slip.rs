//! Slips: the reading jumps from one sample to the next and stays displaced.

use std::ops::Range;

use super::fault::FaultKind;
use super::findings::{Findings, Place};
use super::jumps::{self, Jump};
use super::spike::{self, Spike};
use crate::options::FaultOptions;
use files::log::Channel;

/// Number of samples on each side from which a step is determined.
const FIT: usize = 16;
/// Smallest number of them.
const MIN_FIT: usize = 8;
/// Smallest ratio of the lasting to the momentary displacement at a slip, and largest deviation of it from 1.
const MAX_DEVIATION: f64 = 0.35;
/// Largest ratio of the lasting to the momentary displacement at a spike.
const MAX_REMAINDER: f64 = 0.3;

/// A step of a difference of two channels.
#[derive(Clone, Copy, Debug)]
struct Step {
    size: f64,
    /// Root mean square of the deviations from the lines on both sides.
    scatter: f64,
}

/// Straight line through values at −1, −2, … or 1, 2, …: the value at 0.5 from the outermost towards zero, and the sum of
/// squared deviations.
fn line(values: &[f64], at: f64) -> (f64, f64) {
    let n = values.len() as f64;
    let centre = 0.5 * (n - 1.0);
    let mean = numerics::mean(values.iter().copied());
    let t = |i: usize| i as f64 - centre;
    let moment: f64 = (0..values.len()).map(|i| t(i) * t(i)).sum();
    let slope: f64 = values.iter().enumerate().map(|(i, v)| t(i) * (v - mean)).sum::<f64>() / moment;
    let deviations = values.iter().enumerate().map(|(i, v)| v - mean - slope * t(i));
    (mean + slope * (at - centre), deviations.map(|d| d * d).sum())
}

/// The step of `values` − `reference` across samples that are displaced otherwise, from straight lines on both sides within
/// `limits`; `None` if these are too close.
fn step(values: &[f64], reference: &[f64], across: &Range<usize>, limits: &Range<usize>) -> Option<Step> {
    let before = across.start.saturating_sub(FIT).max(limits.start)..across.start;
    let after = across.end..(across.end + FIT).min(limits.end);
    if before.len() < MIN_FIT || after.len() < MIN_FIT {
        return None;
    }
    let difference =
        |range: &Range<usize>| -> Vec<f64> { range.clone().map(|i| values[i] - reference[i]).collect() };
    // Both lines are continued to the middle between them.
    let half_gap = 0.5 * (across.len() + 1) as f64;
    let (first, first_squares) = line(&difference(&before), before.len() as f64 - 1.0 + half_gap);
    let (second, second_squares) = line(&difference(&after), -half_gap);
    let freedom = (before.len() + after.len() - 4) as f64;
    Some(Step { size: second - first, scatter: ((first_squares + second_squares) / freedom).sqrt() })
}

/// Whether another channel of the axis jumps as well, so that the machine moved or the log lacks a sample.
fn is_shared(place: &Place<'_>, jump: &Jump) -> bool {
    let axis = place.axis();
    let jumps = |other: &[f64]| {
        (jump.sample - 1..=jump.sample + 1).any(|sample| {
            let size = jumps::excess(other, sample);
            size * jump.size > 0.0 && size.abs() > MAX_REMAINDER * jump.size.abs()
        })
    };
    super::channels::references(axis, place.channel).any(|(_, other)| jumps(other))
}

/// Displaced readings of a channel.
#[derive(Clone, Debug, Default)]
struct Displaced {
    spikes: Vec<Spike>,
    /// Samples at each slip whose readings are not used, and the size of the slip.
    slips: Vec<(Range<usize>, f64)>,
}

/// Finds the slips and spikes of a channel of `place`, and removes them from `values`, its samples. Without another position
/// channel a slip cannot be distinguished from a motion; a command does not slip.
fn remove(values: &mut [f64], place: &Place<'_>, options: &FaultOptions) -> Displaced {
    let smallest = jumps::smallest(values, options);
    let jumps: Vec<Jump> = jumps::jumps(values, smallest, options);
    let groups = jumps::groups(&jumps);
    let reference = super::channels::reference(place.axis(), place.channel);
    let itself = vec![0.0; if reference.is_some() || jumps.is_empty() { 0 } else { values.len() }];
    let mut displaced = Displaced::default();
    for (number, group) in groups.iter().enumerate() {
        let (Some(first), Some(last)) = (group.first(), group.last()) else { continue };
        let across = first.sample..last.sample;
        let start =
            number.checked_sub(1).and_then(|before| groups[before].last()).map_or(0, |jump| jump.sample);
        let end = groups.get(number + 1).map_or(values.len(), |next| next[0].sample);
        let Some(step) = step(values, reference.unwrap_or(&itself), &across, &(start..end)) else { continue };
        let largest = numerics::max_abs(group.iter().map(|jump| jump.size));
        if group.iter().any(|jump| is_shared(place, jump)) {
            continue;
        }
        let is_significant = largest > options.min_jump_context * step.scatter;
        if group.len() > 1 && step.size.abs() < MAX_REMAINDER * largest && is_significant {
            displaced.spikes.push(spike::remove(values, reference, &across));
            continue;
        }
        let sum: f64 = group.iter().map(|jump| jump.size).sum();
        let is_lasting = (step.size / sum - 1.0).abs() < MAX_DEVIATION && step.size.abs() >= smallest;
        if is_lasting && is_significant && reference.is_some() && place.channel != Channel::Command {
            values[across.end..].iter_mut().for_each(|value| *value -= step.size);
            super::bridge::bridge(values, reference, &across);
            displaced.slips.push((across, step.size));
        }
    }
    displaced
}

/// Finds, reports and removes slips and spikes of a channel.
pub fn correct(
    values: &mut [f64],
    place: &Place<'_>,
    margin: usize,
    options: &FaultOptions,
    findings: &mut Findings,
) {
    let displaced = remove(values, place, options);
    for (samples, size) in &displaced.slips {
        findings.faults.push(place.fault_at(FaultKind::Slip, samples.end, 1e3 * size));
        findings.exclude(place, samples, margin);
    }
    findings.faults.extend(spike::fault(place, &displaced.spikes));
    for spike in &displaced.spikes {
        findings.exclude(place, &spike.samples, margin);
    }
}
