//! The one bound that control laws are generic over, and its three instances.
//!
//! A control law needs two kinds of number: a *signal* (an error, a velocity, a force) and a *gain*.
//! Their product goes into a *sum*, wide enough that nothing is lost, and is rounded to a signal
//! once, at the end. In fixed point a signal is [`I18F14`], a gain [`I8F24`] and a sum [`I26F38`]:
//! the product of 32-bit numbers is exact and one instruction (`SMULL`) on a Cortex-M. In floating
//! point the three are one type.
//!
//! A single blanket bound over `num-traits` was tried on paper first: it forces one format on
//! signals and gains, and no 32-bit format holds both 60 pm of error and a gain to 1e-7.

use core::ops::{Add, AddAssign, Neg, Sub};

use fixed::types::{I8F24, I18F14, I26F38};

/// Fixed-point signals: ±131,072 in steps of 2⁻¹⁴.
pub type Fixed = I18F14;

/// A number that control laws compute with. The units are those of [`crate::units`].
pub trait Scalar:
    Copy + Default + PartialOrd + Neg<Output = Self> + core::fmt::Debug + Send + Sync + 'static
{
    /// A constant that signals are multiplied by.
    type Gain: Copy + core::fmt::Debug + Send + Sync + 'static;
    /// What products are added up in.
    type Sum: Copy
        + Default
        + PartialOrd
        + Add<Output = Self::Sum>
        + Sub<Output = Self::Sum>
        + AddAssign
        + core::fmt::Debug
        + Send
        + Sync
        + 'static;

    /// The signal zero, for states that are made at compile time.
    const ZERO: Self;
    /// The sum zero.
    const ZERO_SUM: Self::Sum;

    /// `fixed`, `f32` or `f64`.
    const NAME: &'static str;
    /// Gains must be smaller than this, either way.
    const GAIN_LIMIT: f64;
    /// Between two neighbouring gains, where the format has an absolute step; 0 where it has none.
    const GAIN_STEP: f64;
    /// Signals must be smaller than this, either way.
    const SIGNAL_LIMIT: f64;
    /// Between two neighbouring signals, where the format has an absolute step; 0 where it has none.
    const SIGNAL_STEP: f64;

    /// The nearest gain; the caller has checked that it is finite and below [`Scalar::GAIN_LIMIT`].
    fn gain(value: f64) -> Self::Gain;
    /// The nearest signal, saturated.
    fn signal(value: f64) -> Self;
    /// The signal's value.
    fn value(self) -> f64;
    /// The bits, for comparing two runs to the last of them.
    fn bits(self) -> u64;

    /// A distance in position units as an error signal (unit 1.024 µm), rounded, saturated.
    fn from_distance(distance: i64) -> Self;
    /// A distance in position units as a per-tick increment (unit 16 nm), rounded, saturated.
    fn from_increment(distance: i64) -> Self;
    /// A sum of error signals as a distance in position units, rounded.
    fn to_distance(sum: Self::Sum) -> i64;
    /// An error signal as a distance in position units.
    fn distance(self) -> i64;
    /// The value at a part (32 fraction bits) of the way from this one to another.
    #[must_use]
    fn towards(self, other: Self, part: u32) -> Self;

    /// Signal × gain, exact in fixed point.
    fn times(self, gain: Self::Gain) -> Self::Sum;
    /// Signal × signal. In fixed point exact to 2⁻²⁸; one of them must lie within ±[`Scalar::GAIN_LIMIT`].
    fn by(self, other: Self) -> Self::Sum;
    /// The signal as a sum.
    fn widen(self) -> Self::Sum;
    /// The sum as a signal, rounded to nearest, saturated.
    fn round(sum: Self::Sum) -> Self;
    /// Signal + signal, saturated.
    #[must_use]
    fn plus(self, other: Self) -> Self;
    /// Signal − signal, saturated.
    #[must_use]
    fn minus(self, other: Self) -> Self;

    /// Whether the signal lies beyond ±limit, or is no number.
    #[must_use]
    fn exceeds(self, limit: Self) -> bool {
        !(self <= limit && self >= -limit)
    }

    /// The signal, kept within ±limit.
    #[must_use]
    fn within(self, limit: Self) -> Self;
}

