//! Dependence of the residual of a law on velocity and time.

use super::law::Law;
use super::map::FrictionMap;

/// A residual that exceeds the standard error of the means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Root mean square over the runs, in the unit of the map.
    pub rms: f64,
    /// Fraction of the mean square that varies slowly along the variable, percent.
    pub slow_percent: f64,
    /// `velocity`: runs at neighbouring velocities have similar residuals; `time`: consecutive runs of the file have
    /// similar residuals; `none`: neither.
    pub variable: &'static str,
}

/// A residual below this multiple of the standard error of the means counts as noise.
const NOISE_FACTOR: f64 = 1.15;

/// Analyses the residual of a law; `None` if it is within the standard error of the means. Without standard errors, the
/// result is never `None`.
#[must_use]
pub fn analyse(map: &FrictionMap, law: &Law) -> Option<Residual> {
    let residuals: Vec<f64> = map.runs.iter().map(|run| run.force - law.force(run.velocity)).collect();
    let n = residuals.len() as f64;
    let rms = numerics::rms(residuals.iter().copied());
    if map.standard_error().is_some_and(|error| rms < NOISE_FACTOR * error) {
        return None;
    }
    let mut in_file_order = vec![0.0; residuals.len()];
    for (row, residual) in map.file_order.iter().zip(&residuals) {
        in_file_order[*row] = *residual;
    }
    let by_velocity = neighbour_correlation(&residuals);
    let by_time = if map.file_order.is_sorted() { 0.0 } else { neighbour_correlation(&in_file_order) };
    // The correlation of neighbours of white noise has a standard deviation of 1/√n.
    let is_significant = |correlation: f64| correlation > 2.0 / n.sqrt();
    let (variable, correlation) = match (by_velocity, by_time) {
        (v, t) if is_significant(v) && v >= t => ("velocity", v),
        (_, t) if is_significant(t) => ("time", t),
        (v, t) => ("none", v.max(t)),
    };
    Some(Residual { rms, slow_percent: 100.0 * correlation.max(0.0), variable })
}

/// Correlation of neighbouring values: the fraction of Σr² that varies slowly along the sequence.
fn neighbour_correlation(values: &[f64]) -> f64 {
    let squares: f64 = values.iter().map(|value| value * value).sum();
    values.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / squares.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Run, Unit};

    /// The analysis of 16 runs, given by row of the file. The law is zero, so that the forces are the residuals.
    fn analysed(force: impl Fn(usize) -> f64, velocity: impl Fn(usize) -> f64) -> Residual {
        let run =
            |row: usize| Run { velocity: velocity(row), force: force(row), deviation: None, error: None };
        let map = FrictionMap::new("m.csv", Unit::Linear, (0..16).map(run).collect()).unwrap();
        analyse(&map, &Law::declared(16.0)).unwrap()
    }

    #[test]
    fn a_slow_residual_is_found_over_its_variable() {
        let slow = |i: usize| (i as f64 / 3.0).sin();
        let by_velocity = analysed(slow, |row| 1.0 + row as f64);
        assert_eq!(by_velocity.variable, "velocity");
        assert!(by_velocity.slow_percent > 80.0, "{by_velocity:?}");
        // Multiples of 7 modulo 17 are a permutation of the velocities.
        let by_time = analysed(slow, |row| ((row + 1) * 7 % 17) as f64);
        assert_eq!(by_time.variable, "time");
        let alternating = analysed(|i| if i % 2 == 0 { 1.0 } else { -1.0 }, |row| 1.0 + row as f64);
        assert_eq!((alternating.variable, alternating.slow_percent.to_bits()), ("none", 0.0_f64.to_bits()));
    }
}
