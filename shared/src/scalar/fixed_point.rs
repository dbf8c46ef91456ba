//! The fixed-point signal.

use core::fmt::{Debug, Formatter};
use core::ops::{Add, Mul, Neg, Sub};

use fixed::types::{I8F24, I18F14, I26F38};

use super::biquad::{self, Biquad};
use super::{Scalar, Section};
use crate::integer::mul_high_i32;
use crate::units::Position;

/// A fixed-point signal: ±131,072 in steps of 2⁻¹⁴. Addition and subtraction saturate.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(transparent)]
pub struct Fixed(I18F14);

impl Fixed {
    /// The greatest signal, 131,072 − 2⁻¹⁴.
    pub const MAX: Self = Self(I18F14::MAX);
    /// The least signal, −131,072.
    pub const MIN: Self = Self(I18F14::MIN);

    /// The signal in steps of 2⁻¹⁴.
    #[must_use]
    pub const fn to_bits(self) -> i32 {
        self.0.to_bits()
    }

    /// The signal of a number of steps of 2⁻¹⁴.
    #[must_use]
    pub const fn from_bits(bits: i32) -> Self {
        Self(I18F14::from_bits(bits))
    }
}

/// The number alone.
impl Debug for Fixed {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        self.0.fmt(f)
    }
}

/// Saturates.
impl Add for Fixed {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

/// Saturates.
impl Sub for Fixed {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl Neg for Fixed {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0)
    }
}

/// Exact.
impl Mul<I8F24> for Fixed {
    type Output = I26F38;

    fn mul(self, gain: I8F24) -> I26F38 {
        self.0.wide_mul(gain)
    }
}

/// Exact, in steps of 2⁻²⁸; the magnitude of one factor must be below [`Scalar::GAIN_LIMIT`].
impl Mul for Fixed {
    type Output = I26F38;

    #[expect(clippy::suspicious_arithmetic_impl, reason = "from 28 to 38 fraction bits")]
    fn mul(self, other: Self) -> I26F38 {
        I26F38::from_bits(i64::from(self.to_bits()).wrapping_mul(i64::from(other.to_bits())) << 10)
    }
}

/// `bits/2^SHIFT`, rounded towards −∞, saturated to within 2^(32 − SHIFT) − 1 steps of the range of 32 bits.
///
/// The upper word is saturated alone, by one instruction (`SSAT`): 3 instructions, of 8 for rounding to nearest and an exact end of
/// the range, and a tick of two axes calls this about 50 times.
pub(crate) fn narrow<const SHIFT: u32>(bits: i64) -> i32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the two words")]
    let (low, high) = (bits as u32, (bits >> 32) as i32);
    let high = high.clamp(-(1 << (SHIFT - 1)), (1 << (SHIFT - 1)) - 1);
    (high << (32 - SHIFT)) | (low >> SHIFT).cast_signed()
}

impl Section<Fixed> for Biquad {
    type State = biquad::State;

    const AT_REST: biquad::State = biquad::State::AT_REST;

    fn new(g: f64, k: f64, notch_depth: Option<f64>) -> Self {
        Self::new(g, k, notch_depth)
    }

    fn settled(value: Fixed) -> biquad::State {
        biquad::State::settled(value.to_bits())
    }

    fn step(&self, state: &mut biquad::State, input: Fixed) -> Fixed {
        Fixed::from_bits(self.step(state, input.to_bits()))
    }
}

impl Scalar for Fixed {
    type Section = Biquad;
    type Gain = I8F24;
    type Sum = I26F38;

    const ZERO: Self = Self(I18F14::ZERO);
    const ZERO_GAIN: I8F24 = I8F24::ZERO;
    const ZERO_SUM: I26F38 = I26F38::ZERO;
    const NAME: &'static str = "fixed";
    const GAIN_LIMIT: f64 = 128.0;
    const GAIN_STEP: f64 = 1.0 / 16_777_216.0;
    const SIGNAL_LIMIT: f64 = 131_072.0;
    const SIGNAL_STEP: f64 = 1.0 / 16_384.0;

