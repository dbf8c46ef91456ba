//! The number formats of the control laws: one trait, implemented for fixed point, `f32` and `f64`.
//!
//! A control law computes with three kinds of number: a *signal* (an error, a velocity, a force), a *gain*, and a *sum*
//! of products. The sum is wide enough that no product is rounded; it is rounded to a signal once, at the end.
//!
//! | | signal | gain | sum |
//! |---|---|---|---|
//! | [`Fixed`] | 18 integer, 14 fraction bits | 8, 24 ([`I8F24`](fixed::types::I8F24)) | 26, 38 ([`I26F38`](fixed::types::I26F38)) |
//! | `f32`, `f64` | itself | itself | itself |
//!
//! In fixed point, signal × gain is exact and takes one instruction on a Cortex-M (`SMULL`). Signal + signal and
//! signal − signal saturate; so does a sum that is rounded to a signal, to within 2⁻⁶ of the end of the range. Fixed point rounds
//! towards −∞, which takes two instructions less than rounding to nearest: by half a step more on the average, 31 pm of an error,
//! 0.5 nm/s of a velocity and 31 µN of a force. Zero stays zero.
//!
//! The bounds of `num-traits` do not serve: they force one format on signals and gains, and no 32-bit format
//! holds both an error of 60 pm and a gain to 1e-7.
//!
//! # Example
//!
//! ```
//! use shared::scalar::{Fixed, Scalar};
//!
//! fn proportional<S: Scalar>(gain: S::Gain, error: S) -> S {
//!     S::round(error * gain)
//! }
//!
//! assert_eq!(proportional(Fixed::gain(2.5), Fixed::signal(-4.0)), Fixed::signal(-10.0));
//! assert_eq!(proportional(2.5, -4.0), -10.0);
//! assert_eq!(Fixed::MAX + Fixed::signal(1.0), Fixed::MAX);
//! ```

mod biquad;
mod fixed_point;
mod float;
mod state_variable;

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Mul, Neg, Sub};

pub use fixed_point::Fixed;
pub(crate) use fixed_point::narrow;

use serde::{Deserialize, Serialize};

use crate::units::Position;

/// A number format, as a choice at run time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Format {
    /// Fixed point, [`Fixed`], as on the board.
    #[default]
    Fixed,
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}

/// A signal that control laws compute with, in the units of [`crate::units`].
///
/// Operators: signal ± signal (saturated), signal × gain and signal × signal (both a sum).
pub trait Scalar:
    Copy
    + Default
    + PartialOrd
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<<Self as Scalar>::Gain, Output = <Self as Scalar>::Sum>
    + Mul<Output = <Self as Scalar>::Sum>
    + Debug
    + Send
    + Sync
    + 'static
{
    /// A filter of second order, in the form that suits the format.
    type Section: Section<Self>;
    /// A constant factor.
    type Gain: Copy + Debug + Send + Sync + 'static;
    /// A sum of products.
    type Sum: Copy
        + Default
        + PartialOrd
        + Add<Output = Self::Sum>
        + Sub<Output = Self::Sum>
        + AddAssign
        + Debug
        + Send
        + Sync
        + 'static;

    /// The signal 0, usable in constants.
    const ZERO: Self;
    /// The gain 0, usable in constants.
    const ZERO_GAIN: Self::Gain;
    /// The sum 0, usable in constants.
    const ZERO_SUM: Self::Sum;

    /// `fixed`, `f32` or `f64`.
    const NAME: &'static str;
    /// Upper bound of the magnitude of a gain.
    const GAIN_LIMIT: f64;
    /// Resolution of a gain; 0 for floating point.
    const GAIN_STEP: f64;
    /// Upper bound of the magnitude of a signal.
    const SIGNAL_LIMIT: f64;
    /// Resolution of a signal; 0 for floating point.
    const SIGNAL_STEP: f64;

    /// The nearest gain. The caller has checked that `value` is finite and below [`Scalar::GAIN_LIMIT`].
    fn gain(value: f64) -> Self::Gain;
    /// The nearest signal, saturated.
    fn signal(value: f64) -> Self;
    /// The value of the signal.
    fn value(self) -> f64;
    /// The bits, for comparing two runs exactly.
    fn bits(self) -> u64;

    /// A distance in position units as an error signal (unit 1.024 µm), rounded (in fixed point towards −∞), saturated.
    fn from_distance(distance: i64) -> Self;
    /// A distance in position units as an increment per tick (unit 16 nm), rounded (in fixed point towards −∞), saturated.
    fn from_increment(distance: i64) -> Self;
    /// What the rounding of [`Scalar::from_increment`] leaves of a distance that it does not saturate, position units: not negative, and less than
    /// a step. 0 in floating point, whose signals have no step.
    fn increment_rounding(distance: i64) -> i64;
    /// A position in units of [`SCALED_POSITION_M`](crate::units::SCALED_POSITION_M), rounded towards −∞; exact to 64 nm within
    /// the travel of [`TRAVEL_LIMIT_M`](crate::units::TRAVEL_LIMIT_M).
    fn from_position(position: Position) -> Self;
    /// A sum of error signals as a distance in position units, rounded.
    fn to_distance(sum: Self::Sum) -> i64;
    /// An error signal as a distance in position units.
    fn distance(self) -> i64;
    /// Linear interpolation from `self` to `other`; `fraction_q32` has 32 fraction bits. The difference must be below
    /// [`Scalar::SIGNAL_LIMIT`]. In fixed point the result is too small by up to two steps.
    #[must_use]
    fn lerp(self, other: Self, fraction_q32: u32) -> Self;

    /// Linear interpolation between two gains that are not negative; `fraction_q32` has 32 fraction bits. In fixed point rounded towards −∞.
    #[must_use]
    fn gain_between(from: Self::Gain, to: Self::Gain, fraction_q32: u32) -> Self::Gain;

    /// The signal of a fixed-point one, rounded to the nearest value of the format.
    fn from_fixed(value: Fixed) -> Self;
    /// The signal as a gain; its magnitude must be below [`Scalar::GAIN_LIMIT`], or it saturates.
    fn to_gain(self) -> Self::Gain;
    /// The signal as a sum.
    fn widen(self) -> Self::Sum;
    /// The sum as a signal, rounded (in fixed point towards −∞), saturated.
    fn round(sum: Self::Sum) -> Self;

    /// What the rounding of [`Scalar::round`] leaves of a sum that it does not saturate: not negative, and less than a step of a signal. 0 in
    /// floating point.
    fn rounding(sum: Self::Sum) -> Self::Sum;

    /// Whether the magnitude of the signal exceeds `limit`, which is not negative; true for a NaN.
    #[must_use]
    fn exceeds(self, limit: Self) -> bool {
        !(self <= limit && self >= -limit)
    }

    /// Whether the magnitude of a sum exceeds `limit`, which is not negative; in fixed point to within 2⁻⁶.
    #[must_use]
    fn sum_exceeds(sum: Self::Sum, limit: Self) -> bool;

    /// The product of two signals, rounded; its magnitude must be below half of [`Scalar::SIGNAL_LIMIT`], or it saturates.
    #[must_use]
    fn product(self, other: Self) -> Self {
        Self::round(self * other)
    }

    /// The signal, limited to ±`limit`.
    #[must_use]
    fn clamp_magnitude(self, limit: Self) -> Self;
}

