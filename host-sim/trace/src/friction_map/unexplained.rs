//! What stays of a map, and what it follows.

use super::FrictionMap;
use super::fit::Law;

/// What stays above the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unexplained {
    /// Root mean square over the runs.
    pub rms: f64,
    /// Share of its square that goes with the variable.
    pub share_percent: f64,
    /// `velocity`: runs at neighbouring speeds are off alike; `time`: runs that follow each other in the file
    /// are; `none`.
    pub variable: &'static str,
}

/// A residual within this of its noise is noise.
const ABOVE_NOISE: f64 = 1.15;

/// What a law leaves of a map; `None` where that is no more than the error of the means. Without a known error
/// of the means all that stays is told.
#[must_use]
pub fn unexplained(map: &FrictionMap, law: &Law) -> Option<Unexplained> {
    let left: Vec<f64> = map.runs.iter().map(|run| run.force - law.force(run.velocity)).collect();
    let n = left.len() as f64;
    let rms = (left.iter().map(|r| r * r).sum::<f64>() / n).sqrt();
    if map.noise().is_some_and(|noise| rms < ABOVE_NOISE * noise) {
        return None;
    }
    let mut in_time = vec![0.0; left.len()];
    for (place, residual) in map.order.iter().zip(&left) {
        in_time[*place] = *residual;
    }
    // The correlation of neighbours is the share of what changes slowly along the row.
    let by_velocity = neighbours(&left);
    let by_time = if map.order.is_sorted() { 0.0 } else { neighbours(&in_time) };
    // By chance it lies within 2/√n of nothing.
    let beyond_chance = |share: f64| share > 2.0 / n.sqrt();
    let (variable, share) = match (by_velocity, by_time) {
        (v, t) if beyond_chance(v) && v >= t => ("velocity", v),
        (_, t) if beyond_chance(t) => ("time", t),
        (v, t) => ("none", v.max(t)),
    };
    Some(Unexplained { rms, share_percent: 100.0 * share.max(0.0), variable })
}

fn neighbours(left: &[f64]) -> f64 {
    let squares: f64 = left.iter().map(|r| r * r).sum();
    left.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / squares.max(f64::MIN_POSITIVE)
}
