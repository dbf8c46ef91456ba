//! Peaks of a spectrum, and the mode that each of them is.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};
use numerics::spectrum::Density;
use serde::Serialize;

/// Ratio of a peak to the higher one of the minima beside it, from which on it is one: 8 dB.
const PROMINENCE: f64 = 6.3;

/// Peaks below this share of the highest density are ignored.
const SMALLEST: f64 = 1e-3;

/// The fit uses the bins above this share of the peak: 10 dB.
const FITTED: f64 = 0.1;

/// Fewest bins of a fit of three values.
const FEWEST_BINS: usize = 8;

/// Width of a peak at half its height from which on its damping is told, in bins: a Hann window alone has 1.4.
const RESOLVED_BINS: f64 = 3.0;

/// Largest ratio of the widths of a peak above and below its frequency, at half its height: of a mode with a damping ratio of 0.2 it is
/// 1.7. That of the end of a sweep is larger.
const MOST_SKEWED: usize = 3;

/// Largest deviation of a mode from the spectrum, root mean square of the logarithm: 1.3 dB.
const LARGEST_DEVIATION: f64 = 0.3;

/// Density of the excitation, as a power of the frequency: of a tap, and of a sweep whose acceleration grows with its frequency.
const EXCITATIONS: [i32; 2] = [0, 2];

/// Shares of the power of a tone that a Hann window has in its bin, in the middle, and in the bins beside it.
const HANN: [f64; 3] = [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0];

/// Half-width of an interval, in standard deviations of a fit to independent bins: 2 for 95 %, times 1.5, as neighbouring bins of a Hann
/// window are correlated.
const DEVIATIONS: f64 = 3.0;

/// A value with its interval of about 95 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The middle of the interval.
    pub value: f64,
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

impl Estimate {
    fn of(low: f64, high: f64) -> Self {
        Self { value: 0.5 * (low + high), low, high }
    }

    /// Half of the interval.
    #[must_use]
    pub fn half_width(&self) -> f64 {
        0.5 * (self.high - self.low)
    }
}

/// What a peak is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Shape {
    /// A second-order mode.
    Mode {
        /// Natural frequency, Hz.
        frequency_hz: Estimate,
        /// Damping ratio.
        damping_ratio: Estimate,
    },
    /// Narrower than the spectrum resolves: a forced vibration, or a mode with less damping.
    Narrow {
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Largest damping ratio that it may have.
        damping_ratio_below: f64,
    },
    /// Not shaped as one mode: several that overlap, or the end of an excitation.
    NoMode {
        /// Frequency of its highest density, Hz.
        frequency_hz: f64,
    },
}

/// A peak.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Peak {
    /// What it is.
    #[serde(flatten)]
    pub shape: Shape,
    /// Root mean square of its accelerations, m/s².
    pub rms_m_per_s2: f64,
}

/// The peaks within a range of frequencies, Hz, in their order.
#[must_use]
pub fn peaks(density: &Density, range_hz: Range<f64>) -> Vec<Peak> {
    let smooth: Vec<f64> = (0..density.values.len()).map(|bin| smoothed(&density.values, bin)).collect();
    let is_within = |bin: &usize| range_hz.contains(&(*bin as f64 * density.step_hz));
    let within: Vec<usize> = (1..smooth.len().saturating_sub(1)).filter(is_within).collect();
    let highest = within.iter().map(|bin| smooth[*bin]).fold(0.0, f64::max);
    let is_peak = |bin: &usize| {
        let at = smooth[*bin];
        at > smooth[*bin - 1]
            && at >= smooth[*bin + 1]
            && at > SMALLEST * highest
            && numerics::saddle(&smooth, *bin).is_some_and(|saddle| at > PROMINENCE * saddle)
    };
    within.into_iter().filter(is_peak).map(|bin| peak(density, &smooth, bin)).collect()
}

/// Mean of a bin and its neighbours, in the shares of a Hann window.
fn smoothed(values: &[f64], bin: usize) -> f64 {
    let at = |bin: usize| values[bin.min(values.len() - 1)];
    HANN[0] * at(bin.saturating_sub(1)) + HANN[1] * at(bin) + HANN[2] * at(bin + 1)
}

/// The peak at a bin.
fn peak(density: &Density, smooth: &[f64], bin: usize) -> Peak {
    let is_high = |value: &&f64| **value > FITTED * smooth[bin];
    let left = smooth[..bin].iter().rev().take_while(is_high).count();
    let right = smooth[bin + 1..].iter().take_while(is_high).count();
    let bins = (bin - left).max(1)..bin + right + 1;
    let power: f64 = density.values[bins.clone()].iter().sum::<f64>() * density.step_hz;
    let frequency_hz = bin as f64 * density.step_hz;
    let width = RESOLVED_BINS * density.step_hz;
    let is_half = |value: &&f64| **value > 0.5 * smooth[bin];
    let below = smooth[..bin].iter().rev().take_while(is_half).count() + 1;
    let above = smooth[bin + 1..].iter().take_while(is_half).count() + 1;
    let is_narrow = bins.len() < FEWEST_BINS || ((below + above) as f64) < RESOLVED_BINS + 2.0;
    let is_cut_off = below.max(above) > MOST_SKEWED * below.min(above);
    let shape = if is_narrow {
        // At half the height a mode is 2·ζ·f wide.
        Shape::Narrow { frequency_hz, damping_ratio_below: 0.5 * width / frequency_hz }
    } else if is_cut_off {
        Shape::NoMode { frequency_hz }
    } else {
        mode(density, &bins, frequency_hz).unwrap_or(Shape::NoMode { frequency_hz })
    };
    Peak { shape, rms_m_per_s2: power.sqrt() }
}

