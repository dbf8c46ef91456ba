//! Standard normal deviates: mean 0, variance 1.
//!
//! There are two generators: one for the plant, and one for the independent second simulator of the self-test. Neither may be
//! replaced, as the sequence of a seed would change.

use std::f64::consts::TAU;

use rand::RngExt;

/// An approximately normal deviate: the sum of twelve uniform deviates less 6 (Irwin and Hall), within ±6. It takes twelve
/// draws and is bit-identical on every host, as it uses no logarithm or cosine of the host's library.
#[must_use]
pub fn sum_of_uniforms(random: &mut impl RngExt) -> f64 {
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

/// A normal deviate √(−2·ln u)·cos(2π·v) from two uniform deviates (G. E. P. Box, M. E. Muller, *Ann. Math. Stat.* 29,
/// 1958). It takes two draws.
#[must_use]
pub fn box_muller(random: &mut impl RngExt) -> f64 {
    // 1 − u is in (0, 1], so that the logarithm of 0 does not occur.
    let [u, v] = [1.0 - random.random::<f64>(), random.random::<f64>()];
    (-2.0 * libm::log(u)).sqrt() * libm::cos(TAU * v)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::mean_and_deviation;

    /// The standard errors over n draws are 1/√n for the mean and 1/√(2n) for the deviation; the tolerance is five standard
    /// errors.
    #[test]
    fn mean_is_zero_and_variance_one() {
        let n = 100_000;
        for draw in [sum_of_uniforms, box_muller] {
            let mut random = ChaCha8Rng::seed_from_u64(1);
            let values: Vec<f64> = (0..n).map(|_| draw(&mut random)).collect();
            let (mean, deviation) = mean_and_deviation(&values);
            assert!(mean.abs() < 5.0 / f64::from(n).sqrt(), "{mean}");
            assert!((deviation - 1.0).abs() < 5.0 / f64::from(2 * n).sqrt(), "{deviation}");
        }
    }
}
