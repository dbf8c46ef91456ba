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

/// Power spectral density, one-sided.
#[derive(Clone, Debug, PartialEq)]
pub struct Density {
    /// Distance of the frequencies, Hz; the first value is at 0 Hz.
    pub step_hz: f64,
    /// Density, square of the unit of the signal per Hz.
    pub values: Vec<f64>,
}

/// The power spectral density by Welch's method (IEEE Trans. Audio Electroacoust. 15, 1967): the mean of the spectra of segments of
/// `length` values which overlap by half, each less its mean and with a Hann window. `None` if there is no segment.
#[must_use]
pub fn density(values: &[f64], rate_hz: f64, length: usize) -> Option<Density> {
    let window: Vec<f64> = (0..length)
        .map(|i| 0.5 - 0.5 * libm::cos(std::f64::consts::TAU * i as f64 / length as f64))
        .collect();
    let transform = PowerSpectrum::new(length);
    let mut sum = vec![0.0; length / 2];
    let mut segments = 0_usize;
    for segment in values.windows(length).step_by((length / 2).max(1)) {
        let mean = crate::mean(segment.iter().copied());
        let windowed: Vec<f64> =
            segment.iter().zip(&window).map(|(value, weight)| (value - mean) * weight).collect();
        sum.iter_mut().zip(transform.of(&windowed)).for_each(|(sum, power)| *sum += power);
        segments += 1;
    }
    let scale = 2.0 / (rate_hz * window.iter().map(|weight| weight * weight).sum::<f64>() * segments as f64);
    (segments > 0).then(|| Density {
        step_hz: rate_hz / length as f64,
        values: sum.into_iter().map(|power| scale * power).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By Parseval, the integral of the density over all frequencies is the variance: of a sine a²/2. With a Hann window its power is in
    /// three bins, in the ratio 1 : 4 : 1.
    #[test]
    fn the_density_of_a_sine_has_its_power() {
        let [rate_hz, hz, amplitude] = [1000.0, 125.0, 3.0];
        let values: Vec<f64> = (0..4096)
            .map(|i| 5.0 + amplitude * (std::f64::consts::TAU * hz * f64::from(i) / rate_hz).sin())
            .collect();
        let density = density(&values, rate_hz, 512).unwrap();
        let power: f64 = density.values.iter().sum::<f64>() * density.step_hz;
        // The window's rounding, and the sine's phase at the ends of a segment.
        assert!((power / (0.5 * amplitude * amplitude) - 1.0).abs() < 1e-9, "{power}");
        let [below, at, above] = [63, 64, 65].map(|bin| density.values[bin]);
        assert!((at / below - 4.0).abs() < 1e-9 && (at / above - 4.0).abs() < 1e-9, "{below} {at} {above}");
    }

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
