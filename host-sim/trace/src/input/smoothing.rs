//! Filtering and differentiation of a channel, and estimation of its noise.

use super::encoder_step::encoder_step;
use super::quiet_acceleration::QuietAcceleration;

/// One channel of a log with its filtered value and derivatives. Position channels are in m, force channels in N.
///
/// Measured and modelled signals pass the same filter before they are compared, so that the distortion by the filter cancels
/// in the residual.
#[derive(Clone, Debug)]
pub struct Smooth {
    /// Measured values.
    pub raw: Vec<f64>,
    /// Filtered values.
    pub value: Vec<f64>,
    /// Central difference of `value`, per s.
    pub velocity: Vec<f64>,
    /// Second difference of `value`, per s².
    pub acceleration: Vec<f64>,
    /// Standard deviation of the white noise of `raw`.
    pub noise: f64,
    /// Standard deviation of that noise in `value`.
    pub value_noise: f64,
    /// Standard deviation of that noise in `acceleration`.
    pub acceleration_noise: f64,
    /// Standard deviation of the rounding to the steps of `raw`, below which its noise is not.
    rounding: f64,
    /// Half width of the filter's window, samples.
    half_window: usize,
    /// Acceleration by a wider filter, if the noise of `acceleration` is not small beside it.
    quiet: Option<QuietAcceleration>,
}

impl Smooth {
    /// Filters with a cubic Savitzky–Golay filter (1964) over 2·`half_window` + 1 samples. At the ends, the values are those
    /// of the cubic of the outermost full window.
    #[must_use]
    pub fn new(raw: Vec<f64>, sample_s: f64, half_window: usize) -> Self {
        let cubic = Cubic::new(half_window);
        let value = cubic.filtered(&raw);
        let (velocity, acceleration) = differences(&value, sample_s);
        let rounding = rounding(&raw);
        let noise = noise(&raw).max(rounding);
        Self {
            noise,
            rounding,
            value_noise: noise * norm(&cubic.middle),
            acceleration_noise: noise * norm(&second_difference(&cubic.middle)) / (sample_s * sample_s),
            raw,
            value,
            velocity,
            acceleration,
            half_window,
            quiet: None,
        }
    }

    /// The channel with an acceleration for effects that are proportional to it: see [`Self::quiet_acceleration`].
    #[must_use]
    pub fn with_quiet_acceleration(mut self, sample_s: f64) -> Self {
        let weights = Cubic::new(self.half_window).middle;
        let narrow = (&self.acceleration[..], self.acceleration_noise);
        self.quiet = QuietAcceleration::of(&self.raw, &weights, sample_s, self.noise, narrow);
        self
    }

    /// Other values, such as modelled ones, after the filters of this channel.
    #[must_use]
    pub fn of_other(&self, raw: Vec<f64>, sample_s: f64) -> Self {
        let mut other = Self::new(raw, sample_s, self.half_window);
        let weights = Cubic::new(self.half_window).middle;
        let quiet = self.quiet.as_ref();
        other.quiet = quiet.map(|quiet| quiet.of_other(&other.raw, &weights, sample_s, &other.acceleration));
        other
    }

    /// Central difference of the velocity, per s². It has less than half of the noise of [`Self::acceleration`], and of a wave of
    /// ω rad per sample the factor cos²(ω/2) of it: 0.996 of 20 Hz at 1 kHz.
    #[must_use]
    pub fn rate_of_velocity(&self, sample_s: f64) -> Vec<f64> {
        differences(&self.velocity, sample_s).0
    }

    /// Acceleration whose noise is small and uncorrelated with that of `value`: see [`super::quiet_acceleration`]. It is `acceleration`
    /// if that has little noise.
    #[must_use]
    pub fn quiet_acceleration(&self) -> &[f64] {
        self.quiet.as_ref().map_or(&self.acceleration, |quiet| &quiet.values)
    }

    /// Standard deviation of the noise in [`Self::quiet_acceleration`], per s².
    #[must_use]
    pub fn quiet_acceleration_noise(&self, sample_s: f64) -> f64 {
        let norm_of = |quiet: &QuietAcceleration| quiet.norm(&Cubic::new(self.half_window).middle);
        let of_quiet = self.quiet.as_ref().map(|quiet| self.noise * norm_of(quiet) / (sample_s * sample_s));
        of_quiet.unwrap_or(self.acceleration_noise)
    }

