//! Jumps: differences of two successive readings that are not within the range of those around them.
//!
//! A machine moves with finite acceleration: in its reading the difference at an instant is between those before and those
//! after it, at a reversal, at the end of a backlash and at a stop as well. A fault of the sensor adds a displacement to a
//! single difference.

use super::channels::Accuracy;
use crate::options::FaultOptions;

/// Number of differences on each side of one with which it is compared.
const NEIGHBOURS: usize = 6;
/// Number of the largest and of the smallest ones that are disregarded, as they may be jumps themselves: two spikes.
const DISREGARDED: usize = 2;
/// Number of samples on each side in which other jumps are counted.
const CONTEXT: usize = 200;
/// Number of the largest other jumps that are disregarded: spikes in a few percent of the samples.
const OTHERS: usize = 30;
/// Smallest fraction of a jump of the difference of two channels that is one of the channel itself.
const MIN_OWN: f64 = 0.7;
/// Largest deviation of the changes beside a jump from their median, as a fraction of the jump.
const MAX_BESIDE: f64 = 0.25;
/// Number of samples on each side for which this is required.
const BESIDE: usize = 4;
/// Number of candidates above which the channel has irregular readings throughout, so that none is a fault.
const MAX_CANDIDATES: usize = 4000;

/// A jump between two successive samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// The later sample.
    pub sample: usize,
    /// The part of the difference that is outside the range of its neighbours.
    pub size: f64,
}

/// A channel, relative to another one that moves with it: acceleration of the machine is not a part of the difference.
#[derive(Clone, Copy, Debug)]
pub struct Relative<'a> {
    /// The channel.
    pub values: &'a [f64],
    /// The other channel, if there is one.
    pub reference: Option<&'a [f64]>,
}

impl Relative<'_> {
    /// Change of the difference from the previous sample.
    fn change(&self, sample: usize) -> f64 {
        let change = |values: &[f64]| values[sample] - values[sample - 1];
        change(self.values) - self.reference.map_or(0.0, change)
    }

    /// The part of [`Self::change`] that is outside the range of its neighbours; zero near the ends.
    fn excess(&self, sample: usize) -> f64 {
        if !is_inside(self.values, sample) {
            return 0.0;
        }
        let mut around = [0.0; 2 * NEIGHBOURS];
        for (number, slot) in around.iter_mut().enumerate() {
            let shift = usize::from(number >= NEIGHBOURS);
            *slot = self.change(sample - NEIGHBOURS + number + shift);
        }
        around.sort_unstable_by(f64::total_cmp);
        let (low, high) = (around[DISREGARDED], around[2 * NEIGHBOURS - 1 - DISREGARDED]);
        let own = self.change(sample);
        own - own.clamp(low, high)
    }

    /// Whether the changes around a group of jumps, and between them, are those of a steady motion. The impact at the end of a
    /// backlash, or a resonance, displaces the channel over several samples; a fault of the sensor does it in one.
    #[must_use]
    pub fn is_steady_around(&self, group: &[Jump], smallest: f64) -> bool {
        let (Some(first), Some(last)) = (group.first(), group.last()) else { return false };
        if !is_inside(self.values, first.sample) || !is_inside(self.values, last.sample) {
            return false;
        }
        let others = || {
            let around = first.sample - NEIGHBOURS..=last.sample + NEIGHBOURS;
            around.filter(|sample| group.iter().all(|jump| jump.sample != *sample))
        };
        let changes: Vec<f64> = others().map(|sample| self.change(sample)).collect();
        let Some(steady) = numerics::median(&changes) else { return false };
        let largest = numerics::max_abs(group.iter().map(|jump| jump.size));
        let max = (MAX_BESIDE * largest).max(0.5 * smallest);
        let near =
            others().filter(|sample| sample + BESIDE >= first.sample && *sample <= last.sample + BESIDE);
        near.map(|sample| self.change(sample) - steady).all(|deviation| deviation.abs() <= max)
    }

    /// Whether the jump is one of the channel and not of the reference.
    fn is_own(&self, jump: &Jump) -> bool {
        own(self.values, jump.sample) / jump.size > MIN_OWN
    }
}

/// Whether a sample has all neighbours.
const fn is_inside(values: &[f64], sample: usize) -> bool {
    sample > NEIGHBOURS && sample + NEIGHBOURS < values.len()
}

/// Difference of a channel from the previous sample, minus the mean of those before and after; zero near the ends.
#[must_use]
pub fn own(values: &[f64], sample: usize) -> f64 {
    if !is_inside(values, sample) {
        return 0.0;
    }
    let change = |sample: usize| values[sample] - values[sample - 1];
    let median = |a: f64, b: f64, c: f64| a.max(b).min(a.min(b).max(c));
    let before = median(change(sample - 1), change(sample - 2), change(sample - 3));
    let after = median(change(sample + 1), change(sample + 2), change(sample + 3));
    change(sample) - 0.5 * (before + after)
}

