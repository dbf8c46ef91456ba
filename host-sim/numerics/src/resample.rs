//! A sampled signal at other instants.

/// Values delayed by `late_s` (negative: advanced), interpolated by the cubic through the four nearest samples.
#[must_use]
pub fn delayed_cubic(values: Vec<f64>, late_s: f64, sample_s: f64) -> Vec<f64> {
    if late_s == 0.0 || values.len() < 4 {
        return values;
    }
    let n = values.len().cast_signed();
    let late = late_s / sample_s;
    let at = |start: isize, weights: [f64; 4]| -> f64 {
        let around = &values[(start - 1).cast_unsigned()..][..4];
        around.iter().zip(weights).map(|(value, weight)| weight * value).sum()
    };
    // Away from the ends all values have the same weights.
    #[expect(clippy::cast_possible_truncation, reason = "within the values")]
    let whole = late.ceil().clamp(-(n as f64), n as f64) as isize;
    let weights = lagrange(whole as f64 - late);
    let inner = whole + 1..n - 2 + whole;
    let at_end = |i: isize| {
        let time = (i as f64 - late).clamp(0.0, (n - 1) as f64);
        #[expect(clippy::cast_possible_truncation, reason = "a sample's number")]
        let start = (time as isize).clamp(1, n - 3);
        at(start, lagrange(time - start as f64))
    };
    (0..n).map(|i| if inner.contains(&i) { at(i - whole, weights) } else { at_end(i) }).collect()
}

/// Values delayed by `age` samples (negative: advanced), interpolated linearly; before the first and after the last
/// sample they are constant.
#[must_use]
pub fn delayed_linear(values: &[f64], age: f64) -> Vec<f64> {
    let n = values.len();
    let fraction = age - age.floor();
    #[expect(clippy::cast_possible_truncation, reason = "within the values")]
    let whole = age.floor().clamp(-(n as f64), n as f64) as isize;
    let mix = |newer: f64, older: f64| (1.0 - fraction) * newer + fraction * older;
    let at = |i: isize| values[i.clamp(0, n.cast_signed() - 1).cast_unsigned()];
    (0..n.cast_signed()).map(|i| mix(at(i - whole), at(i - whole - 1))).collect()
}

/// Values from the first to the last one, `step` samples apart, interpolated by the cubic through the four nearest samples. There is none
/// of less than four values.
#[must_use]
pub fn spaced_cubic(values: &[f64], step: f64) -> Vec<f64> {
    let n = values.len();
    if n < 4 {
        return Vec::new();
    }
    let last = (n - 1) as f64;
    // A last value that lies beyond by rounding is not lost.
    let times = (0..).map(|i| f64::from(i) * step).take_while(|time| *time < last + 1e-6);
    let at = |time: f64| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a sample's number")]
        let start = (time as usize).clamp(1, n - 3);
        let around = &values[start - 1..start + 3];
        around.iter().zip(lagrange(time - start as f64)).map(|(value, weight)| weight * value).sum()
    };
    times.map(at).collect()
}

/// Weights of the values at −1, 0, 1, 2 in the interpolating cubic at t (Lagrange).
fn lagrange(t: f64) -> [f64; 4] {
    let (before, after, far) = (t + 1.0, t - 1.0, t - 2.0);
    [-t * after * far / 6.0, 0.5 * before * after * far, -0.5 * before * t * far, before * t * after / 6.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the first value to the last one, and the values themselves where a step is whole.
    #[test]
    fn a_cubic_is_sampled_exactly_at_any_rate() {
        let f = |t: f64| 2.0 - 0.3 * t + 0.01 * t * t - 1e-4 * t * t * t;
        let values: Vec<f64> = (0..50).map(|i| f(f64::from(i))).collect();
        for (step, count) in [(0.25, 197), (1.3, 38), (0.7, 71), (1.0, 50)] {
            let spaced = spaced_cubic(&values, step);
            assert_eq!(spaced.len(), count, "{step}");
            for (i, value) in spaced.iter().enumerate() {
                assert!((value - f(i as f64 * step)).abs() < 1e-9, "{step} {i}");
            }
        }
        assert!(spaced_cubic(&values[..3], 0.5).is_empty());
    }

    #[test]
    fn a_cubic_is_delayed_exactly() {
        let f = |t: f64| 2.0 - 0.3 * t + 0.01 * t * t - 1e-4 * t * t * t;
        let values: Vec<f64> = (0..50).map(|i| f(f64::from(i))).collect();
        for late in [1.7, 0.4, -2.2] {
            let delayed = delayed_cubic(values.clone(), late * 1e-3, 1e-3);
            for (i, value) in delayed.iter().enumerate().skip(4).take(40) {
                assert!((value - f(i as f64 - late)).abs() < 1e-9, "{late} {i}");
            }
        }
    }
}