/// `bits` divided by 2^`SHIFT`, rounded to nearest, saturated to 32 bits.
///
/// One comparison sees whether the upper half is the sign of the lower; a clamp of the 64-bit number takes a
/// Cortex-M 7 instructions more, and a tick of two axes comes here 26 times.
fn narrow<const SHIFT: u32>(bits: i64) -> i32 {
    let rounded = bits.wrapping_add(1 << (SHIFT - 1)) >> SHIFT;
    #[expect(clippy::cast_possible_truncation, reason = "the two halves")]
    let (low, high) = (rounded as i32, (rounded >> 32) as i32);
    if high == low >> 31 { low } else { i32::MAX ^ (high >> 31) }
}

impl Scalar for I18F14 {
    type Gain = I8F24;
    type Sum = I26F38;

    const ZERO: Self = Self::ZERO;
    const ZERO_SUM: I26F38 = I26F38::ZERO;
    const NAME: &'static str = "fixed";
    const GAIN_LIMIT: f64 = 128.0;
    const GAIN_STEP: f64 = 1.0 / 16_777_216.0;
    const SIGNAL_LIMIT: f64 = 131_072.0;
    const SIGNAL_STEP: f64 = 1.0 / 16_384.0;

    fn gain(value: f64) -> I8F24 {
        I8F24::saturating_from_num(value)
    }

    fn signal(value: f64) -> Self {
        Self::saturating_from_num(value)
    }

    fn value(self) -> f64 {
        self.to_num()
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

    fn to_distance(sum: I26F38) -> i64 {
        sum.to_bits().wrapping_add(1 << 7) >> 8
    }

    fn distance(self) -> i64 {
        i64::from(self.to_bits()) << 16
    }

    fn towards(self, other: Self, part: u32) -> Self {
        // Between two numbers of 32 bits lies one of 32 bits: nothing to saturate.
        let way = i64::from(other.to_bits()).wrapping_sub(i64::from(self.to_bits()));
        #[expect(clippy::cast_possible_truncation, reason = "no more than the way")]
        let gone = crate::integer::mul_q32(way, part) as i32;
        Self::from_bits(self.to_bits().wrapping_add(gone))
    }

    fn times(self, gain: I8F24) -> I26F38 {
        self.wide_mul(gain)
    }

    fn by(self, other: Self) -> I26F38 {
        I26F38::from_bits(i64::from(self.to_bits()).wrapping_mul(i64::from(other.to_bits())) << 10)
    }

    fn widen(self) -> I26F38 {
        I26F38::from_bits(i64::from(self.to_bits()) << 24)
    }

    fn round(sum: I26F38) -> Self {
        Self::from_bits(narrow::<24>(sum.to_bits()))
    }

    fn within(self, limit: Self) -> Self {
        self.min(limit).max(-limit)
    }

    fn plus(self, other: Self) -> Self {
        self.saturating_add(other)
    }

    fn minus(self, other: Self) -> Self {
        self.saturating_sub(other)
    }
}

macro_rules! float {
    ($float:ty, $name:literal) => {
        impl Scalar for $float {
            type Gain = $float;
            type Sum = $float;

            const ZERO: $float = 0.0;
            const ZERO_SUM: $float = 0.0;
            const NAME: &'static str = $name;
            const GAIN_LIMIT: f64 = 1e18;
            const GAIN_STEP: f64 = 0.0;
            const SIGNAL_LIMIT: f64 = 1e18;
            const SIGNAL_STEP: f64 = 0.0;

            #[expect(
                clippy::cast_possible_truncation,
                clippy::allow_attributes,
                reason = "the nearest value of the format is what is asked for"
            )]
            #[allow(unfulfilled_lint_expectations, reason = "f64 to f64 truncates nothing")]
            fn gain(value: f64) -> $float {
                value as $float
            }

            fn signal(value: f64) -> $float {
                Self::gain(value)
            }

            #[allow(
                clippy::unnecessary_cast,
                clippy::cast_lossless,
                clippy::allow_attributes,
                reason = "one source for two types"
            )]
            fn value(self) -> f64 {
                self as f64
            }

            fn bits(self) -> u64 {
                u64::from(self.to_bits())
            }

            fn from_distance(distance: i64) -> $float {
                const UNIT: $float = 1.0 / (1u64 << 30) as $float;
                distance as $float * UNIT
            }

            fn from_increment(distance: i64) -> $float {
                const UNIT: $float = 1.0 / (1u64 << 24) as $float;
                distance as $float * UNIT
            }

            #[expect(clippy::cast_possible_truncation, reason = "`as` saturates, which is what is wanted")]
            fn to_distance(sum: $float) -> i64 {
                let units = sum * (1u64 << 30) as $float;
                let half = if units < 0.0 { -0.5 } else { 0.5 };
                (units + half) as i64
            }

            fn times(self, gain: $float) -> $float {
                self * gain
            }

            fn by(self, other: $float) -> $float {
                self * other
            }

            #[allow(
                clippy::cast_lossless,
                clippy::cast_precision_loss,
                clippy::allow_attributes,
                reason = "one source for two types"
            )]
            fn towards(self, other: $float, part: u32) -> $float {
                const UNIT: $float = 1.0 / (1u64 << 32) as $float;
                self + (other - self) * (part as $float * UNIT)
            }

            fn distance(self) -> i64 {
                Self::to_distance(self)
            }

            fn widen(self) -> $float {
                self
            }

            fn round(sum: $float) -> $float {
                sum
            }

            fn within(self, limit: $float) -> $float {
                if self > limit {
                    limit
                } else if self < -limit {
                    -limit
                } else {
                    self
                }
            }

            fn plus(self, other: $float) -> $float {
                self + other
            }

            fn minus(self, other: $float) -> $float {
                self - other
            }
        }
    };
}

