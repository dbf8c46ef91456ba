//! Power spectrum of a real series.

use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

/// The transform for power spectra of a fixed length.
pub struct PowerSpectrum {
    fft: Arc<dyn Fft<f64>>,
}

impl PowerSpectrum {
    /// Plans the transform for series of up to `length` values.
    #[must_use]
    pub fn new(length: usize) -> Self {
        Self { fft: FftPlanner::new().plan_fft_forward(length) }
    }

    /// |X|² at the frequencies below half the sample rate, of the values less their mean, padded with zeros. The frequency of
    /// bin k is k/length of the sample rate. By Parseval, Σ(x − mean)² is the sum of the bins times 2/length, where the bins
    /// at zero and at half the sample rate count half.
    ///
    /// # Panics
    /// If there are more values than the length.
    #[must_use]
    pub fn of(&self, values: &[f64]) -> Vec<f64> {
        let length = self.fft.len();
        assert!(values.len() <= length, "expected at most {length} values, found {}", values.len());
        let mean = crate::mean(values.iter().copied());
        let mut buffer: Vec<Complex<f64>> = values.iter().map(|r| Complex::new(r - mean, 0.0)).collect();
        buffer.resize(length, Complex::default());
        self.fft.process(&mut buffer);
        buffer[..length / 2].iter().map(Complex::norm_sqr).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cosine of amplitude a at bin k of n values has |X| = a·n/2 in this bin and zero elsewhere; the mean is removed.
    #[test]
    fn a_cosine_has_power_in_one_bin() {
        let [n, k, amplitude] = [64.0, 5.0, 3.0];
        let phase = |i: u32| std::f64::consts::TAU * k * f64::from(i) / n;
        let values: Vec<f64> = (0..64).map(|i| 7.0 + amplitude * phase(i).cos()).collect();
        for (bin, power) in PowerSpectrum::new(64).of(&values).into_iter().enumerate() {
            let expected = if bin == 5 { (0.5 * amplitude * n).powi(2) } else { 0.0 };
            // Rounding: 64 terms of up to 10 with a relative error of 2⁻⁵³ each, relative to the peak |X| = 96, squared.
            assert!((power - expected).abs() < 1e-9, "{bin}: {power}, {expected}");
        }
    }

    /// Compared with the definition of the transform, for a series shorter than the transform.
    #[test]
    fn the_spectrum_of_a_padded_series_agrees_with_the_definition() {
        let values = [1.0, -2.0, 0.5, 4.0, 1.5];
        let spectrum = PowerSpectrum::new(8).of(&values);
        assert_eq!(spectrum.len(), 4);
        for (bin, power) in spectrum.into_iter().enumerate() {
            let [mut re, mut im] = [0.0; 2];
            for (i, value) in values.iter().enumerate() {
                let angle = std::f64::consts::TAU * (bin * i) as f64 / 8.0;
                re += (value - 1.0) * angle.cos();
                im -= (value - 1.0) * angle.sin();
            }
            assert!((power - (re * re + im * im)).abs() < 1e-12, "{bin}");
        }
    }
}
