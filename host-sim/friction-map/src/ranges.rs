//! Errors on contiguous ranges of speed that were left out of the fit. They show how well a law interpolates and
//! extrapolates.

use super::fit::{fit, weights};
use super::law::Law;
use super::map::{FrictionMap, Run};

/// Maximum number of ranges in each direction.
const MAX_RANGES: usize = 5;

/// Minimum number of runs in a range.
const MIN_RUNS: usize = 2;

/// Index of the range of each run, for runs sorted by velocity. A range contains runs of one direction only.
#[must_use]
pub fn ranges(runs: &[Run]) -> Vec<usize> {
    let backward = runs.iter().filter(|run| run.velocity < 0.0).count();
    let mut numbers = Vec::with_capacity(runs.len());
    let mut next = 0;
    for count in [backward, runs.len() - backward] {
        if count == 0 {
            continue;
        }
        let parts = (count / MIN_RUNS).clamp(1, MAX_RANGES);
        numbers.extend((0..count).map(|i| next + i * parts / count));
        next += parts;
    }
    numbers
}

/// Sum over all ranges of the squared weighted errors of a law that was refitted without the range; infinite if the
/// remaining runs do not determine the law.
#[must_use]
pub fn left_out_squares(map: &FrictionMap, runs: &[Run], law: &Law) -> f64 {
    let numbers = ranges(runs);
    let weights = weights(runs);
    let count = numbers.last().map_or(0, |last| last + 1);
    let of_range = |range: usize| {
        let seen: Vec<Run> =
            runs.iter().zip(&numbers).filter(|(_, n)| **n != range).map(|(run, _)| *run).collect();
        let Some(fitted) = fit(map, &seen, law) else { return f64::INFINITY };
        let out = runs.iter().zip(&weights).zip(&numbers).filter(|(_, n)| **n == range);
        out.map(|((run, weight), _)| (weight * (run.force - fitted.law.force(run.velocity))).powi(2)).sum()
    };
    (0..count).map(of_range).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_direction_has_ranges_of_two_runs_or_more() {
        let run = |velocity: f64| Run { velocity, force: 0.0, deviation: None, error: None };
        let runs: Vec<Run> = [-3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 4.0].map(run).to_vec();
        assert_eq!(ranges(&runs), [0, 0, 0, 1, 1, 2, 2]);
        let one_way: Vec<Run> = (1..=20).map(|v| run(f64::from(v))).collect();
        assert_eq!(ranges(&one_way).last(), Some(&(MAX_RANGES - 1)));
    }
}