float!(f32, "f32");
float!(f64, "f64");

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Half a step of the signal is 2⁻¹⁵; the gain's own rounding, 2⁻²⁵, scales with the signal.
        #[test]
        fn a_product_is_rounded_once(a in -1000.0..1000.0, g in -100.0..100.0) {
            let product = <Fixed as Scalar>::round(Fixed::signal(a).times(<Fixed as Scalar>::gain(g)));
            let exact = Scalar::value(Fixed::signal(a)) * g;
            let bound = 1.0 / 32768.0 + a.abs() / f64::from(1 << 25);
            prop_assert!((Scalar::value(product) - exact).abs() <= bound * 1.000_001);
        }

        /// Over the whole range, and round both ends of that of 32 bits.
        #[test]
        fn narrows_as_a_clamp_does(bits in any::<i64>(), near in -(1i64 << 26)..1 << 26) {
            let clamped = |bits: i64| (bits.wrapping_add(1 << 23) >> 24).clamp(-(1 << 31), (1 << 31) - 1);
            for bits in [bits, near, (1 << 55) + near, -(1 << 55) + near] {
                prop_assert_eq!(i64::from(narrow::<24>(bits)), clamped(bits));
            }
        }

        /// 1/16 nm is 2¹⁶ position units: rounding loses at most half of it.
        #[test]
        fn a_distance_keeps_a_32nd_of_a_nanometre(d in -(1i64 << 46)..(1i64 << 46)) {
            let back = <Fixed as Scalar>::to_distance(Fixed::from_distance(d).widen());
            prop_assert!((back - d).abs() <= 1 << 15);
            let exact = f64::to_distance(f64::from_distance(d));
            prop_assert!((exact - d).abs() <= 1);
        }
    }

    #[test]
    fn saturates_instead_of_wrapping() {
        assert_eq!(Fixed::from_distance(i64::MAX / 2), Fixed::MAX);
        assert_eq!(Fixed::from_distance(i64::MIN / 2), Fixed::MIN);
        assert_eq!(Fixed::MAX.plus(Fixed::MAX), Fixed::MAX);
        assert_eq!(<Fixed as Scalar>::round(Fixed::MAX.times(<Fixed as Scalar>::gain(100.0))), Fixed::MAX);
    }
}
