//! The EWMA control chart, with limits for a rate of false alarms.
//!
//! The exponentially weighted moving average of the scores is zᵢ = (1 − λ)·zᵢ₋₁ + λ·xᵢ from z₀ = 0 (S. W. Roberts, *Technometrics* 1,
//! 1959); it alarms beyond ±L·√(λ/(2 − λ)). The mean number of scores until a false alarm obeys an integral equation (S. V. Crowder,
//! *Technometrics* 29, 1987), from which L follows.

use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Weight of the newest score: a growth by half a standard deviation a trace is seen soonest by weights near this.
pub const WEIGHT: f64 = 0.2;

/// Traces of a steady machine until a false alarm, on average: as often as a single value beyond three standard deviations.
pub const TRACES_TO_FALSE_ALARM: f64 = 370.0;

/// Points at which the integral equation is solved.
const POINTS: usize = 121;

/// A chart of one series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chart {
    /// The average beyond which it alarms.
    pub limit: f64,
    average: f64,
}

impl Chart {
    /// A chart with a false alarm once in this many scores.
    #[must_use]
    pub fn with_run_length(scores: f64) -> Self {
        let (mut low, mut high) = (0.1, 8.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if run_length(WEIGHT, limit(WEIGHT, middle)) < scores { low = middle } else { high = middle }
        }
        Self { limit: limit(WEIGHT, high), average: 0.0 }
    }

    /// The chart with an empty average.
    #[must_use]
    pub const fn restarted(self) -> Self {
        Self { average: 0.0, ..self }
    }

    /// Takes a score; true if the average is beyond the limit.
    pub fn alarms(&mut self, score: f64) -> bool {
        self.average += WEIGHT * (score - self.average);
        self.average.abs() > self.limit
    }
}

/// The limit that is L standard deviations of the average from zero.
fn limit(weight: f64, deviations: f64) -> f64 {
    deviations * (weight / (2.0 - weight)).sqrt()
}

/// Mean number of standard normal scores until an average that starts at zero is beyond ±`limit`, by the midpoint rule.
fn run_length(weight: f64, limit: f64) -> f64 {
    let step = 2.0 * limit / POINTS as f64;
    let at = |index: usize| (index as f64 + 0.5) * step - limit;
    let density = |x: f64| libm::exp(-0.5 * x * x) / (2.0 * PI).sqrt();
    let kernel = DMatrix::from_fn(POINTS, POINTS, |from, to| {
        density((at(to) - (1.0 - weight) * at(from)) / weight) * step / weight
    });
    let lengths =
        (DMatrix::identity(POINTS, POINTS) - kernel).lu().solve(&DVector::from_element(POINTS, 1.0));
    // The middle one is at zero.
    lengths.map_or(f64::INFINITY, |lengths| lengths[POINTS / 2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::noise::box_muller;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    /// J. M. Lucas and M. S. Saccucci, *Technometrics* 32, 1990, table 3: pairs of λ and L with a run length of 500.
    #[test]
    fn run_lengths_are_the_published_ones() {
        for (weight, deviations) in [(0.1, 2.814), (0.2, 2.962), (0.25, 2.998), (0.4, 3.054)] {
            let length = run_length(weight, limit(weight, deviations));
            assert!((length / 500.0 - 1.0).abs() < 5e-3, "{weight} {deviations}: {length}");
        }
    }

    /// Scores drawn at random: 500 runs to an alarm have a mean with a standard error of 4.5 %, as run lengths are nearly exponential.
    #[test]
    fn a_steady_series_alarms_once_in_its_run_length() {
        let chart = Chart::with_run_length(TRACES_TO_FALSE_ALARM);
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let runs = 500;
        let total: usize = (0..runs)
            .map(|_| {
                let mut chart = chart.restarted();
                let mut scores = 1;
                while !chart.alarms(box_muller(&mut rng)) {
                    scores += 1;
                }
                scores
            })
            .sum();
        let mean = total as f64 / f64::from(runs);
        assert!((mean / TRACES_TO_FALSE_ALARM - 1.0).abs() < 0.18, "{mean}");
    }
}
