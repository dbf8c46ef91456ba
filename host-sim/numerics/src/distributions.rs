//! Tail probability of Fisher's F, quantile of Student's t, confidence interval of a probability.

/// 97.5 % quantile of the standard normal distribution.
const Z_975: f64 = 1.96;

/// Largest magnitude of Student's t that is computed.
const MAX_T: f64 = 1e9;

/// Logarithm of the gamma function for x > 0: Lanczos' approximation with g = 7, relative error below 1e-13.
fn ln_gamma(x: f64) -> f64 {
    const C: [f64; 8] = [
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let x = x - 1.0;
    let sum = C.iter().zip(1u32..).fold(0.999_999_999_999_809_9, |sum, (c, i)| sum + c / (x + f64::from(i)));
    let t = x + 7.5;
    0.5 * libm::log(std::f64::consts::TAU) + (x + 0.5) * libm::log(t) - t + libm::log(sum)
}

/// Regularised incomplete beta function Iₓ(a, b): continued fraction of Abramowitz and Stegun 26.5.8, evaluated by the
/// modified Lentz method.
fn beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    // The fraction converges fast only below this x. Above it, Iₓ(a, b) = 1 − I₁₋ₓ(b, a) is used.
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - beta(b, a, 1.0 - x);
    }
    let front =
        libm::exp(ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * libm::log(x) + b * libm::log(1.0 - x))
            / a;
    let nonzero = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let (mut c, mut d) = (1.0, 1.0 / nonzero(1.0 - (a + b) * x / (a + 1.0)));
    let mut fraction = d;
    for m in (1..300u32).map(f64::from) {
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut change = 1.0;
        for term in [even, odd] {
            d = 1.0 / nonzero(1.0 + term * d);
            c = nonzero(1.0 + term / c);
            change = c * d;
            fraction *= change;
        }
        if (change - 1.0).abs() < 1e-14 {
            break;
        }
    }
    front * fraction
}

/// p value of an F test: the probability that a ratio of variances with `k` and `n` degrees of freedom exceeds `f`.
#[must_use]
pub fn f_test_p_value(f: f64, k: usize, n: usize) -> f64 {
    let (k, n) = (k as f64, n as f64);
    if f <= 0.0 { 1.0 } else { beta(0.5 * n, 0.5 * k, n / (n + k * f)) }
}

/// 97.5 % quantile of Student's t with `n` degrees of freedom (at least 1): half width of a two-sided 95 % interval, in
/// standard errors.
#[must_use]
pub fn student_t_975(n: usize) -> f64 {
    student_t_beyond(0.05, n)
}

/// The magnitude that Student's t with `n` degrees of freedom (at least 1) exceeds with this probability, both tails together.
#[must_use]
pub fn student_t_beyond(probability: f64, n: usize) -> f64 {
    let n = n.max(1);
    // t² is F distributed with 1 and n degrees of freedom.
    let is_below = |t: f64| f_test_p_value(t * t, 1, n) > probability;
    let mut high = 1.0;
    while is_below(high) && high < MAX_T {
        high *= 2.0;
    }
    let mut low = 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if is_below(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// 95 % confidence interval of a probability after `hits` in `trials` (E. B. Wilson, *J. Am. Stat. Assoc.* 22, 1927);
/// `[0, 1]` without a trial.
#[must_use]
pub fn wilson_interval(hits: usize, trials: usize) -> [f64; 2] {
    if trials == 0 {
        return [0.0, 1.0];
    }
    let n = trials as f64;
    let fraction = hits as f64 / n;
    let z2 = Z_975 * Z_975;
    let middle = fraction + z2 / (2.0 * n);
    let half = Z_975 * (fraction * (1.0 - fraction) / n + z2 / (4.0 * n * n)).sqrt();
    [((middle - half) / (1.0 + z2 / n)).max(0.0), ((middle + half) / (1.0 + z2 / n)).min(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published tables: Student's t, and Fisher's F at 1 %.
    #[test]
    fn distributions_agree_with_printed_tables() {
        for (n, t) in [(1, 12.706), (5, 2.571), (10, 2.228), (27, 2.052), (120, 1.980)] {
            assert!((student_t_975(n) - t).abs() < 6e-4, "{n}: {}", student_t_975(n));
        }
        // With one degree of freedom, t is Cauchy distributed: tan(½π·(1 − p)); 0.1 % with 23 degrees of freedom: 3.768.
        let cauchy = (0.5 * std::f64::consts::PI * (1.0 - 0.002)).tan();
        assert!((student_t_beyond(0.002, 1) / cauchy - 1.0).abs() < 1e-6);
        assert!((student_t_beyond(0.001, 23) - 3.768).abs() < 6e-4);
        for (k, n, f) in [(1, 10, 10.04), (2, 26, 5.53), (2, 5, 13.27), (3, 60, 4.13)] {
            assert!((f_test_p_value(f, k, n) - 0.01).abs() < 5e-5, "{k} {n}");
        }
        assert!((f_test_p_value(0.0, 2, 9) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_interval_is_that_of_wilson() {
        // By hand for 9 of 10: (0.9 + 0.19208 ± 1.96·√(0.009 + 0.009604)) / 1.38416.
        let [low, high] = wilson_interval(9, 10);
        assert!((low - (1.09208 - 0.267_337) / 1.38416).abs() < 1e-5, "{low}");
        assert!((high - (1.09208 + 0.267_337) / 1.38416).abs() < 1e-5, "{high}");
        assert_eq!(wilson_interval(0, 0).map(f64::to_bits), [0.0_f64, 1.0].map(f64::to_bits));
        // For n of n, the lower end is n/(n + z²).
        let [low, high] = wilson_interval(20, 20);
        assert!((low - 20.0 / (20.0 + 1.96 * 1.96)).abs() < 1e-12, "{low}");
        assert!((high - 1.0).abs() < 1e-12, "{high}");
    }
}
