//! Whether a form is more than chance: an F test beside the runs left out, and a trend of the runs for a drift.

use nalgebra::DVector;

use numerics::distributions::{f_test_p_value, student_t_beyond};

use super::fit::{Fit, whole};
use super::selection::Search;
use super::variant::{Drift, Mean, Variant};
use super::wave;

/// Greatest probability of a step by chance, F test. A step is the best of a dozen.
const MAX_CHANCE: f64 = 1e-4;

/// The greatest probability where runs left out are predicted so much better that both together are no chance.
const MAX_CHANCE_OF_LARGE: f64 = 1e-2;

/// Reduction of the mean square of runs left out that counts as large.
const LARGE_REDUCTION: f64 = 0.2;

/// Greatest probability of a trend of the runs by chance.
const MAX_TREND_CHANCE: f64 = 0.05;

impl Search<'_> {
    /// Whether a drift that is new follows the clock more than runs differ from each other by chance. Their offsets, and their slopes of a
    /// straight line, are what tells: the readings of one run are no independent witnesses.
    pub(crate) fn is_trend(&self, before: &Fit, after: &Fit) -> bool {
        let new = after.variant.drift;
        if new == before.variant.drift {
            return true;
        }
        if new == Drift::Map {
            // Beside offset and slope of the runs, which are no sign of it.
            let line = self.fit(&Variant { drift: Drift::Line, ..after.variant.clone() });
            return line.is_some_and(|line| self.is_supported(&line, after));
        }
        let lines = if new == Drift::Line { 2 } else { 1 };
        let chance = MAX_TREND_CHANCE / f64::from(lines);
        let without = Variant { drift: Drift::None, ..after.variant.clone() };
        let Some(fit) = self.fit(&without) else { return false };
        (0..lines).any(|line| self.trend_exceeds(&fit, line == 1, chance))
    }

    /// Whether the offsets of the runs, or their slopes, follow the course, tested by Student's t.
    fn trend_exceeds(&self, fit: &Fit, is_slope: bool, chance: f64) -> bool {
        let weight = |index: usize| {
            if is_slope { self.samples.places[index].position_mm - self.grid.middle_mm() } else { 1.0 }
        };
        let of_run = |run: &usize| {
            let indices: Vec<usize> =
                (0..self.samples.runs.len()).filter(|&index| self.samples.runs[index] == *run).collect();
            let squares: f64 = indices.iter().map(|&index| weight(index).powi(2)).sum();
            let product: f64 = indices.iter().map(|&index| weight(index) * fit.residuals_um[index]).sum();
            let course =
                indices.iter().map(|&index| self.grid.drift_factor(self.samples.places[index].instant));
            (numerics::mean(course), product / squares.max(f64::MIN_POSITIVE))
        };
        let (courses, values): (Vec<f64>, Vec<f64>) = self.runs.iter().map(of_run).unzip();
        let centred = |values: &[f64]| {
            let mean = numerics::mean(values.iter().copied());
            DVector::from_iterator(values.len(), values.iter().map(|value| value - mean))
        };
        let (x, y) = (centred(&courses), centred(&values));
        let slope = x.dot(&y) / x.norm_squared();
        let left = self.runs.len() - 2;
        let error = ((&y - slope * &x).norm_squared() / left as f64 / x.norm_squared()).sqrt();
        slope.abs() > student_t_beyond(chance, left) * error
    }

    /// Whether a larger form explains more than chance does.
    pub(crate) fn is_supported(&self, before: &Fit, after: &Fit) -> bool {
        let chance = self.chance(before, after);
        // The period of a wave is searched in all runs, so that a run left out is not quite new to it.
        let is_wave = matches!(after.variant.mean, Mean::Waves(_));
        let is_large = || {
            let both = self.left_out(&after.variant).zip(self.left_out(&before.variant));
            both.is_some_and(|(after, before)| after < (1.0 - LARGE_REDUCTION) * before)
        };
        chance < MAX_CHANCE || !is_wave && chance < MAX_CHANCE_OF_LARGE && is_large()
    }

    /// Probability that chance explains as much as a larger form does, by an F test. A wave is the best of all that the targets can tell.
    fn chance(&self, before: &Fit, after: &Fit) -> f64 {
        let more = before.freedom - after.freedom;
        let reduction = before.squares() - after.squares();
        if after.freedom < 1.0 || more <= 0.0 || reduction <= 0.0 {
            return 1.0;
        }
        let is_new_wave =
            matches!(after.variant.mean, Mean::Waves(_)) && after.variant.mean != before.variant.mean;
        let tries = if is_new_wave { wave::lines(self.grid).max(1.0) } else { 1.0 };
        let left = after.squares() / after.freedom;
        if left <= 0.0 {
            return 0.0;
        }
        tries * f_test_p_value(reduction / more / left, whole(more), whole(after.freedom))
    }
}