    /// Standard deviation of the noise in `value` plus a factor (s²) times [`Self::quiet_acceleration`].
    #[must_use]
    pub fn noise_with_acceleration(&self, factor_s2: f64, sample_s: f64) -> f64 {
        if self.quiet.is_some() {
            return libm::hypot(self.value_noise, factor_s2 * self.quiet_acceleration_noise(sample_s));
        }
        let value = Cubic::new(self.half_window).middle;
        let per_sample = factor_s2 / (sample_s * sample_s);
        let acceleration = second_difference(&value);
        let of_value = [0.0].into_iter().chain(value).chain([0.0]);
        let sum: Vec<f64> = of_value.zip(acceleration).map(|(value, per)| value + per_sample * per).collect();
        self.noise * norm(&sum)
    }

    /// Estimates the noise again, without the flagged samples: they are not readings but replacements, with the noise of an
    /// interpolation. Unchanged without any reading.
    pub fn estimate_noise_without(&mut self, replaced: &[bool]) {
        let noise = noise_without(&self.raw, |sample| replaced.get(sample).copied().unwrap_or(false));
        let noise = noise.max(self.rounding);
        if noise > 0.0 && self.noise > 0.0 {
            let factor = noise / self.noise;
            self.noise *= factor;
            self.value_noise *= factor;
            self.acceleration_noise *= factor;
        }
    }

    /// Position between samples `i` and `i + 1` (`fraction` 0 to 1): the cubic through both positions and velocities.
    #[must_use]
    #[inline]
    pub fn between(&self, i: usize, fraction: f64, sample_s: f64) -> f64 {
        let (p0, p1) = (self.value[i], self.value[i + 1]);
        let (m0, m1) = (self.velocity[i] * sample_s, self.velocity[i + 1] * sample_s);
        let rise = p1 - p0;
        let t = fraction;
        p0 + t * (m0 + t * ((3.0 * rise - 2.0 * m0 - m1) + t * (m0 + m1 - 2.0 * rise)))
    }

    /// Half width of the filter's window, samples.
    #[must_use]
    pub const fn half_window(&self) -> usize {
        self.half_window
    }

    /// A modelled signal after the filter of this channel.
    #[must_use]
    pub fn filtered(&self, values: &[f64]) -> Vec<f64> {
        Cubic::new(self.half_window).filtered(values)
    }
}

/// Central first differences and second differences. The first and the last value are those of their neighbours.
fn differences(position: &[f64], sample_s: f64) -> (Vec<f64>, Vec<f64>) {
    let n = position.len();
    if n < 3 {
        return (vec![0.0; n], vec![0.0; n]);
    }
    let inner = |i: usize| i.clamp(1, n - 2);
    let first = |i: usize| (position[inner(i) + 1] - position[inner(i) - 1]) / (2.0 * sample_s);
    let second = |i: usize| {
        let i = inner(i);
        ((position[i + 1] - position[i]) - (position[i] - position[i - 1])) / (sample_s * sample_s)
    };
    ((0..n).map(first).collect(), (0..n).map(second).collect())
}

/// Least-squares cubic over a symmetric window. Each of its four coefficients is a weighted sum of the samples.
struct Cubic {
    /// Weights of each sample in the coefficients of 1, t, t², t³; t in samples from the middle.
    weights: Vec<[f64; 4]>,
    /// Weights of each sample in the value at the middle.
    middle: Vec<f64>,
}

impl Cubic {
    fn new(half: usize) -> Self {
        let offsets: Vec<f64> = (0..=2 * half).map(|i| i as f64 - half as f64).collect();
        let moment = |p: i32| offsets.iter().map(|t| t.powi(p)).sum::<f64>();
        let (s0, s2, s4, s6) = (moment(0), moment(2), moment(4), moment(6));
        // In a symmetric window the odd moments are zero: the normal equations are two 2×2 systems, even and odd.
        let even = s0 * s4 - s2 * s2;
        let odd = s2 * s6 - s4 * s4;
        let weights: Vec<[f64; 4]> = offsets
            .iter()
            .map(|t| {
                [
                    (s4 - s2 * t * t) / even,
                    t * (s6 - s4 * t * t) / odd,
                    (s0 * t * t - s2) / even,
                    t * (s2 * t * t - s4) / odd,
                ]
            })
            .collect();
        let middle = weights.iter().map(|w| w[0]).collect();
        Self { weights, middle }
    }

