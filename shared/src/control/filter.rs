//! Second-order filters of the force: a notch against a resonance, a low-pass against noise.
//!
//! The continuous filters, ω₀ = 2πf, are
//!
//! ```text
//! low-pass: ω₀²/(s² + kω₀s + ω₀²), k = 2ζ        notch: 1 − d·kω₀s/(s² + kω₀s + ω₀²), k = width/f
//! ```
//!
//! discretised by the bilinear transform, prewarped so that the frequency f is exact: g = tan(πf/rate). The gain at zero
//! frequency is exactly one in every number format. In fixed point the realisation is a direct form with error feedback
//! ([`Scalar::Section`]), whose rounding does not accumulate; in floating point a state-variable filter.
//!
//! # Example
//!
//! A low-pass passes a constant force unchanged; a notch of depth 1 removes its centre frequency.
//!
//! ```
//! use shared::control::filter::{Filter, State};
//! use std::f64::consts::PI;
//!
//! let (rate_hz, notch_hz) = (20_000.0, 400.0);
//! let g = (PI * notch_hz / rate_hz).tan();
//! let low_pass = Filter::<f64>::low_pass(g, 1.4);
//! let mut state = State::settled(250.0);
//! assert_eq!(low_pass.step(&mut state, 250.0), 250.0);
//!
//! // With a width of half its frequency the transient decays as e^(−π·200 Hz·t): e⁻⁶³ after 0.1 s.
//! let notch = Filter::<f64>::notch(g, 0.5, 1.0);
//! let mut state = State::default();
//! let sine = |tick: u32| (2.0 * PI * notch_hz * f64::from(tick) / rate_hz).sin();
//! let output = (0..4000).map(|tick| notch.step(&mut state, sine(tick))).skip(2000);
//! assert!(output.fold(0.0, |max: f64, force| max.max(force.abs())) < 1e-9);
//! ```

use crate::scalar::{Scalar, Section};

/// Coefficients of a filter.
#[derive(Clone, Copy, Debug)]
pub struct Filter<S: Scalar>(S::Section);

/// State of a filter.
#[derive(Clone, Copy, Debug)]
pub struct State<S: Scalar>(<S::Section as Section<S>>::State);

impl<S: Scalar> Default for State<S> {
    fn default() -> Self {
        Self::AT_REST
    }
}

impl<S: Scalar> State<S> {
    /// Settled at zero.
    pub const AT_REST: Self = Self(S::Section::AT_REST);

    /// Settled at a constant input.
    #[must_use]
    pub fn settled(value: S) -> Self {
        Self(S::Section::settled(value))
    }
}

impl<S: Scalar> Filter<S> {
    /// A low-pass filter with g = tan(πf/rate) and k = 2ζ.
    #[must_use]
    pub fn low_pass(g: f64, k: f64) -> Self {
        Self(S::Section::new(g, k, None))
    }

    /// A notch filter with g = tan(πf/rate), k = width/f and the gain 1 − `depth` at its centre frequency.
    #[must_use]
    pub fn notch(g: f64, k: f64, depth: f64) -> Self {
        Self(S::Section::new(g, k, Some(depth)))
    }

