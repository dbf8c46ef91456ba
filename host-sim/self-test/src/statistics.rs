//! Confidence interval of a proportion, and quantiles.

/// 97.5 % point of the normal distribution.
const Z_975: f64 = 1.96;

/// 95 % confidence interval of a probability after `hits` in `trials` (E. B. Wilson, *J. Am. Stat. Assoc.* 22, 1927);
/// 0 to 1 without a trial.
#[must_use]
pub fn wilson(hits: usize, trials: usize) -> [f64; 2] {
    if trials == 0 {
        return [0.0, 1.0];
    }
    let n = trials as f64;
    let p = hits as f64 / n;
    let z2 = Z_975 * Z_975;
    let middle = p + z2 / (2.0 * n);
    let half = Z_975 * (p * (1.0 - p) / n + z2 / (4.0 * n * n)).sqrt();
    [((middle - half) / (1.0 + z2 / n)).max(0.0), ((middle + half) / (1.0 + z2 / n)).min(1.0)]
}

/// The smallest of the values that at least a fraction (0 to 1) of them does not exceed; NaN without values.
#[must_use]
pub fn quantile(values: &[f64], fraction: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of values")]
    let rank = (fraction * sorted.len() as f64).ceil().max(1.0) as usize;
    sorted.get(rank - 1).or(sorted.last()).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_is_wilsons() {
        // His formula by hand at 9 of 10: (0.9 + 0.19208 ± 1.96·√(0.009 + 0.009604)) / 1.38416.
        let [low, high] = wilson(9, 10);
        assert!((low - (1.09208 - 0.267_337) / 1.38416).abs() < 1e-5, "{low}");
        assert!((high - (1.09208 + 0.267_337) / 1.38416).abs() < 1e-5, "{high}");
        assert_eq!(wilson(0, 0).map(f64::to_bits), [0.0_f64, 1.0].map(f64::to_bits));
        // All of n: z²/(n + z²) are left below.
        let [low, high] = wilson(20, 20);
        assert!((low - 20.0 / (20.0 + 1.96 * 1.96)).abs() < 1e-12, "{low}");
        assert!((high - 1.0).abs() < 1e-12, "{high}");
    }

    #[test]
    fn quantiles_are_values_that_were_seen() {
        let values = [4.0, 1.0, 3.0, 2.0];
        let found = [0.0, 0.5, 0.51, 0.95, 1.0].map(|fraction| quantile(&values, fraction).to_bits());
        assert_eq!(found, [1.0_f64, 2.0, 3.0, 4.0, 4.0].map(f64::to_bits));
        assert!(quantile(&[], 0.5).is_nan());
    }
}