/// Smallest displacement that is regarded as a fault of a channel relative to another one, in its unit.
#[must_use]
pub fn smallest(values: &[f64], reference: Option<&[f64]>, options: &FaultOptions) -> f64 {
    let own = Accuracy::of(values);
    let other = reference.map_or(own, Accuracy::of);
    let noise = options.min_jump_noise * own.noise.max(other.noise);
    let resolution = options.min_jump_resolution * own.resolution.max(other.resolution);
    (1e-3 * options.min_jump_um).max(noise).max(resolution)
}

/// The jumps of a channel that are at least `smallest` and far larger than other ones around them.
#[must_use]
pub fn jumps(signal: Relative<'_>, smallest: f64, options: &FaultOptions) -> Vec<Jump> {
    let may_jump = |&sample: &usize| {
        let own = signal.change(sample);
        let beside = [signal.change(sample - 1), signal.change(sample + 1)];
        beside.iter().any(|other| (own - other).abs() >= smallest)
    };
    let last = signal.values.len().saturating_sub(NEIGHBOURS);
    let candidates: Vec<Jump> = (NEIGHBOURS + 1..last)
        .filter(may_jump)
        .map(|sample| Jump { sample, size: signal.excess(sample) })
        .filter(|jump| jump.size.abs() >= smallest && signal.is_own(jump))
        .collect();
    if candidates.len() > MAX_CANDIDATES {
        return Vec::new();
    }
    let is_isolated = |jump: &&Jump| {
        let first = jump.sample.saturating_sub(CONTEXT).max(1);
        let mut others: Vec<f64> = (first..(jump.sample + CONTEXT).min(signal.values.len()))
            .filter(|sample| sample.abs_diff(jump.sample) > NEIGHBOURS)
            .map(|sample| signal.excess(sample).abs())
            .collect();
        others.sort_unstable_by(|a, b| b.total_cmp(a));
        jump.size.abs() >= options.min_jump_context * others.get(OTHERS).copied().unwrap_or(0.0)
    };
    candidates.iter().filter(is_isolated).copied().collect()
}

/// Jumps that are too close to each other to be separate, in order.
#[must_use]
pub fn groups(jumps: &[Jump]) -> Vec<&[Jump]> {
    jumps.chunk_by(|a, b| b.sample - a.sample <= NEIGHBOURS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(values: &[f64], reference: Option<&[f64]>) -> Vec<Jump> {
        let options = FaultOptions::default();
        jumps(Relative { values, reference }, smallest(values, reference, &options), &options)
    }

    #[test]
    fn a_displacement_in_one_sample_is_a_jump_of_its_size() {
        // 100 mm/s at sample 628, noise-free; 8 µm there.
        let mut values: Vec<f64> = (0..1000).map(|i| 20.0 * (5e-3 * f64::from(i)).sin()).collect();
        values[628..].iter_mut().for_each(|mm| *mm += 0.008);
        let [jump] = found(&values, None)[..] else { panic!("one jump") };
        // The acceleration within four samples of the maximum velocity: 20 mm·(5e-3)³·4² = 0.04 µm.
        assert!(jump.sample == 628 && (jump.size - 0.008).abs() < 4e-5, "{jump:?}");
    }

    #[test]
    fn a_stop_a_reversal_and_a_backlash_are_no_jumps() {
        // Instant changes of velocity between 200, 0 and −200 mm/s: harder than any machine.
        let velocity = |i: usize| [0.2, 0.0, -0.2, 0.2, 0.0, 0.1][i / 200];
        let mut mm = 0.0;
        let motor: Vec<f64> = (0..1200)
            .map(|i| {
                mm += velocity(i);
                mm
            })
            .collect();
        assert_eq!(found(&motor, None), []);
        // 30 µm of backlash: the table stands while the motor crosses the gap within a sample.
        let mut at = 0.0;
        let table: Vec<f64> = motor
            .iter()
            .map(|mm| {
                at = f64::clamp(at, mm - 0.03, *mm);
                at
            })
            .collect();
        assert_eq!(found(&table, None), []);
        assert_eq!(found(&table, Some(&motor)), []);
        assert_eq!(found(&motor, Some(&table)), []);
    }

    #[test]
    fn steps_of_a_coarse_encoder_are_no_jumps() {
        // 5 µm steps at 0.1 to 30 mm/s.
        let position = |i: u32| 15.0 * (2e-3 * f64::from(i)).sin();
        let values: Vec<f64> = (0..4000).map(|i| (position(i) / 0.005).round() * 0.005).collect();
        assert_eq!(found(&values, None), []);
    }
}