    /// The output for one input, once per tick.
    pub fn step(&self, state: &mut State<S>, input: S) -> S {
        self.0.step(&mut state.0, input)
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use proptest::prelude::*;

    use super::*;
    use crate::scalar::Fixed;

    const RATE_HZ: f64 = 20_000.0;

    fn g(frequency_hz: f64) -> f64 {
        (frequency_hz / RATE_HZ * TAU / 2.0).tan()
    }

    /// Gain at a frequency, from the in-phase and quadrature components of the response to a sine after settling.
    fn measured<S: Scalar>(filter: &Filter<S>, frequency_hz: f64) -> f64 {
        let mut state = State::default();
        let (mut sine, mut cosine) = (0.0, 0.0);
        let period = RATE_HZ / frequency_hz;
        #[expect(clippy::cast_possible_truncation, reason = "about 10⁵")]
        let (settling, counted) = ((40.0 * period) as i32, (20.0 * period) as i32);
        for k in 0..settling + counted {
            let angle = TAU * frequency_hz / RATE_HZ * f64::from(k);
            let out = filter.step(&mut state, S::signal(1000.0 * angle.sin())).value();
            if k >= settling {
                sine += out * angle.sin();
                cosine += out * angle.cos();
            }
        }
        2.0 * sine.hypot(cosine) / 1000.0 / f64::from(counted)
    }

    /// Gain of the continuous filter at the frequency that the bilinear transform maps to: s/ω₀ = j·tan(πf/rate)/g.
    fn exact(g0: f64, k: f64, frequency_hz: f64, depth: Option<f64>) -> f64 {
        let x = g(frequency_hz) / g0;
        let (re, im) = (1.0 - x * x, k * x);
        match depth {
            None => 1.0 / re.hypot(im),
            Some(depth) => re.hypot((1.0 - depth) * im) / re.hypot(im),
        }
    }

    fn assert_response<S: Scalar>(tolerance: f64) {
        let frequencies_hz = [1600.0, 400.0, 270.0, 200.0, 100.0, 20.0];
        for frequency_hz in frequencies_hz.into_iter().take(if cfg!(miri) { 1 } else { 6 }) {
            let low_pass = Filter::<S>::low_pass(g(300.0), 1.4);
            let off = measured(&low_pass, frequency_hz) - exact(g(300.0), 1.4, frequency_hz, None);
            assert!(off.abs() < tolerance, "{} low-pass, {frequency_hz} Hz: {off}", S::NAME);
            let notch = Filter::<S>::notch(g(200.0), 0.3, 0.9);
            let off = measured(&notch, frequency_hz) - exact(g(200.0), 0.3, frequency_hz, Some(0.9));
            assert!(off.abs() < tolerance, "{} notch, {frequency_hz} Hz: {off}", S::NAME);
        }
    }

    /// Tolerance: the window is a whole number of periods to within a sample, 1/(20 periods · 12 samples), and in fixed
    /// point a₃ = 1e-3 is rounded by 2⁻²⁵.
    #[test]
    fn the_response_matches_the_transfer_function() {
        assert_response::<f64>(3e-3);
        assert_response::<f32>(3e-3);
        assert_response::<Fixed>(3e-3);
    }

    /// At the centre frequency the gain is 1 − d = 0.1 for any width.
    #[test]
    fn the_centre_gain_of_a_notch_is_one_minus_its_depth() {
        for width in [0.3, 0.05, 1.0].into_iter().take(if cfg!(miri) { 1 } else { 3 }) {
            let left = measured(&Filter::<f64>::notch(g(200.0), width, 0.9), 200.0);
            assert!((left - 0.1).abs() < 2e-3, "{left}");
        }
    }

    fn settles<S: Scalar>(value: f64, frequency_hz: f64, k: f64) {
        let value = S::signal(value);
        for filter in [Filter::<S>::low_pass(g(frequency_hz), k), Filter::notch(g(frequency_hz), k, 1.0)] {
            let mut state = State::settled(value);
            for _ in 0..100 {
                assert!(filter.step(&mut state, value) == value, "{}", S::NAME);
            }
            // From another state the output converges to the input.
            let mut state = State::settled(S::default());
            for _ in 0..if cfg!(miri) { 100 } else { 400_000 } {
                filter.step(&mut state, value);
            }
            if cfg!(miri) {
                return;
            }
            let off = filter.step(&mut state, value).value() - value.value();
            // In f32 an integrator stops where its increment, g·error, is below 2⁻²⁴ of its state. In fixed point a
            // rounding of half a step per tick sustains a limit cycle that decays by g·k per tick; a notch multiplies it by k.
            let lost = if S::NAME == "f32" { 8.0 / 16_777_216.0 / g(frequency_hz) } else { 0.0 };
            let swing = S::SIGNAL_STEP * (1.0 + k) / (2.0 * g(frequency_hz) * k);
            let bound = 2.0 / 16_384.0 + swing + value.value().abs() * (1e-6 + lost);
            assert!(off.abs() <= bound, "{}: {off}, bound {bound}", S::NAME);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 1 } else { 16 }))]

        /// A settled filter does not change by a bit; an unsettled one settles to within the bound of the limit cycle.
        #[test]
        fn a_constant_input_passes_unchanged(value in -1e4..1e4f64, frequency_hz in 30.0..5000.0f64, k in 0.1..2.0f64) {
            settles::<Fixed>(value, frequency_hz, k);
            settles::<f32>(value, frequency_hz, k);
            settles::<f64>(value, frequency_hz, k);
        }

        /// Steps from rail to rail, the ends of the range, saturate and do not wrap around.
        #[test]
        fn saturates_at_full_scale(period in 1usize..200, frequency_hz in 30.0..5000.0f64, k in 0.5..2.0f64) {
            let low_pass = Filter::<Fixed>::low_pass(g(frequency_hz), k);
            let mut state = State::default();
            let mut last = Fixed::ZERO;
            for n in 0..2000 {
                let rail = if n / period % 2 == 0 { Fixed::MAX } else { Fixed::MIN };
                let out = low_pass.step(&mut state, rail);
                // At most twice the distance to the rail, with a margin of half the range: no wrap to the other rail.
                let distance = Scalar::value(rail) - Scalar::value(last);
                let step = Scalar::value(out) - Scalar::value(last);
                prop_assert!(step.abs() <= 2.0 * distance.abs() + 140_000.0);
                last = out;
            }
        }
    }
}