/// A filter of second order, discretised by the bilinear transform.
pub trait Section<S>: Copy + Debug + Send + Sync + 'static {
    /// What it keeps from tick to tick.
    type State: Copy + Debug + Send + Sync + 'static;

    /// The state settled at an input of zero.
    const AT_REST: Self::State;

    /// A low-pass filter ω₀²/(s² + kω₀s + ω₀²) with g = tan(πf/rate), or a notch filter 1 − d·kω₀s/(s² + kω₀s + ω₀²) of a
    /// depth d.
    fn new(g: f64, k: f64, notch_depth: Option<f64>) -> Self;
    /// The state settled at a constant input.
    fn settled(value: S) -> Self::State;
    /// The output for one input, once per tick.
    fn step(&self, state: &mut Self::State, input: S) -> S;
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Towards −∞, by less than a signal step of 2⁻¹⁴; the rounding of the gain, 2⁻²⁵, is multiplied by the signal.
        #[test]
        fn a_product_is_rounded_once(a in -1000.0..1000.0, g in -100.0..100.0) {
            let product = Fixed::round(Fixed::signal(a) * Fixed::gain(g));
            let exact = Fixed::signal(a).value() * g;
            let of_gain = a.abs() / f64::from(1 << 25) * 1.000_001;
            let off = product.value() - exact;
            prop_assert!((-1.0 / 16384.0 - of_gain..=of_gain).contains(&off), "{off}");
        }

        /// The signal resolves 1/16 nm, 2¹⁶ position units: the rounding error, towards −∞, is below that.
        #[test]
        fn a_distance_is_rounded_by_less_than_a_16th_of_a_nanometre(d in -(1i64 << 46)..(1i64 << 46)) {
            let back = Fixed::to_distance(Fixed::from_distance(d).widen());
            prop_assert!((0..1 << 16).contains(&(d - back)));
            let exact = f64::to_distance(f64::from_distance(d));
            prop_assert!((exact - d).abs() <= 1);
        }
    }

    #[test]
    fn saturates_instead_of_wrapping() {
        assert_eq!(Fixed::MAX + Fixed::MAX, Fixed::MAX);
        // A distance to within 2¹⁶ of 2³² and a product to within 2⁸ of 2³² of the range.
        let off = |value: Fixed, end: Fixed| (value.value() - end.value()).abs();
        assert!(off(Fixed::from_distance(i64::MAX / 2), Fixed::MAX) < 4.0);
        assert!(off(Fixed::from_distance(i64::MIN / 2), Fixed::MIN) < 4.0);
        assert!(off(Fixed::round(Fixed::MAX * Fixed::gain(100.0)), Fixed::MAX) < 1.0 / 64.0);
    }
}
