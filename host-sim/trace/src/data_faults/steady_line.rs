//! Lines of a spectrum: oscillations of constant frequency, amplitude and phase in a signal.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use numerics::spectrum::PowerSpectrum;

/// Least frequency, Hz: below, a difference of two channels follows the motion.
const MIN_HZ: f64 = 10.0;
/// Greatest frequency as a fraction of the sample rate.
const MAX_FREQUENCY: f64 = 0.45;
/// Amplitude of a line as a multiple of the median of the amplitudes beside it, at least.
const MIN_LINE: f64 = 6.0;
/// Distances from a line, Hz, between which lies what is beside it.
pub const BESIDE_HZ: [f64; 2] = [1.0, 8.0];
/// Largest deviation of an amplitude from another one of the same oscillation, as a fraction (complex).
const MAX_DEVIATION: f64 = 0.5;
/// Number of segments of a signal, and of those that agree with it at least: an oscillation that the motion excites decays.
const SEGMENTS: [usize; 2] = [6, 4];
/// Shortest segment, s.
const MIN_SEGMENT_S: f64 = 0.3;
/// Number of passes of a fit that gives less weight to samples that it does not describe: those which deviate by more than
/// [`TOLERATED`] times the median.
const PASSES: usize = 4;
const TOLERATED: f64 = 2.0;

/// An oscillation a·cos(2πft) + b·sin(2πft), t from the first sample of a piece of the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// f, Hz.
    pub frequency_hz: f64,
    /// a and b.
    pub parts: [f64; 2],
}

impl Line {
    /// √(a² + b²).
    #[must_use]
    pub fn amplitude(&self) -> f64 {
        libm::hypot(self.parts[0], self.parts[1])
    }

    /// Whether another line of this frequency has the same amplitude and phase.
    #[must_use]
    pub fn agrees(&self, [a, b]: [f64; 2]) -> bool {
        libm::hypot(a - self.parts[0], b - self.parts[1]) <= MAX_DEVIATION * self.amplitude()
    }

    /// Subtracts the oscillation from a piece of a log.
    pub fn subtract_from(&self, values: &mut [f64], sample_s: f64) {
        let step = std::f64::consts::TAU * self.frequency_hz * sample_s;
        for (i, value) in values.iter_mut().enumerate() {
            let (sin, cos) = libm::sincos(step * i as f64);
            *value -= self.parts[0] * cos + self.parts[1] * sin;
        }
    }
}

/// Hann's window.
fn window(i: usize, count: usize) -> f64 {
    libm::sin(std::f64::consts::PI * (i as f64 + 0.5) / count as f64).powi(2)
}

/// A piece of a signal, in which a line is sought beside other terms.
#[derive(Clone, Debug)]
pub struct Signal<'a> {
    /// The signal.
    pub values: &'a [f64],
    /// What else the signal consists of, beside a constant.
    pub terms: Vec<&'a [f64]>,
    /// Index of the first value, from which the phase is counted.
    pub first: usize,
    /// Sample time, s.
    pub sample_s: f64,
}

impl<'a> Signal<'a> {
    /// A whole piece without other terms.
    #[must_use]
    pub const fn whole(values: &'a [f64], sample_s: f64) -> Self {
        Self { values, terms: Vec::new(), first: 0, sample_s }
    }

    fn part(&self, range: &Range<usize>) -> Self {
        let terms = self.terms.iter().map(|term| &term[range.clone()]).collect();
        Self {
            values: &self.values[range.clone()],
            terms,
            first: self.first + range.start,
            sample_s: self.sample_s,
        }
    }

    /// The parts of the line at a frequency, by robust least squares.
    #[must_use]
    pub fn parts(&self, frequency_hz: f64) -> Option<[f64; 2]> {
        self.line(frequency_hz, PASSES)
    }

    /// Its parts by least squares weighted by Hann's window. In each pass after the first, samples that the last one
    /// does not describe have less weight: friction at a reversal, an impact.
    fn line(&self, frequency_hz: f64, passes: usize) -> Option<[f64; 2]> {
        let step = std::f64::consts::TAU * frequency_hz * self.sample_s;
        let count = self.terms.len() + 3;
        let row = |i: usize| {
            let (sin, cos) = libm::sincos(step * (self.first + i) as f64);
            let terms = self.terms.iter().map(|term| term[i]);
            DVector::from_iterator(count, [cos, sin, 1.0].into_iter().chain(terms))
        };
        let rows: Vec<DVector<f64>> = (0..self.values.len()).map(row).collect();
        let mut weights: Vec<f64> = (0..rows.len()).map(|i| window(i, rows.len())).collect();
        let mut solution = weighted(&rows, self.values, &weights)?;
        for _ in 1..passes {
            let left: Vec<f64> =
                rows.iter().zip(self.values).map(|(row, v)| (v - row.dot(&solution)).abs()).collect();
            let usual = TOLERATED * numerics::median(&left)?;
            for (i, weight) in weights.iter_mut().enumerate() {
                *weight = window(i, rows.len()) / (left[i] / usual).max(1.0).powi(2);
            }
            solution = weighted(&rows, self.values, &weights)?;
        }
        Some([solution[0], solution[1]])
    }
}

