//! Acceleration of a noisy channel for effects that are proportional to it.
//!
//! The tool is predicted from the readings of the scale, r = x + n: tool − r = c·a(r) − n + …. The noise of the second difference of a
//! filtered value is opposed to that of the value itself: a fit finds a coefficient c > 0 on an axis that has none, and too
//! small a coefficient on one that has (errors in variables). The filter here is wider, until its noise is small beside the
//! acceleration, and its noise is uncorrelated with that of the filtered value.

use nalgebra::{Matrix3, Vector3};

/// Largest share of noise in the mean square of an acceleration. A coefficient is attenuated by this share.
const MAX_NOISE_SHARE: f64 = 0.003;

/// Greatest half width, in multiples of that of the filter of the value.
const MAX_WIDENING: usize = 8;

/// Acceleration by a wider filter than that of the value.
#[derive(Clone, Debug)]
pub struct QuietAcceleration {
    /// Half width of the filter's window, samples.
    half_window: usize,
    /// Per s².
    pub values: Vec<f64>,
}

impl QuietAcceleration {
    /// The narrowest filter whose noise is small beside the acceleration, or the widest; `None` if the noise of `narrow`, the
    /// acceleration of the filtered value, is small itself. `value_weights` are those of the filter of the value, `noise` is the standard
    /// deviation of `raw`, `narrow_noise` that of `narrow`.
    #[must_use]
    pub fn of(
        raw: &[f64],
        value_weights: &[f64],
        sample_s: f64,
        noise: f64,
        (narrow, narrow_noise): (&[f64], f64),
    ) -> Option<Self> {
        if is_quiet(narrow, narrow_noise) {
            return None;
        }
        let half_window = value_weights.len() / 2;
        let widest = (MAX_WIDENING * half_window).min(raw.len().saturating_sub(1) / 2);
        let mut quiet = None;
        let mut half = half_window + half_window.div_ceil(2);
        while half <= widest {
            let filter = Filter::new(half, value_weights);
            let values = filter.filtered(raw, sample_s, narrow);
            let is_enough = is_quiet(&values, noise * filter.norm() / (sample_s * sample_s));
            quiet = Some(Self { half_window: half, values });
            if is_enough {
                break;
            }
            half += half.div_ceil(4);
        }
        quiet
    }

    /// √Σw² of its weights, per sample².
    #[must_use]
    pub fn norm(&self, value_weights: &[f64]) -> f64 {
        Filter::new(self.half_window, value_weights).norm()
    }

    /// The acceleration of other values by the same filter; `narrow` is their acceleration by the filter of the value.
    #[must_use]
    pub fn of_other(&self, raw: &[f64], value_weights: &[f64], sample_s: f64, narrow: &[f64]) -> Self {
        let values = Filter::new(self.half_window, value_weights).filtered(raw, sample_s, narrow);
        Self { half_window: self.half_window, values }
    }
}

fn is_quiet(acceleration: &[f64], noise: f64) -> bool {
    let square = numerics::mean(acceleration.iter().map(|a| a * a));
    noise * noise <= MAX_NOISE_SHARE * square
}

/// The second derivative with the least noise over a symmetric window that is exact for cubics, and whose noise is uncorrelated with
/// that of a filtered value in the middle.
struct Filter {
    /// Weights of the samples, per sample².
    weights: Vec<f64>,
}

impl Filter {
    /// The sum of Σw² is least for weights that are a combination of the constraints: Σw = 0, Σw·t² = 2, Σw·v = 0 with the
    /// weights v of the value. The odd ones are zero by symmetry.
    fn new(half: usize, value_weights: &[f64]) -> Self {
        let margin = half - value_weights.len() / 2;
        let t = |i: usize| (i as f64 - half as f64) / half as f64;
        let v = |i: usize| i.checked_sub(margin).and_then(|i| value_weights.get(i)).copied().unwrap_or(0.0);
        let constraints = |i: usize| Vector3::new(1.0, t(i) * t(i), v(i));
        let gram: Matrix3<f64> = (0..=2 * half).map(|i| constraints(i) * constraints(i).transpose()).sum();
        let required = Vector3::new(0.0, 2.0 / (half * half) as f64, 0.0);
        let factors = gram.lu().solve(&required).unwrap_or_else(Vector3::zeros);
        Self { weights: (0..=2 * half).map(|i| constraints(i).dot(&factors)).collect() }
    }