    /// The value at the middle of the window around each sample; at the ends, the cubic of the outermost full window.
    fn filtered(&self, raw: &[f64]) -> Vec<f64> {
        let (n, half) = (raw.len(), self.middle.len() / 2);
        if n <= 2 * half {
            return raw.to_vec();
        }
        // The outer loop is over the offsets, so that the inner sums are independent and the compiler vectorizes them.
        let mut inner = vec![0.0; n - 2 * half];
        for (offset, weight) in self.middle.iter().enumerate() {
            for (sum, value) in inner.iter_mut().zip(&raw[offset..]) {
                *sum += weight * value;
            }
        }
        let (first, last) = (&raw[..=2 * half], &raw[n - 2 * half - 1..]);
        let before = (0..half).map(|i| self.value(first, i as f64 - half as f64));
        let after = (1..=half).map(|i| self.value(last, i as f64));
        before.chain(inner.iter().copied()).chain(after).collect()
    }

    /// Value of the cubic through a window at an offset from its middle.
    fn value(&self, window: &[f64], offset: f64) -> f64 {
        let middle = window[window.len() / 2];
        let mut sums = [0.0; 4];
        for (value, weights) in window.iter().zip(&self.weights) {
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += (value - middle) * weight;
            }
        }
        let [a, b, c, d] = sums;
        middle + a + offset * (b + offset * (c + offset * d))
    }
}

/// √Σw²: ratio of the standard deviations of white noise after and before a filter.
fn norm(weights: &[f64]) -> f64 {
    weights.iter().map(|w| w * w).sum::<f64>().sqrt()
}

/// Weights of a filter followed by a second difference.
fn second_difference(kernel: &[f64]) -> Vec<f64> {
    let padded: Vec<f64> = [0.0; 2].into_iter().chain(kernel.iter().copied()).chain([0.0; 2]).collect();
    padded.windows(3).map(|w| w[2] - 2.0 * w[1] + w[0]).collect()
}

/// Standard deviation of the rounding of readings to steps of q, q/√12. At slow motion it is correlated from sample to sample, so that
/// third differences show only a part of it.
fn rounding(values: &[f64]) -> f64 {
    encoder_step(values).map_or(0.0, |step| step / 12f64.sqrt())
}

/// Standard deviation of the white noise of a channel, from its third differences, which are zero for a parabola. Their
/// variance is 1 + 9 + 9 + 1 = 20 times that of the noise. The result is the median over stretches of 64 samples, which
/// suppresses stretches with jerks.
#[must_use]
pub fn noise(values: &[f64]) -> f64 {
    noise_without(values, |_| false)
}

