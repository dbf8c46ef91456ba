//! Mean, root mean square, standard deviation, median, quantile.

/// Arithmetic mean; zero if there is no value.
#[must_use]
pub fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut count = 0_usize;
    let sum: f64 = values.into_iter().inspect(|_| count += 1).sum();
    sum / count.max(1) as f64
}

/// Root mean square; 0 if there is no value.
#[must_use]
pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    mean(values.into_iter().map(|value| value * value)).abs().sqrt()
}

/// Σ(a − b)² over the values that both have.
#[must_use]
pub fn squares_of_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

/// Reduction of a root mean square, percent, if its square decreases by a fraction (at most 1); negative if it increases.
#[must_use]
pub fn rms_reduction_percent(fraction: f64) -> f64 {
    100.0 * (1.0 - (1.0 - fraction).max(0.0).sqrt())
}

/// Mean, and standard deviation about it with divisor n (not n − 1); both zero if there is no value.
#[must_use]
pub fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let mean = mean(values.iter().copied());
    (mean, rms(values.iter().map(|value| value - mean)))
}

/// The median; for an even count, the larger of the two middle values. `None` if there is no value.
#[must_use]
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    let middle = sorted.len() / 2;
    (middle < sorted.len()).then(|| *sorted.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The quantile by nearest rank: the smallest value that is not exceeded by at least a fraction (0 to 1) of the values; NaN
/// if there is no value.
#[must_use]
pub fn quantile(values: &[f64], fraction: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a rank, 1 to n")]
    let rank = (fraction * sorted.len() as f64).ceil().max(1.0) as usize;
    sorted.get(rank - 1).or(sorted.last()).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn averages_are_those_computed_by_hand() {
        // Mean of 1, 2, 6 is 3; squares 1 + 4 + 36 = 41; deviations −2, −1, 3: 14.
        let values = [1.0, 2.0, 6.0];
        assert!((mean(values) - 3.0).abs() < 1e-15);
        assert!((rms(values) - (41.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        let (mean, deviation) = mean_and_deviation(&values);
        assert!((mean - 3.0).abs() < 1e-15 && (deviation - (14.0_f64 / 3.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_square_reduced_by_75_percent_reduces_the_root_by_50_percent() {
        assert!((rms_reduction_percent(0.75) - 50.0).abs() < 1e-12);
        assert!((rms_reduction_percent(-3.0) + 100.0).abs() < 1e-12);
    }

    #[test]
    fn averages_of_nothing_are_zero() {
        assert!(mean([]).abs() < f64::MIN_POSITIVE);
        assert_eq!(rms([]).to_bits(), 0.0_f64.to_bits());
    }

    #[test]
    fn the_median_is_the_upper_of_two_middle_values() {
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]).map(f64::to_bits), Some(3.0_f64.to_bits()));
        assert_eq!(median(&[5.0, -1.0, 3.0]).map(f64::to_bits), Some(3.0_f64.to_bits()));
        assert_eq!(median(&[]), None);
    }

    #[test]
    fn quantiles_are_values_of_the_sample() {
        let values = [4.0, 1.0, 3.0, 2.0];
        let found = [0.0, 0.5, 0.51, 0.95, 1.0].map(|fraction| quantile(&values, fraction).to_bits());
        assert_eq!(found, [1.0_f64, 2.0, 3.0, 4.0, 4.0].map(f64::to_bits));
        assert!(quantile(&[], 0.5).is_nan());
    }
}
