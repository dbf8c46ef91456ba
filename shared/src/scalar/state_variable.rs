//! A second-order section as a trapezoidal state-variable filter, for floating point: its coefficients lose no precision at
//! low frequencies (Zavalishin, *The Art of VA Filter Design*, 2012).
//!
//! With input x, integrator states p and q and output w (low-pass) or x − d·k·v (notch):
//!
//! ```text
//! u = x − q,   v = a₁p + a₂u,   w = q + a₂p + a₃u,   p ← 2v − p,   q ← 2w − q,
//! a₁ = 1/(1 + g(g + k)),   a₂ = g·a₁,   a₃ = g·a₂,
//! ```
//!
//! For a constant input p = 0 and q = x, so that the gain at zero frequency is exactly one.

use super::Scalar;

/// Coefficients of a filter.
#[derive(Clone, Copy, Debug)]
pub struct StateVariable<S: Scalar> {
    a1: S::Gain,
    a2: S::Gain,
    a3: S::Gain,
    /// d·k of a notch; `None` for a low-pass.
    notch: Option<S::Gain>,
}

/// The integrators of a filter.
#[derive(Clone, Copy, Debug, Default)]
pub struct State<S: Scalar> {
    p: S::Sum,
    q: S::Sum,
}

impl<S: Scalar> State<S> {
    /// Settled at zero.
    pub const AT_REST: Self = Self { p: S::ZERO_SUM, q: S::ZERO_SUM };

    /// Settled at a constant input.
    #[must_use]
    pub fn settled(value: S) -> Self {
        Self { p: S::Sum::default(), q: value.widen() }
    }
}

impl<S: Scalar> StateVariable<S> {
    /// A low-pass filter with g = tan(πf/rate) and the coefficient k, or a notch filter of a depth d.
    #[must_use]
    pub fn new(g: f64, k: f64, notch_depth: Option<f64>) -> Self {
        let a1 = 1.0 / (1.0 + g * (g + k));
        let notch = notch_depth.map(|depth| S::gain(depth * k));
        Self { a1: S::gain(a1), a2: S::gain(g * a1), a3: S::gain(g * g * a1), notch }
    }

    /// The output for one input, once per tick.
    pub fn step(&self, state: &mut State<S>, input: S) -> S {
        let (p, q) = (S::round(state.p), S::round(state.q));
        let u = input - q;
        let v = p * self.a1 + u * self.a2;
        // w − q, so that the rounding of q does not enter.
        let w_minus_q = p * self.a2 + u * self.a3;
        state.p = v + (v - state.p);
        state.q += w_minus_q + w_minus_q;
        match self.notch {
            // The new q is q + 2(w − q).
            None => S::round(state.q - w_minus_q),
            Some(dk) => input - S::round(S::round(v) * dk),
        }
    }
}