/// As [`noise`], without the differences that contain a sample which was replaced.
fn noise_without(values: &[f64], is_replaced: impl Fn(usize) -> bool) -> f64 {
    const STRETCH: usize = 64;
    let variance = |start: usize| {
        let windows = values[start..].windows(4).take(STRETCH).enumerate();
        let measured = windows.filter(|(i, _)| !(start + i..start + i + 4).any(&is_replaced));
        let [sum, count] = measured.fold([0.0; 2], |[sum, count], (_, w)| {
            [sum + (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).powi(2), count + 1.0]
        });
        (count > 0.0).then(|| sum / (20.0 * count))
    };
    let starts = (0..values.len().saturating_sub(3)).step_by(STRETCH);
    let variances: Vec<f64> = starts.filter_map(variance).collect();
    numerics::median(&variances).unwrap_or(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_passes_unchanged_with_its_derivatives() {
        let dt = 1e-3;
        let f = |t: f64| 2.0 + 0.3 * t - 5.0 * t * t + 40.0 * t * t * t;
        let raw = (0..200).map(|i| f(f64::from(i) * dt)).collect();
        let smooth = Smooth::new(raw, dt, 5);
        for i in [1, 3, 100, 198] {
            let t = f64::from(i) * dt;
            let i = usize::try_from(i).unwrap();
            assert!((smooth.value[i] - f(t)).abs() < 1e-12);
            // The error of a central difference of t³ is dt²: 40·1e-6.
            assert!((smooth.velocity[i] - (0.3 - 10.0 * t + 120.0 * t * t)).abs() < 5e-5);
            assert!((smooth.acceleration[i] - (-10.0 + 240.0 * t)).abs() < 1e-5);
        }
    }

    #[test]
    fn noise_is_estimated_in_the_presence_of_motion() {
        // Random signs ±1 have σ = 1.
        let mut state = 1u32;
        let values: Vec<f64> = (0..20_000)
            .map(|i| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let sign = if state >> 31 == 0 { 1.0 } else { -1.0 };
                1e4 * (f64::from(i) * 1e-3).sin() + sign
            })
            .collect();
        assert!((noise(&values) - 1.0).abs() < 0.1, "{}", noise(&values));
    }

    /// The noise of 20 nm of a table at 1 kHz, seen through an in-talk, is that of the sum of both series. Of 20 000 samples, of which a fifth are
    /// independent, the standard deviation is known to 1.1 %; 4 % are more than three times that.
    #[test]
    fn the_noise_of_a_value_and_its_acceleration_is_that_of_their_sum() {
        let mut state = 1u32;
        let mut sign = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            if state >> 31 == 0 { 20e-9 } else { -20e-9 }
        };
        // At rest, and beside a motion of which the acceleration of 3 mm/s² is small beside its noise.
        for (amplitude_m, is_quiet) in [(0.0, false), (3e-3, true)] {
            let motion = |i: u32| amplitude_m * (1e-3 * f64::from(i)).sin();
            let plain = Smooth::new((0..20_000).map(motion).collect(), 1e-3, 2);
            let read = Smooth::new((0..20_000).map(|i| motion(i) + sign()).collect(), 1e-3, 2);
            let read = if is_quiet { read.with_quiet_acceleration(1e-3) } else { read };
            assert_eq!(read.quiet.is_some(), is_quiet);
            let plain = read.of_other(plain.raw, 1e-3);
            for factor_s2 in [-4e-6, -1e-6, 1e-6, 4e-6] {
                let sum =
                    |smooth: &Smooth, i: usize| smooth.value[i] + factor_s2 * smooth.quiet_acceleration()[i];
                let difference = (100..19_900).map(|i| sum(&read, i) - sum(&plain, i));
                let measured = numerics::rms(difference);
                let expected = read.noise_with_acceleration(factor_s2, 1e-3) / read.noise * 20e-9;
                assert!((measured / expected - 1.0).abs() < 0.04, "{factor_s2}: {measured} {expected}");
            }
        }
    }

    /// Uniform noise of ±1 has a standard deviation of 1/√3; every tenth sample is replaced by a mean of its neighbours.
    #[test]
    fn replaced_samples_do_not_lower_the_noise() {
        let mut state = 1u32;
        let mut raw: Vec<f64> = (0..20_000)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                2.0 * f64::from(state) / f64::from(u32::MAX) - 1.0
            })
            .collect();
        let replaced: Vec<bool> = (0..raw.len()).map(|i| i % 10 == 5).collect();
        for i in (5..raw.len() - 1).step_by(10) {
            raw[i] = 0.5 * (raw[i - 1] + raw[i + 1]);
        }
        let mut smooth = Smooth::new(raw, 1e-3, 5);
        let sigma = 1.0 / 3.0f64.sqrt();
        let before = smooth.value_noise / smooth.noise;
        assert!(smooth.noise < 0.95 * sigma, "{}", smooth.noise);
        smooth.estimate_noise_without(&replaced);
        // The median over 300 stretches of 37 differences: 1 %, and 1 % below the mean, as χ² is skewed.
        assert!((0.96..1.02).contains(&(smooth.noise / sigma)), "{}", smooth.noise / sigma);
        assert!((smooth.value_noise / smooth.noise - before).abs() < 1e-12);
    }
}
