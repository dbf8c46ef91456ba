//! Responses to a sampled signal: a delay, or a second-order mode.

use nalgebra::Matrix4;

use crate::input::smoothing::Smooth;
use model::effects::Resonance;

/// Steps from one sample to the next. At 120 Hz and 1 kHz, the error of linear interpolation is 0.4 % of the change over a
/// step.
const STEPS: usize = 4;

/// Response of ω²/(s² + 2ζωs + ω²) to the signal, m, at the samples; in equilibrium before the first sample.
///
/// Between samples the signal is the cubic through positions and velocities. Within a step (1/[`STEPS`] of a sample) it is
/// interpolated linearly, for which the matrix exponential is exact.
#[must_use]
pub fn resonant_response(signal: &Smooth, resonance: &Resonance, sample_s: f64) -> Vec<f64> {
    let omega = std::f64::consts::TAU * resonance.frequency_hz;
    let step_s = sample_s / STEPS as f64;
    let mut rates = Matrix4::zeros();
    (rates[(0, 1)], rates[(2, 3)]) = (1.0, 1.0);
    (rates[(1, 0)], rates[(1, 1)]) = (-omega * omega, -2.0 * resonance.damping_ratio * omega);
    rates[(1, 2)] = omega * omega;
    let whole = (rates * step_s).exp();
    let end = |row: usize, state: [f64; 2], from: f64, slope: f64| {
        whole[(row, 0)] * state[0]
            + whole[(row, 1)] * state[1]
            + whole[(row, 2)] * from
            + whole[(row, 3)] * slope
    };
    let mut state = [signal.position[0], signal.velocity[0]];
    let mut from = signal.position[0];
    let mut result = vec![state[0]];
    for i in 0..signal.position.len() - 1 {
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

/// Weights of the values at −1, 0, 1, 2 in the interpolating cubic at t (Lagrange).
fn lagrange(t: f64) -> [f64; 4] {
    let (before, after, far) = (t + 1.0, t - 1.0, t - 2.0);
    [-t * after * far / 6.0, 0.5 * before * after * far, -0.5 * before * t * far, before * t * after / 6.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::Channel;

    #[test]
    fn a_mode_has_the_gain_and_phase_of_its_transfer_function() {
        let (sample_s, hertz) = (1e-3, 30.0);
        let omega = std::f64::consts::TAU * hertz;
        let position = |i: u32| (omega * 1e-3 * f64::from(i)).sin();
        let signal = Smooth::new((0..3000).map(position).collect(), sample_s, 2);
        let (omega_0, zeta) = (std::f64::consts::TAU * 75.0, 0.06);
        let resonance = Resonance { channel: Channel::Tool, frequency_hz: 75.0, damping_ratio: zeta };
        let tool = resonant_response(&signal, &resonance, sample_s);
        // H = 1/(1 − r² + 2jζr), r = ω/ω0.
        let r = omega / omega_0;
        let (real, imaginary) = (1.0 - r * r, 2.0 * zeta * r);
        let (gain, phase) = (real.hypot(imaginary).recip(), -imaginary.atan2(real));
        // The filter attenuates the signal slightly; the reference is the amplitude of the filtered signal.
        let size = numerics::max_abs(signal.position[1000..2000].iter().copied());
        for (i, value) in tool.iter().enumerate().skip(2000).take(900) {
            let expected = size * gain * (omega * 1e-3 * i as f64 + phase).sin();
            assert!((value - expected).abs() < 3e-3, "{i}: {value} {expected}");
        }
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