    // The tick has constants. A program that is optimised for size would convert them there, by code that can panic.
    #[expect(clippy::inline_always, reason = "constants have to be converted by the compiler")]
    #[inline(always)]
    fn gain(value: f64) -> I8F24 {
        I8F24::saturating_from_num(value)
    }

    // As a gain.
    #[expect(clippy::inline_always, reason = "constants have to be converted by the compiler")]
    #[inline(always)]
    fn signal(value: f64) -> Self {
        Self(I18F14::saturating_from_num(value))
    }

    fn value(self) -> f64 {
        self.0.to_num()
    }

    fn bits(self) -> u64 {
        u64::from(self.to_bits().cast_unsigned())
    }

    fn from_distance(distance: i64) -> Self {
        Self::from_bits(narrow::<16>(distance))
    }

    fn from_increment(distance: i64) -> Self {
        Self::from_bits(narrow::<10>(distance))
    }

    fn increment_rounding(distance: i64) -> i64 {
        distance & ((1 << 10) - 1)
    }

    #[expect(clippy::cast_possible_truncation, reason = "32 bits within ±144 m")]
    fn from_position(position: Position) -> Self {
        Self::from_bits((position.0 >> 26) as i32)
    }

    fn to_distance(sum: I26F38) -> i64 {
        sum.to_bits() >> 8
    }

    fn distance(self) -> i64 {
        // The two words: one shift each, which an addition includes.
        let bits = self.to_bits();
        (i64::from(bits >> 16) << 32) | i64::from((bits << 16).cast_unsigned())
    }

    fn lerp(self, other: Self, fraction_q32: u32) -> Self {
        // From the middle of both: the fraction less a half is a signed number (`SMMLA`).
        let difference = other.to_bits().wrapping_sub(self.to_bits());
        let middle = self.to_bits().wrapping_add(difference >> 1);
        let from_middle = (fraction_q32 ^ (1 << 31)).cast_signed();
        Self::from_bits(middle.wrapping_add(mul_high_i32(difference, from_middle)))
    }

    fn gain_between(from: I8F24, to: I8F24, fraction_q32: u32) -> I8F24 {
        let difference = i64::from(to.to_bits()) - i64::from(from.to_bits());
        // At most the difference of two gains of the same sign.
        let part = ((difference * i64::from(fraction_q32)) >> 32) as i32;
        I8F24::from_bits(from.to_bits().wrapping_add(part))
    }

    fn from_fixed(value: Self) -> Self {
        value
    }

    fn to_gain(self) -> I8F24 {
        // From 14 to 24 fraction bits (`SSAT`).
        I8F24::from_bits(self.to_bits().clamp(-(1 << 21), (1 << 21) - 1) << 10)
    }

    fn widen(self) -> I26F38 {
        I26F38::from_bits(i64::from(self.to_bits()) << 24)
    }

    fn round(sum: I26F38) -> Self {
        Self::from_bits(narrow::<24>(sum.to_bits()))
    }

    fn rounding(sum: I26F38) -> I26F38 {
        I26F38::from_bits(sum.to_bits() & ((1 << 24) - 1))
    }

    fn exceeds(self, limit: Self) -> bool {
        // Both comparisons in one, as unsigned numbers, for a limit that is not negative.
        let (value, limit) = (self.to_bits(), limit.to_bits().cast_unsigned());
        value.cast_unsigned().wrapping_add(limit) > limit << 1
    }

    fn sum_exceeds(sum: I26F38, limit: Self) -> bool {
        Self::from_bits((sum.to_bits() >> 32) as i32).exceeds(Self::from_bits(limit.to_bits() >> 8))
    }

    fn product(self, other: Self) -> Self {
        Self::from_bits(narrow::<14>(i64::from(self.to_bits()).wrapping_mul(i64::from(other.to_bits()))))
    }