/// Weighted least squares.
fn weighted(rows: &[DVector<f64>], values: &[f64], weights: &[f64]) -> Option<DVector<f64>> {
    let count = rows.first()?.len();
    let (mut matrix, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
    for ((row, value), weight) in rows.iter().zip(values).zip(weights) {
        matrix.syger(*weight, row, row, 1.0);
        right.axpy(weight * value, row, 1.0);
    }
    matrix.fill_upper_triangle_with_lower_triangle();
    for k in 0..count {
        // In motion in one direction, the sign of the velocity is the constant.
        matrix[(k, k)] *= 1.0 + 1e-9;
    }
    Some(matrix.cholesky()?.solve(&right))
}

/// The frequency near `about_hz` at which the line is greatest, to a hundredth of the resolution of the log.
#[must_use]
pub fn refined_hz(signal: &Signal<'_>, about_hz: f64) -> f64 {
    let resolution_hz = 1.0 / (signal.values.len() as f64 * signal.sample_s);
    let amplitude = |hz: f64| signal.line(hz, 1).map_or(0.0, |[a, b]| libm::hypot(a, b));
    let (mut low, mut high) = (about_hz - resolution_hz, about_hz + resolution_hz);
    while high - low > 0.01 * resolution_hz {
        let third = (high - low) / 3.0;
        if amplitude(low + third) < amplitude(high - third) { low += third } else { high -= third }
    }
    0.5 * (low + high)
}

/// Amplitudes at the frequencies k/(n·T) of n samples, with Hann's window.
fn amplitudes(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let mean = numerics::mean(values.iter().copied());
    let windowed: Vec<f64> = values.iter().enumerate().map(|(i, v)| (v - mean) * window(i, count)).collect();
    PowerSpectrum::new(count).of(&windowed).iter().map(|power| 4.0 * power.sqrt() / count as f64).collect()
}

/// Frequencies, Hz, of the lines in the spectrum of a signal that stand out of what is beside them, the greatest first.
#[must_use]
pub fn lines(signal: &Signal<'_>) -> Vec<f64> {
    let spectrum = amplitudes(signal.values);
    let resolution_hz = 1.0 / (signal.values.len() as f64 * signal.sample_s);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a bin of the spectrum")]
    let bin = |hz: f64| (hz / resolution_hz).round() as usize;
    let [near, far] = BESIDE_HZ.map(bin);
    let end = bin(2.0 * MAX_FREQUENCY * resolution_hz * spectrum.len() as f64).min(spectrum.len());
    let is_prominent = |&k: &usize| {
        // Some 60 of them suffice for a median.
        let some = (far / 30).max(1);
        let beside = (k.saturating_sub(far)..=k.saturating_sub(near)).chain(k + near..=k + far).step_by(some);
        let beside: Vec<f64> = beside.filter_map(|k| spectrum.get(k).copied()).collect();
        spectrum[k] > MIN_LINE * numerics::median(&beside).unwrap_or(f64::INFINITY)
    };
    let is_peak =
        |&k: &usize| spectrum[k] >= spectrum[k - 1] && spectrum[k] >= *spectrum.get(k + 1).unwrap_or(&0.0);
    let mut found: Vec<usize> = (bin(MIN_HZ).max(1)..end).filter(|k| is_peak(k) && is_prominent(k)).collect();
    found.sort_by(|a, b| spectrum[*b].total_cmp(&spectrum[*a]));
    found.into_iter().map(|bin| bin as f64 * resolution_hz).collect()
}

/// Whether an oscillation has its amplitude and phase in most segments of a signal.
#[must_use]
pub fn is_steady(signal: &Signal<'_>, whole: &Line) -> bool {
    let [count, least] = SEGMENTS;
    let length = signal.values.len() / count;
    let agrees = |segment: usize| {
        let part = signal.part(&(segment * length..(segment + 1) * length));
        part.parts(whole.frequency_hz).is_some_and(|parts| whole.agrees(parts))
    };
    let agreeing = || (0..count).filter(|&segment| agrees(segment)).count();
    length as f64 * signal.sample_s >= MIN_SEGMENT_S && agreeing() >= least
}
