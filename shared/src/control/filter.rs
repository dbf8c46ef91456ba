//! Second-order filters of the force: a notch against a resonance, a low-pass against noise.
//!
//! The continuous filters, ω₀ = 2πf, are
//!
//! ```text
//! low-pass: ω₀²/(s² + kω₀s + ω₀²), k = 2ζ        notch: 1 − d·kω₀s/(s² + kω₀s + ω₀²), k = width/f
//! ```
//!
//! made discrete by the bilinear transform with g = tan(πf/rate), which meets the frequency f exactly. Realised
//! as two integrators (the trapezoidal state-variable filter of Zavalishin, *The Art of VA Filter Design*, 2012),
//!
//! ```text
//! u = x − q,   v = a₁p + a₂u,   w = q + a₂p + a₃u,   p ← 2v − p,   q ← 2w − q,
//! a₁ = 1/(1 + g(g + k)),   a₂ = g·a₁,   a₃ = g·a₂,
//! ```
//!
//! w the low-pass, x − d·k·v the notch: at rest p = 0 and q = x, so the gain at frequency zero is one
//! exactly, in every number format. The integrators are sums that are not rounded: nothing is lost. What is read of
//! them is: half a step of p and q a tick, which a filter that forgets g·k of its swing a tick may keep up as a swing of
//! 1/(2gk) steps (the deadband of recursive filters): at 150 Hz, k = 0.2 and 20 kHz at most 7 mN, and 0.2 mN were seen.
//!
//! # Example
//!
//! A low-pass leaves a force that stands as it is; a full notch leaves nothing of its own frequency.
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
//! // Half as wide as its frequency: what swings in has decayed after 0.1 s, e^(−π·200 Hz·0.1 s) = e⁻⁶³.
//! let notch = Filter::<f64>::notch(g, 0.5, 1.0);
//! let mut state = State::default();
//! let swing = |tick: u32| (2.0 * PI * notch_hz * f64::from(tick) / rate_hz).sin();
//! let left = (0..4000).map(|tick| notch.step(&mut state, swing(tick))).skip(2000);
//! assert!(left.fold(0.0, |most: f64, force| most.max(force.abs())) < 1e-9);
//! ```

use crate::scalar::Scalar;

/// A filter.
#[derive(Clone, Copy, Debug)]
pub struct Filter<S: Scalar> {
    a1: S::Gain,
    a2: S::Gain,
    a3: S::Gain,
    /// d·k of a notch; `None`: a low-pass.
    notch: Option<S::Gain>,
}

/// Its two integrators.
#[derive(Clone, Copy, Debug, Default)]
pub struct State<S: Scalar> {
    p: S::Sum,
    q: S::Sum,
}

impl<S: Scalar> State<S> {
    /// Settled on zero.
    pub const AT_REST: Self = Self { p: S::ZERO_SUM, q: S::ZERO_SUM };

    /// Settled on a value.
    #[must_use]
    pub fn settled(value: S) -> Self {
        Self { p: S::Sum::default(), q: value.widen() }
    }
}

impl<S: Scalar> Filter<S> {
    /// A low-pass for g = tan(πf/rate) and k = 2ζ.
    #[must_use]
    pub fn low_pass(g: f64, k: f64) -> Self {
        Self::new(g, k, None)
    }

    /// A notch for g = tan(πf/rate) and k = width/f that leaves 1 − `depth` of its frequency.
    #[must_use]
    pub fn notch(g: f64, k: f64, depth: f64) -> Self {
        Self::new(g, k, Some(S::gain(depth * k)))
    }

    fn new(g: f64, k: f64, notch: Option<S::Gain>) -> Self {
        let a1 = 1.0 / (1.0 + g * (g + k));
        Self { a1: S::gain(a1), a2: S::gain(g * a1), a3: S::gain(g * g * a1), notch }
    }