    fn clamp_magnitude(self, limit: Self) -> Self {
        Self(self.0.min(limit.0).max(-limit.0))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_signal_is_printed_as_its_number() {
        assert_eq!(std::format!("{:?}", Fixed::signal(-2.5)), "-2.5");
    }

    proptest! {
        /// Linear interpolation is exact but for the rounding of half a difference and of a product, each towards −∞, and exact
        /// at the first of equal numbers.
        #[test]
        fn interpolation_is_linear(from in -(1i32 << 30)..1 << 30, to in -(1i32 << 30)..1 << 30, fraction: u32) {
            let between = Fixed::from_bits(from).lerp(Fixed::from_bits(to), fraction);
            let exact = f64::from(from) + (f64::from(to) - f64::from(from)) * f64::from(fraction) / 4_294_967_296.0;
            let off = f64::from(between.to_bits()) - exact;
            prop_assert!((-1.5..=1e-6).contains(&off), "{off}");
            prop_assert_eq!(Fixed::from_bits(from).lerp(Fixed::from_bits(from), fraction), Fixed::from_bits(from));
        }

        /// Towards −∞, by less than a step of 2⁻¹⁴.
        #[test]
        fn a_product_of_signals_is_rounded_once(a in -300.0..300.0f64, b in -200.0..200.0f64) {
            let (a, b) = (Fixed::signal(a), Fixed::signal(b));
            let off = Scalar::value(a.product(b)) - Scalar::value(a) * Scalar::value(b);
            prop_assert!((-1.0 / 16_384.0 - 1e-9..=1e-9).contains(&off), "{off}");
        }

        /// 64 nm, over the whole travel of ±100 m.
        #[test]
        fn a_position_is_exact_to_its_step(m in -100.0..100.0f64) {
            let position = Position::from_m(m).unwrap();
            let off = position.to_m() - Scalar::value(Fixed::from_position(position)) * crate::units::SCALED_POSITION_M;
            prop_assert!((-1e-12..66e-9).contains(&off), "{off}");
        }

        /// A gain has the range of 7 bits and a sign; beyond it the gain saturates.
        #[test]
        fn a_signal_becomes_a_gain(bits: i32) {
            let gain = Scalar::to_gain(Fixed::from_bits(bits)).to_bits();
            let exact = i64::from(bits) << 10;
            let clamped = exact.clamp(-(1 << 31), (1 << 31) - 1);
            let tolerance = if exact == clamped { 0 } else { 1023 };
            prop_assert!((i64::from(gain) - clamped).abs() <= tolerance, "{gain}");
        }

        /// A number that is a limit, or its negative, does not exceed it.
        #[test]
        fn a_magnitude_exceeds_a_limit_or_not(bits: i32, limit in 0..i32::MAX) {
            for bits in [bits, limit, -limit, limit + 1, -limit - 1] {
                let exceeds = Fixed::from_bits(bits).exceeds(Fixed::from_bits(limit));
                prop_assert_eq!(exceeds, bits.unsigned_abs() > limit.unsigned_abs(), "{} {}", bits, limit);
            }
        }

        /// Within the range of 32 bits the number is exact; beyond it, within 255 steps of the end: over the whole range, and
        /// around both ends.
        #[test]
        fn narrow_is_a_clamp(bits in any::<i64>(), near in -(1i64 << 26)..1 << 26) {
            for bits in [bits, near, (1 << 55) + near, -(1 << 55) + near] {
                let (exact, narrow) = (bits >> 24, i64::from(narrow::<24>(bits)));
                let clamped = exact.clamp(-(1 << 31), (1 << 31) - 1);
                let tolerance = if exact == clamped { 0 } else { 255 };
                prop_assert!((narrow - clamped).abs() <= tolerance, "{bits}: {narrow}, {clamped}");
            }
        }
    }
}
