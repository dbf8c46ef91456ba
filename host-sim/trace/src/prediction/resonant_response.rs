//! Response of a second-order mode to a sampled signal.

use nalgebra::Matrix4;

use crate::input::smoothing::Smooth;
use model::effects::Mode;

/// Steps from one sample to the next. At 120 Hz and 1 kHz, the error of linear interpolation is 0.4 % of the change over a
/// step.
const STEPS: usize = 4;

/// Response of ω²/(s² + 2ζωs + ω²), or of (2ζωs + ω²)/(s² + 2ζωs + ω²) where the damper acts against the table, to the signal, m, at the
/// samples; in equilibrium before the first sample.
///
/// Between samples the signal is the cubic through positions and velocities. Within a step (1/[`STEPS`] of a sample) it is
/// interpolated linearly, for which the matrix exponential is exact.
#[must_use]
pub fn resonant_response(signal: &Smooth, mode: Mode, sample_s: f64) -> Vec<f64> {
    let omega = std::f64::consts::TAU * mode.frequency_hz;
    let step_s = sample_s / STEPS as f64;
    let mut rates = Matrix4::zeros();
    (rates[(0, 1)], rates[(2, 3)]) = (1.0, 1.0);
    (rates[(1, 0)], rates[(1, 1)]) = (-omega * omega, -2.0 * mode.damping_ratio * omega);
    (rates[(1, 2)], rates[(1, 3)]) =
        (omega * omega, 2.0 * mode.damping_ratio * omega * mode.damped_against.share_of_table());
    let whole = (rates * step_s).exp();
    let end = |row: usize, state: [f64; 2], from: f64, slope: f64| {
        whole[(row, 0)] * state[0]
            + whole[(row, 1)] * state[1]
            + whole[(row, 2)] * from
            + whole[(row, 3)] * slope
    };
    let mut state = [signal.value[0], signal.velocity[0]];
    let mut from = signal.value[0];
    let mut result = vec![state[0]];
    for i in 0..signal.value.len() - 1 {
        for step in 1..=STEPS {
            let to = signal.between(i, step as f64 / STEPS as f64, sample_s);
            let slope = (to - from) / step_s;
            state = [end(0, state, from, slope), end(1, state, from, slope)];
            from = to;
        }
        result.push(state[0]);
    }
    result
}

#[cfg(test)]
mod tests {
    use model::effects::DampedAgainst;

    use super::*;

    #[test]
    fn a_mode_has_the_gain_and_phase_of_its_transfer_function() {
        let (sample_s, hertz) = (1e-3, 30.0);
        let omega = std::f64::consts::TAU * hertz;
        let position = |i: u32| (omega * 1e-3 * f64::from(i)).sin();
        let signal = Smooth::new((0..3000).map(position).collect(), sample_s, 2);
        let (omega_0, zeta) = (std::f64::consts::TAU * 75.0, 0.06);
        // The filter attenuates the signal slightly; the reference is the amplitude of the filtered signal.
        let size = numerics::max_abs(signal.value[1000..2000].iter().copied());
        // H = 1/(1 − r² + 2jζr), r = ω/ω0; with the damper against the table, (1 + 2jζr)/(1 − r² + 2jζr).
        let r = omega / omega_0;
        let (real, imaginary) = (1.0 - r * r, 2.0 * zeta * r);
        for damped_against in [DampedAgainst::Ground, DampedAgainst::Table] {
            let mode = Mode { frequency_hz: 75.0, damping_ratio: zeta, participation: 1.0, damped_against };
            let tool = resonant_response(&signal, mode, sample_s);
            let ahead = imaginary * damped_against.share_of_table();
            let gain = ahead.hypot(1.0) / real.hypot(imaginary);
            let phase = ahead.atan2(1.0) - imaginary.atan2(real);
            for (i, value) in tool.iter().enumerate().skip(2000).take(900) {
                let expected = size * gain * (omega * 1e-3 * i as f64 + phase).sin();
                assert!((value - expected).abs() < 3e-3, "{i}: {value} {expected}");
            }
        }
    }
}
