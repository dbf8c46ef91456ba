//! The distributions that a test and an interval need.

/// Logarithm of the gamma function, Lanczos' approximation with g = 7 (relative error below 1e-13).
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
    0.5 * std::f64::consts::TAU.ln() + (x + 0.5) * t.ln() - t + sum.ln()
}

/// Regularised incomplete beta function, by the continued fraction (Abramowitz and Stegun 26.5.8).
fn beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    // The fraction converges fast below this; above, the other tail is computed.
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - beta(b, a, 1.0 - x);
    }
    let front = (ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (1.0 - x).ln()).exp() / a;
    let kept = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let (mut c, mut d) = (1.0, 1.0 / kept(1.0 - (a + b) * x / (a + 1.0)));
    let mut fraction = d;
    for m in (1..300u32).map(f64::from) {
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut change = 1.0;
        for term in [even, odd] {
            d = 1.0 / kept(1.0 + term * d);
            c = kept(1.0 + term / c);
            change = c * d;
            fraction *= change;
        }
        if (change - 1.0).abs() < 1e-14 {
            break;
        }
    }
    front * fraction
}

/// Chance that a variance ratio with `k` over `n` degrees of freedom exceeds `f`.
#[must_use]
pub fn chance_of_ratio(f: f64, k: usize, n: usize) -> f64 {
    let (k, n) = (k as f64, n as f64);
    if f <= 0.0 { 1.0 } else { beta(0.5 * n, 0.5 * k, n / (n + k * f)) }
}

/// 97.5 % point of Student's t at `n` degrees of freedom.
#[must_use]
pub fn t_975(n: usize) -> f64 {
    let n = n.max(1);
    let (mut low, mut high) = (1.9, 13.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        // t² is a variance ratio of 1 over n; both tails together hold 5 %.
        if chance_of_ratio(middle * middle, 1, n) > 0.05 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published tables: Student's t, and Fisher's F at 1 %.
    #[test]
    fn agrees_with_printed_tables() {
        for (n, t) in [(1, 12.706), (5, 2.571), (10, 2.228), (27, 2.052), (120, 1.980)] {
            assert!((t_975(n) - t).abs() < 6e-4, "{n}: {}", t_975(n));
        }
        for (k, n, f) in [(1, 10, 10.04), (2, 26, 5.53), (2, 5, 13.27), (3, 60, 4.13)] {
            assert!((chance_of_ratio(f, k, n) - 0.01).abs() < 5e-5, "{k} {n}");
        }
        assert!((chance_of_ratio(0.0, 2, 9) - 1.0).abs() < 1e-12);
    }
}
