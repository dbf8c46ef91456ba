//! Velocity by a tracking observer, in place of the difference of two readings.
//!
//! A tracking loop of type 2, also called a PLL, with estimates p of the position and v of the increment per tick T, for the reading y:
//!
//! ```text
//! e = y − p − v,   p ← p + v + a·e,   v ← v + b·e,   a = 1 − r²,   b = (1 − r)²,   r = e^(−ωT).
//! ```
//!
//! ω/2π is its bandwidth. Both poles are at r: the loop is the one with the gains 2ζω and ω² and ζ = 1, exactly at every tick rate (a ≈ 2ωT,
//! b ≈ (ωT)²). With ζ = 1 the estimate of a velocity that changes does not overshoot; ζ = 1/√2 would be 30 % less late at low
//! frequencies, with an overshoot of 4 % and, at the same ω, a noise that is higher by a fifth.
//!
//! Eliminating e and p (z is the delay of a tick backwards):
//!
//! ```text
//! v/y = b·z(z − 1)/(z² − (2 − a − b)·z + 1 − a) = (1 − 1/z)·((1 − r)/(1 − r/z))².
//! ```
//!
//! The estimate of the loop with ζ = 1 is the difference of the readings behind two equal low-passes of first order. It is
//! computed in this form:
//!
//! ```text
//! d ← velocity of the difference,   x₁ ← x₁ + (1 − r)(d − x₁),   x₂ ← x₂ + (1 − r)(x₁ − x₂),   velocity = x₂.
//! ```
//!
//! | | difference | observer |
//! |---|---|---|
//! | mean age beyond that of the difference | 0 | 2r/(1 − r) ticks, about 2/ω |
//! | gain and phase at a frequency f far below the tick rate | 1, 0 | 1/(1 + (f/f₀)²), −2·arctan(f/f₀) with the bandwidth f₀ |
//! | greatest velocity for a step q of the reading | q/T | about q·ω/e (e = 2.718), after 1/ω |
//! | rms for white noise of the reading, q rms | √2·q/T | q/T·√(2(1 − r)³/(1 + r)³), about ½q·√((ωT)³)/T |
//!
//! **Numbers.** A stage has no position, so that neither a new origin nor a long way changes it, and there is nothing to wind up: it holds
//! velocities between the least and the greatest that it got. In fixed point what the rounding of an increment and of a velocity leaves is
//! kept for the next tick ([`Scalar::increment_rounding`], [`Scalar::rounding`]), and the product of a stage is not rounded. So the sum of the
//! estimates times T is the distance travelled, to within a bound that does not grow with time. At a constant input u a stage moves as long
//! as its output, x rounded towards −∞, is not u; it moves towards u, by less than the difference: it comes to u, and stays. At
//! standstill the estimate ends at 0, exactly.
//!
//! Sources: poles of the α-β filter: Benedict, Bordner, *Synthesis of an optimal set of radar track-while-scan smoothing equations*
//! (IRE Transactions on Automatic Control, 1962). Equal poles, gains 2ω and ω², are usual in drives, as in the firmware of `ODrive` and of moteus.
//!
//! # Example
//!
//! 300 Hz at 20 kHz. For one encoder count of 0.25 µm the difference is 5 mm/s in one tick; the estimate rises to 0.173 mm/s and is back
//! at 0 afterwards.
//!
//! ```
//! use shared::control::observer::{Observer, State};
//!
//! let observer = Observer::<f64>::new(300.0 / 20_000.0);
//! let mut state = State::at(0.0);
//! let mm_per_s = |state: &mut State<f64>, difference: f64| observer.step(state, difference);
//! let mut greatest = mm_per_s(&mut state, 5.0);
//! for _ in 0..1000 {
//!     greatest = mm_per_s(&mut state, 0.0).max(greatest);
//! }
//! assert!((0.173..0.174).contains(&greatest), "{greatest}");
//! assert!(mm_per_s(&mut state, 0.0).abs() < 1e-30);
//! ```

use crate::scalar::Scalar;

/// Least bandwidth over the tick rate, that of the other filters: the velocity is 318 ticks old.
pub const LEAST_RATIO: f64 = 1e-3;

/// Greatest bandwidth over the tick rate. The velocity is half a tick old there, as the mean of two differences is
/// ([`velocity_lag_s`](crate::config::AxisSettings::velocity_lag_s)), and an encoder count 0.63 times that of the difference.
pub const GREATEST_RATIO: f64 = 0.25;

/// 1 − r of a bandwidth over the tick rate.
#[must_use]
pub fn gain(bandwidth_ratio: f64) -> f64 {
    -libm::expm1(-2.0 * core::f64::consts::PI * bandwidth_ratio)
}

/// Constants of an observer.
#[derive(Clone, Copy, Debug)]
pub struct Observer<S: Scalar> {
    /// 1 − r.
    gain: S::Gain,
}

/// The stages of an observer, in the units of the velocity.
#[derive(Clone, Copy, Debug)]
pub struct State<S: Scalar> {
    first: S::Sum,
    second: S::Sum,
    /// What the rounding of the difference has left.
    rounding: S::Sum,
}

impl<S: Scalar> State<S> {
    /// At standstill.
    pub const AT_REST: Self = Self { first: S::ZERO_SUM, second: S::ZERO_SUM, rounding: S::ZERO_SUM };

    /// Settled at a constant velocity.
    #[must_use]
    pub fn at(velocity: S) -> Self {
        Self { first: velocity.widen(), second: velocity.widen(), ..Self::AT_REST }
    }
}

impl<S: Scalar> Observer<S> {
    /// An observer with a bandwidth over the tick rate, [`LEAST_RATIO`] to [`GREATEST_RATIO`].
    #[must_use]
    pub fn new(bandwidth_ratio: f64) -> Self {
        Self { gain: S::gain(gain(bandwidth_ratio)) }
    }

    /// The velocity for that of the difference, which is not rounded yet. Once per tick.
    pub fn step(&self, state: &mut State<S>, difference: S::Sum) -> S {
        let difference = difference + state.rounding;
        state.rounding = S::rounding(difference);
        let first = self.stage(&mut state.first, S::round(difference));
        self.stage(&mut state.second, first)
    }

    /// A low-pass of first order.
    fn stage(&self, x: &mut S::Sum, input: S) -> S {
        *x += (input - S::round(*x)) * self.gain;
        S::round(*x)
    }
}
