//! High-order position control (HPC): the following error passes a second-order filter before Kp.
//!
//! Gp = Kp · k1k2Kp² / (s² + k2·Kp·s + k1k2Kp²), k1 = 8/3, k2 = 6 (Matsubara, Hatozaki, Ibaraki). The paper prints the
//! equation with two factors Kp missing (k1k2Kp²/(s² + k2·s + k1k2Kp²)); as written here, the loop of Gp and an integrator
//! has the characteristic polynomial x³ + 6x² + 16x + 16 = (x + 2)(x² + 4x + 8), x = s/Kp: poles at −2 and −2 ± 2j.
//!
//! The states are the filtered error y and w = y'/Kp. For an input that is held over a tick T (zero-order hold) the
//! discretisation is exact. With E = e^(−3x), c = cos √7·x, s = sin √7·x/√7, x = Kp·T:
//!
//! ```text
//! y += (E(c + 3s) − 1)·(y − e) + E·s·w
//! w += −16·E·s·(y − e) + (E(c − 3s) − 1)·w
//! ```
//!
//! # Example
//!
//! The step response is y(t) = 1 − e^(−3x)·(cos √7·x + 3/√7·sin √7·x), x = Kp·t: 1.017 at x = 1.
//!
//! ```
//! use shared::control::hpc::{Hpc, State};
//!
//! let (kp, tick_s) = (33.0, 1.0 / 20_000.0);
//! let hpc = Hpc::<f64>::new(kp * tick_s);
//! let mut state = State::default();
//! // 606 ticks are x = 0.9999.
//! let filtered = (0..606).map(|_| hpc.filter(&mut state, 1.0)).last().unwrap();
//! let (x, root7) = (606.0 * kp * tick_s, 7f64.sqrt());
//! let exact = 1.0 - (-3.0 * x).exp() * ((root7 * x).cos() + 3.0 / root7 * (root7 * x).sin());
//! assert!((filtered - exact).abs() < 1e-9 && (exact - 1.017).abs() < 5e-4);
//! ```

use crate::scalar::Scalar;

/// The four coefficients of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Hpc<S: Scalar> {
    yy: S::Gain,
    yw: S::Gain,
    wy: S::Gain,
    ww: S::Gain,
}

/// The filtered error and its scaled derivative.
#[derive(Clone, Copy, Debug, Default)]
pub struct State<S: Scalar> {
    y: S::Sum,
    w: S::Sum,
    /// y, rounded to a signal.
    filtered: S,
}

impl<S: Scalar> State<S> {
    /// Settled at an error of zero.
    pub const AT_REST: Self = Self { y: S::ZERO_SUM, w: S::ZERO_SUM, filtered: S::ZERO };

    /// Settled at a constant error.
    #[must_use]
    pub fn settled(filtered: S) -> Self {
        Self { y: filtered.widen(), w: S::Sum::default(), filtered }
    }
}

impl<S: Scalar> Hpc<S> {
    /// For x = Kp·T, position gain times tick. The magnitude of each coefficient is below 16 for any x > 0.
    #[must_use]
    pub fn new(x: f64) -> Self {
        let root7 = libm::sqrt(7.0);
        let decay = libm::exp(-3.0 * x);
        let (c, s) = (libm::cos(root7 * x), libm::sin(root7 * x) / root7);
        Self {
            yy: S::gain(decay * (c + 3.0 * s) - 1.0),
            yw: S::gain(decay * s),
            wy: S::gain(-16.0 * decay * s),
            ww: S::gain(decay * (c - 3.0 * s) - 1.0),
        }
    }

    /// Model of a controller that integrates the filter by semi-implicit Euler steps (w first) shorter than a tick.
    ///
    /// `step` is Kp times the length of a step, limited to 0.1; 0 gives [`Hpc::new`]. A step h multiplies (y − e, w) by a
    /// matrix A with trace 2 − 6h − 16h² and determinant 1 − 6h. The n = x/h steps of a tick, n not necessarily whole, are
    /// Aⁿ = rⁿ(cos nθ + sin nθ/sin θ·(A/r − cos θ)), with r² = det A, 2r·cos θ = tr A and, from 4·det A − tr² A,
    /// 2r·sin θ = h·√(28 − 192h − 256h²).
    #[must_use]
    pub fn stepped(x: f64, step: f64) -> Self {
        const MIN_STEP: f64 = 1e-6;
        const MAX_STEP: f64 = 0.1;
        if step < MIN_STEP {
            return Self::new(x);
        }
        let h = step.min(MAX_STEP);
        let n = x / h;
        let det = 1.0 - 6.0 * h;
        let r = libm::sqrt(det);
        let cosine = (1.0 - 3.0 * h - 8.0 * h * h) / r;
        let sine = h * libm::sqrt(7.0 - 48.0 * h - 64.0 * h * h) / r;
        let angle = libm::atan2(sine, cosine);
        let magnitude = libm::pow(r, n);
        let (c, s) = (libm::cos(n * angle), libm::sin(n * angle) / sine);
        let entry = |a: f64, identity: f64| magnitude * (identity * c + s * (a / r - identity * cosine));
        Self {
            yy: S::gain(entry(1.0 - 16.0 * h * h, 1.0) - 1.0),
            yw: S::gain(entry(h * det, 0.0)),
            wy: S::gain(entry(-16.0 * h, 0.0)),
            ww: S::gain(entry(det, 1.0) - 1.0),
        }
    }