/// The mode that fits with one of the excitations; its intervals cover all that fit.
fn mode(density: &Density, bins: &Range<usize>, frequency_hz: f64) -> Option<Shape> {
    let fits: Vec<Fit> =
        EXCITATIONS.iter().filter_map(|power| Fit::of(density, bins, frequency_hz, *power)).collect();
    let union = |of: &dyn Fn(&Fit) -> (f64, f64)| {
        fits.iter()
            .map(of)
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            .map(|(low, high)| Estimate::of(low, high))
    };
    Some(Shape::Mode {
        frequency_hz: union(&|fit| fit.interval(1))?,
        damping_ratio: union(&|fit| fit.interval(2))?,
    })
}

/// Logarithms of scale, frequency and damping ratio, fitted to the logarithm of a density by Gauss and Newton.
struct Fit {
    logs: Vector3<f64>,
    deviations: Vector3<f64>,
}

impl Fit {
    /// The fit of a peak; `None` if it does not converge, or deviates.
    fn of(density: &Density, bins: &Range<usize>, frequency_hz: f64, power: i32) -> Option<Self> {
        let seen: Vec<f64> =
            bins.clone().map(|bin| libm::log(density.values[bin].max(f64::MIN_POSITIVE))).collect();
        let model = |logs: &Vector3<f64>| -> Vec<f64> {
            bins.clone()
                .map(|bin| logs[0] + log_density(bin, density.step_hz, [logs[1], logs[2]], power))
                .collect()
        };
        let mut logs = Vector3::new(0.0, libm::log(frequency_hz), libm::log(0.05));
        let (mut normal, mut is_converged) = (Matrix3::zeros(), false);
        for _ in 0..60 {
            let at = model(&logs);
            let step = 1e-6;
            let shifted = [0, 1, 2].map(|i| {
                let mut moved = logs;
                moved[i] += step;
                model(&moved)
            });
            normal = Matrix3::zeros();
            let mut gradient = Vector3::zeros();
            for (i, seen) in seen.iter().enumerate() {
                let slope = Vector3::from_fn(|j, _| (shifted[j][i] - at[i]) / step);
                normal += slope * slope.transpose();
                gradient += slope * (seen - at[i]);
            }
            let change = normal.try_inverse()? * gradient;
            // A step of more than a fifth of a frequency or a factor of two of a damping may leave the peak.
            let limit = [f64::INFINITY, 0.2, 0.7];
            logs += Vector3::from_fn(|j, _| change[j].clamp(-limit[j], limit[j]));
            is_converged = change.amax() < 1e-6;
            if is_converged {
                break;
            }
        }
        let squares: f64 = model(&logs).iter().zip(&seen).map(|(model, seen)| (model - seen).powi(2)).sum();
        let deviation = (squares / (seen.len() - 3) as f64).sqrt();
        let covariance = normal.try_inverse()?;
        let deviations = Vector3::from_fn(|j, _| deviation * covariance[(j, j)].max(0.0).sqrt());
        let is_peak = (libm::exp(logs[1]) / frequency_hz - 1.0).abs() < 0.2 && libm::exp(logs[2]) < 0.5;
        (is_converged && is_peak && deviation < LARGEST_DEVIATION).then_some(Self { logs, deviations })
    }

    /// The interval of a value.
    fn interval(&self, index: usize) -> (f64, f64) {
        let [at, half] = [self.logs[index], DEVIATIONS * self.deviations[index]];
        (libm::exp(at - half), libm::exp(at + half))
    }
}

/// Logarithm of the density that a mode of these logarithms of frequency and damping ratio shows in a bin with a Hann window.
fn log_density(bin: usize, step_hz: f64, [log_hz, log_ratio]: [f64; 2], power: i32) -> f64 {
    let [hz, ratio] = [libm::exp(log_hz), libm::exp(log_ratio)];
    let at = |offset: f64| {
        let f = (bin as f64 + offset) * step_hz;
        let r = f / hz;
        let damping = (2.0 * ratio * r).powi(2);
        (f / hz).powi(power) * (1.0 + damping) / ((1.0 - r * r).powi(2) + damping)
    };
    libm::log(HANN[0] * at(-1.0) + HANN[1] * at(0.0) + HANN[2] * at(1.0))
}
