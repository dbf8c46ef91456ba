//! Uncertainty of a mode of the tool due to the noise of the scale.
//!
//! The tool is predicted from the measured table, whose noise excites the modelled mode near its frequency, but not the tool.
//! The fit prefers a mode that amplifies this noise less: one with more damping. With the variance V of the amplified noise,
//! the expected gradient of ½·Σr² of n samples with respect to a parameter θ is n/2·∂V/∂θ. The shift that it causes is known
//! only as well as the noise, and is part of the interval.

use nalgebra::DVector;

use super::fit_data::{FitData, ResidualSeries};
use super::least_squares::Fitted;
use super::scope::Scope;
use crate::input::smoothing::Smooth;
use crate::prediction::resonant_response::resonant_response;
use model::effects::{Mode, Stage};

/// Largest number of samples of an impulse response.
const MAX_SAMPLES: usize = 20_000;

/// Relative step of the derivatives.
const STEP: f64 = 1e-3;

/// Expected gradient of the free parameters of a fit to the tool, weighted as its normal equations. Zero without a mode.
#[must_use]
pub fn gradient(data: &FitData<'_>, scope: &Scope, fitted: &Fitted) -> DVector<f64> {
    let mut gradient = DVector::zeros(fitted.parameters.len());
    for (index, effect) in fitted.model.found().iter().enumerate() {
        let Some(mode) = effect.mode() else { continue };
        if !scope.holds(effect) {
            continue;
        }
        let first = fitted.model.indices_of(scope, index).start;
        let share = mode.participation.powi(2);
        let series = fitted.residuals.iter().zip(&fitted.weights);
        for (series, weight) in series.filter(|(series, _)| series.stage == Stage::Tool) {
            for (parameter, slope) in slopes(data, series, mode).into_iter().enumerate() {
                gradient[first + parameter] += 0.5 * weight * weight * share * slope;
            }
        }
    }
    gradient
}

/// n·∂V/∂θ of frequency and damping ratio, µm² per Hz and per one, for the samples of a log that count.
fn slopes(data: &FitData<'_>, series: &ResidualSeries, mode: Mode) -> [f64; 2] {
    let Some(table) = data.signals(series.log).table_or_motor() else { return [0.0; 2] };
    let counts = data.counting(series.stage, series.log);
    let samples = (0..series.values.len()).filter(|&sample| counts(sample)).count() as f64;
    let sample_s = data.logs[series.log].sample_s;
    let variance = |mode: Mode| variance_um2(table, mode, sample_s);
    let Mode { frequency_hz, damping_ratio, .. } = mode;
    let per_hz =
        [-STEP, STEP].map(|step| variance(Mode { frequency_hz: (1.0 + step) * frequency_hz, ..mode }));
    let per_one =
        [-STEP, STEP].map(|step| variance(Mode { damping_ratio: (1.0 + step) * damping_ratio, ..mode }));
    let slope = |[below, above]: [f64; 2], value: f64| samples * (above - below) / (2.0 * STEP * value);
    [slope(per_hz, frequency_hz), slope(per_one, damping_ratio)]
}

/// Variance of the modelled tool due to the white noise of a channel, µm².
fn variance_um2(channel: &Smooth, mode: Mode, sample_s: f64) -> f64 {
    let rate = std::f64::consts::TAU * mode.frequency_hz * mode.damping_ratio * sample_s;
    let window = channel.half_window();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "limited, above zero")]
    let settling = (10.0 / rate).min(MAX_SAMPLES as f64) as usize;
    let mut impulse = vec![0.0; 8 * window + settling];
    impulse[4 * window] = 1e6 * channel.noise;
    let response = resonant_response(&Smooth::new(impulse, sample_s, window), mode, sample_s);
    response.iter().map(|value| value * value).sum()
}

#[cfg(test)]
mod tests {
    use model::effects::DampedAgainst;

    use super::*;

    /// A mode amplifies noise of a one-sided density of 2σ²·T per Hz, which the filter passes, by π·f/(4·ζ) Hz around its frequency
    /// (the bandwidth of a resonance with a gain of one below it).
    #[test]
    fn a_mode_amplifies_noise_in_its_bandwidth() {
        let (sample_s, noise_m, frequency_hz) = (1e-3, 20e-9, 60.0);
        let mut channel = Smooth::new(vec![0.0; 100], sample_s, 2);
        channel.noise = noise_m;
        for damping_ratio in [0.02, 0.05] {
            let damped_against = DampedAgainst::Ground;
            let mode = Mode { frequency_hz, damping_ratio, participation: 1.0, damped_against };
            // The filter over five samples passes 60 Hz; the mode suppresses what is beyond it.
            let variance = variance_um2(&channel, mode, sample_s);
            let density = 2.0 * (1e6 * noise_m).powi(2) * sample_s;
            let expected = density * std::f64::consts::PI * frequency_hz / (4.0 * damping_ratio);
            assert!((variance / expected - 1.0).abs() < 0.05, "{variance} {expected}");
        }
    }
}