    /// One tick.
    pub fn step(&self, state: &mut State<S>, value: S) -> S {
        let (p, q) = (S::round(state.p), S::round(state.q));
        let ahead = value - q;
        let v = p * self.a1 + ahead * self.a2;
        // w − q, without q's own rounding.
        let w = p * self.a2 + ahead * self.a3;
        state.p = v + (v - state.p);
        state.q += w + w;
        match self.notch {
            // w lies half a step before the new q.
            None => S::round(state.q - w),
            Some(share) => value - S::round(S::round(v) * share),
        }
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

    /// Gain at a frequency: sine in, what comes out in phase and in quadrature, after `settling` periods.
    fn measured<S: Scalar>(filter: &Filter<S>, frequency_hz: f64) -> f64 {
        let mut state = State::default();
        let (mut sine, mut cosine) = (0.0, 0.0);
        let period = RATE_HZ / frequency_hz;
        #[expect(clippy::cast_possible_truncation, reason = "some 10⁵")]
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

    /// The continuous filter at the frequency that the bilinear transform makes of this one:
    /// s/ω₀ = j·tan(πf/rate)/g.
    fn exact(g0: f64, k: f64, frequency_hz: f64, depth: Option<f64>) -> f64 {
        let x = g(frequency_hz) / g0;
        let (re, im) = (1.0 - x * x, k * x);
        match depth {
            None => 1.0 / re.hypot(im),
            Some(depth) => re.hypot((1.0 - depth) * im) / re.hypot(im),
        }
    }

    fn responds<S: Scalar>(tolerance: f64) {
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

    /// The window holds whole periods only to a sample: 1/(20 periods · 12 samples) of the transient that is
    /// left, and in fixed point gains of 2⁻²⁵ on a₃ = 1e-3.
    #[test]
    fn responds_as_its_transfer_function_says() {
        responds::<f64>(3e-3);
        responds::<f32>(3e-3);
        responds::<Fixed>(3e-3);
    }

    /// At its own frequency the notch leaves 1 − d: derived, 0.1, whatever its width.
    #[test]
    fn a_notch_leaves_what_it_is_told_to() {
        for width in [0.3, 0.05, 1.0].into_iter().take(if cfg!(miri) { 1 } else { 3 }) {
            let left = measured(&Filter::<f64>::notch(g(200.0), width, 0.9), 200.0);
            assert!((left - 0.1).abs() < 2e-3, "{left}");
        }
    }

    fn rests<S: Scalar>(value: f64, frequency_hz: f64, k: f64) {
        let value = S::signal(value);
        for filter in [Filter::<S>::low_pass(g(frequency_hz), k), Filter::notch(g(frequency_hz), k, 1.0)] {
            let mut state = State::settled(value);
            for _ in 0..100 {
                assert!(filter.step(&mut state, value) == value, "{}", S::NAME);
            }
            // From somewhere else it comes there, and stays within a step of the format.
            let mut state = State::settled(S::default());
            for _ in 0..if cfg!(miri) { 100 } else { 400_000 } {
                filter.step(&mut state, value);
            }
            if cfg!(miri) {
                return;
            }
            let off = filter.step(&mut state, value).value() - value.value();
            // An integrator stops where its step, g of the error, is lost beside its state: 2⁻²⁴ of it in f32. In fixed
            // point half a step a tick keeps up a swing that loses g·k of itself in one; a notch shows it k times.
            let lost = if S::NAME == "f32" { 8.0 / 16_777_216.0 / g(frequency_hz) } else { 0.0 };
            let swing = S::SIGNAL_STEP * (1.0 + k) / (2.0 * g(frequency_hz) * k);
            let bound = 2.0 / 16_384.0 + swing + value.value().abs() * (1e-6 + lost);
            assert!(off.abs() <= bound, "{}: {off} of {bound}", S::NAME);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 1 } else { 16 }))]

        /// Settled it does not move by a bit; unsettled it settles, without a cycle that stays.
        #[test]
        fn passes_what_stands(value in -1e4..1e4f64, frequency_hz in 30.0..5000.0f64, k in 0.1..2.0f64) {
            rests::<Fixed>(value, frequency_hz, k);
            rests::<f32>(value, frequency_hz, k);
            rests::<f64>(value, frequency_hz, k);
        }

        /// Full-scale steps from rail to rail: no wrap, no more than the overshoot of k ≥ 0.5 allows.
        #[test]
        fn saturates_at_full_scale(period in 1usize..200, frequency_hz in 30.0..5000.0f64, k in 0.5..2.0f64) {
            let low_pass = Filter::<Fixed>::low_pass(g(frequency_hz), k);
            let mut state = State::default();
            let mut last = Fixed::ZERO;
            for n in 0..2000 {
                let rail = if n / period % 2 == 0 { Fixed::MAX } else { Fixed::MIN };
                let out = low_pass.step(&mut state, rail);
                // The step towards the rail is at most a₃ + … < 2 of the way, never a wrap to the other side.
                let towards = Scalar::value(rail) - Scalar::value(last);
                let step = Scalar::value(out) - Scalar::value(last);
                prop_assert!(step.abs() <= 2.0 * towards.abs() + 140_000.0);
                last = out;
            }
        }
    }
}