    /// √Σw².
    fn norm(&self) -> f64 {
        self.weights.iter().map(|w| w * w).sum::<f64>().sqrt()
    }

    /// The filtered values; `at_ends` where the window reaches beyond an end.
    fn filtered(&self, raw: &[f64], sample_s: f64, at_ends: &[f64]) -> Vec<f64> {
        let mut result = at_ends.to_vec();
        let half = self.weights.len() / 2;
        for (window, value) in raw.windows(self.weights.len()).zip(&mut result[half..]) {
            let middle = window[half];
            let sum: f64 = window.iter().zip(&self.weights).map(|(x, w)| (x - middle) * w).sum();
            *value = sum / (sample_s * sample_s);
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights of a cubic Savitzky–Golay filter over 5 samples: (−3, 12, 17, 12, −3)/35.
    const VALUE: [f64; 5] = [-3.0 / 35.0, 12.0 / 35.0, 17.0 / 35.0, 12.0 / 35.0, -3.0 / 35.0];

    #[test]
    fn a_cubic_has_its_second_derivative() {
        let sample_s = 1e-3;
        let raw: Vec<f64> =
            (0..50).map(|i| 1e-3 * f64::from(i)).map(|t| 0.3 * t - 5.0 * t * t + 40.0 * t.powi(3)).collect();
        let filtered = Filter::new(7, &VALUE).filtered(&raw, sample_s, &[0.0; 50]);
        for (i, acceleration) in filtered.iter().enumerate() {
            let t = i as f64 * sample_s;
            let expected = if (7..43).contains(&i) { -10.0 + 240.0 * t } else { 0.0 };
            assert!((acceleration - expected).abs() < 1e-6, "{i}: {acceleration}");
        }
    }

    /// The covariance of two weighted sums of white noise is Σw·v.
    #[test]
    fn its_noise_is_uncorrelated_with_that_of_the_value() {
        for half in [3, 4, 8, 20] {
            let filter = Filter::new(half, &VALUE);
            let inner = &filter.weights[half - 2..=half + 2];
            let covariance: f64 = inner.iter().zip(&VALUE).map(|(w, v)| w * v).sum();
            assert!(covariance.abs() < 1e-9 * filter.norm(), "{half}: {covariance}");
        }
    }

    /// Without the last constraint, the norm of the least-squares second derivative over 2·m + 1 samples tends to √(720/(2·m)⁵)
    /// (its fourth-order moment: 180·4/n⁵); the constraint costs the middle of the window, a small part of a wide one.
    #[test]
    fn a_wide_filter_has_the_noise_of_a_parabola() {
        let ratio = Filter::new(60, &VALUE).norm() / (720.0f64 / 121.0f64.powi(5)).sqrt();
        assert!((1.0..1.1).contains(&ratio), "{ratio}");
    }

    #[test]
    fn only_a_noisy_acceleration_is_filtered_wider() {
        let raw: Vec<f64> = (0..2000).map(|i| 1e-3 * (0.01 * f64::from(i)).sin()).collect();
        // 1 mm at 10 rad/s: 0.1 m/s², its mean square 0.005.
        let narrow: Vec<f64> = raw.iter().map(|x| -100.0 * x).collect();
        let at_limit = (MAX_NOISE_SHARE * 0.005f64).sqrt();
        let of = |noise: f64| QuietAcceleration::of(&raw, &VALUE, 1e-3, 1e-7, (&narrow, noise));
        assert!(of(0.98 * at_limit).is_none());
        let quiet = of(1.02 * at_limit).unwrap();
        for (values, narrow) in quiet.values.iter().zip(&narrow) {
            assert!((values - narrow).abs() < 0.01 * 0.1, "{values} {narrow}");
        }
    }
}