    /// The filtered error for an error, once per tick.
    pub fn filter(&self, state: &mut State<S>, error: S) -> S {
        let w = S::round(state.w);
        let difference = state.filtered - error;
        state.y += difference * self.yy + w * self.yw;
        state.w += difference * self.wy + w * self.ww;
        state.filtered = S::round(state.y);
        state.filtered
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Fixed;

    /// Step response of 16/(x² + 6x + 16), which has poles at −3 ± j√7.
    fn exact(t: f64) -> f64 {
        let root7 = 7f64.sqrt();
        1.0 - (-3.0 * t).exp() * ((root7 * t).cos() + 3.0 / root7 * (root7 * t).sin())
    }

    fn worst<S: Scalar>() -> f64 {
        let x = 33.0 / 20_000.0;
        let hpc = Hpc::<S>::new(x);
        let mut state = State::default();
        (1..=4000)
            .map(|k| {
                (hpc.filter(&mut state, S::signal(1000.0)).value() - 1000.0 * exact(f64::from(k) * x)).abs()
            })
            .fold(0.0, f64::max)
    }

    /// Against 20 semi-implicit Euler steps per tick.
    #[test]
    fn stepped_coefficients_equal_single_euler_steps() {
        let (x, error) = (0.05, 1000.0);
        let h = x / 20.0;
        let (hpc, exact) = (Hpc::<f64>::stepped(x, h), Hpc::<f64>::new(x));
        let [mut state, mut other] = [State::default(); 2];
        let (mut y, mut w) = (0.0, 0.0);
        for _ in 0..200 {
            for _ in 0..20 {
                w += h * (16.0 * (error - y) - 6.0 * w);
                y += h * w;
            }
            assert!((hpc.filter(&mut state, error) - y).abs() < 1e-8 * error);
            // The difference from the exact filter is of first order in h: at most 16·h of the step.
            let off = (exact.filter(&mut other, error) - y).abs();
            assert!(off < 16.0 * h * error);
        }
        assert!((Hpc::<f64>::stepped(x, 1e-5).yy - exact.yy).abs() < 1e-4);
    }

    #[test]
    fn the_step_response_matches_the_transfer_function() {
        assert!(worst::<f64>() < 1e-9);
        // Coefficients are rounded by 2⁻²⁵, accumulated over 1/x ticks: about 1000·2⁻²⁵/x, at most 0.05.
        assert!(worst::<Fixed>() < 0.05, "{}", worst::<Fixed>());
    }

    /// As the step length goes to 0 the coefficients approach those of the exact filter.
    #[test]
    fn stepped_coefficients_converge_to_the_exact_filter() {
        let x = 0.05;
        let exact = Hpc::<f64>::new(x);
        let entries = |hpc: &Hpc<f64>| [hpc.yy, hpc.yw, hpc.wy, hpc.ww];
        assert_eq!(entries(&Hpc::stepped(x, 0.0)).map(f64::to_bits), entries(&exact).map(f64::to_bits));
        for step in [1e-5, 1e-4, 1e-3] {
            let stepped = entries(&Hpc::stepped(x, step));
            for (stepped, exact) in stepped.into_iter().zip(entries(&exact)) {
                // The difference is of first order in h; the factor of each coefficient is at most 16.
                let off = (stepped - exact).abs();
                assert!(off < 16.0 * step && off > 1e-3 * step, "{stepped}, exact {exact}, step {step}");
            }
        }
        // Longer steps are limited to 0.1.
        let longest = entries(&Hpc::stepped(x, 0.1)).map(f64::to_bits);
        assert_eq!(entries(&Hpc::stepped(x, 0.5)).map(f64::to_bits), longest);
        assert_ne!(entries(&Hpc::stepped(x, 0.09)).map(f64::to_bits), longest);
    }
}
