//! Products of integers as fractions: the arithmetic that interpolation and scalars share.
//!
//! A suffix `q32` marks a fraction with 32 fraction bits: 2³² stands for 1.

/// `value·fraction/2³²`, rounded towards −∞.
#[must_use]
pub(crate) fn mul_q32(value: i64, fraction_q32: u32) -> i64 {
    let (high, low) = (value >> 32, value & 0xffff_ffff);
    let low = (low.cast_unsigned() * u64::from(fraction_q32)) >> 32;
    (high.wrapping_mul(i64::from(fraction_q32))).wrapping_add(low.cast_signed())
}

/// `value·fraction/2³²`, rounded towards −∞, by four 32-bit products.
#[must_use]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the four 32-bit words")]
pub(crate) fn wide_mul_q32(value: i128, fraction_q32: u32) -> i128 {
    let fraction = u64::from(fraction_q32);
    let word = |shift: u32| u64::from((value >> shift) as u32);
    // Each product takes the upper word of the one before (`UMLAL`): none overflows.
    let first = word(32) * fraction + ((word(0) * fraction) >> 32);
    let second = word(64) * fraction + (first >> 32);
    let third = (value >> 96) as i64 * i64::from(fraction_q32) + (second >> 32).cast_signed();
    i128::from(third) << 64 | i128::from(second & 0xffff_ffff) << 32 | i128::from(first & 0xffff_ffff)
}

/// `a·b/2^SHIFT`, rounded once, to nearest.
#[must_use]
pub(crate) fn mul_shift<const SHIFT: u32>(a: i64, b: i64) -> i64 {
    let product = i128::from(a) * i128::from(b) + (1 << (SHIFT - 1));
    #[expect(clippy::cast_possible_truncation, reason = "callers keep |a·b| below 2^(63 + SHIFT)")]
    let scaled = (product >> SHIFT) as i64;
    scaled
}

/// A number as two signed words: value = 2³²·upper + lower.
///
/// With both signed, a product of two words is one instruction (`SMULL`, `SMLAL`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Words {
    upper: i32,
    lower: i32,
}

impl Words {
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "the words")]
    pub(crate) const fn of(value: i64) -> Self {
        Self { upper: (value.wrapping_add(1 << 31) >> 32) as i32, lower: value as i32 }
    }

    /// Upper and cross terms of the product with `other`, 2⁶⁴ and 2³².
    fn product(self, other: Self) -> [i64; 2] {
        let word = |a: i32, b: i32| i64::from(a) * i64::from(b);
        [
            word(self.upper, other.upper),
            word(self.upper, other.lower).wrapping_add(word(self.lower, other.upper)),
        ]
    }

    /// `a·b/2⁶⁴`, off by up to 1.25 units, for magnitudes up to 2⁶³ − 2³¹: the product of the lower words is omitted.
    #[must_use]
    pub(crate) fn mul_high(self, other: Self) -> i64 {
        let [upper, cross] = self.product(other);
        upper.wrapping_add(cross >> 32)
    }
}

/// `a·b/2⁶²`, rounded once, to nearest, for a below 2⁶¹ and b up to 2⁶² in magnitude.
#[must_use]
pub(crate) fn mul_62(a: i64, b: i64) -> i64 {
    let (a, b) = (Words::of(a << 2), Words::of(b));
    let [upper, cross] = a.product(b);
    let below = (i64::from(a.lower) * i64::from(b.lower)) >> 32;
    upper.wrapping_add(cross.wrapping_add(below).wrapping_add(1 << 31) >> 32)
}

/// [`Words::mul_high`].
#[must_use]
pub(crate) fn mul_high(a: i64, b: i64) -> i64 {
    Words::of(a).mul_high(Words::of(b))
}

/// `a·b/2^shift` modulo 2⁶⁴, for a shift from 32 to 63.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "the words")]
pub(crate) fn shifted_product(a: u64, b: u64, shift: u32) -> u64 {
    let product = u128::from(a) * u128::from(b);
    let (low, middle, high) = ((product >> 32) as u32, (product >> 64) as u32, (product >> 96) as u32);
    let shift = shift & 31;
    // A shift by 32 in two steps: there is none in one.
    let shifted = |low: u32, high: u32| (low >> shift) | ((high << 1) << (31 - shift));
    u64::from(shifted(low, middle)) | u64::from(shifted(middle, high)) << 32
}

/// `value·2^−shift`, at most `u32::MAX`, for a shift below 32.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "the two words")]
pub(crate) const fn shifted(value: u64, shift: u32) -> u32 {
    let (low, high, shift) = (value as u32, (value >> 32) as u32, shift & 31);
    if high >> shift != 0 {
        return u32::MAX;
    }
    // A shift by 32 in two steps: there is none in one.
    (low >> shift) | ((high << 1) << (31 - shift))
}

/// `value·2^−shift`, rounded towards −∞, saturated to 32 bits, for a shift below 32.
#[must_use]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the words")]
pub(crate) const fn shifted_signed(value: i64, shift: u32) -> i32 {
    let (low, high, shift) = (value as u32, (value >> 32) as i32, shift & 31);
    let shifted = ((low >> shift) | ((high.cast_unsigned() << 1) << (31 - shift))).cast_signed();
    if high >> shift == shifted >> 31 { shifted } else { i32::MAX ^ (high >> 31) }
}

/// `a·b/2³²`, rounded towards 0 (`UMULL`).
#[must_use]
pub(crate) const fn mul_high_u32(a: u32, b: u32) -> u32 {
    ((a as u64 * b as u64) >> 32) as u32
}

/// `a·b/2³²`, rounded towards −∞ (`SMMUL`).
#[must_use]
pub(crate) const fn mul_high_i32(a: i32, b: i32) -> i32 {
    ((a as i64 * b as i64) >> 32) as i32
}

/// Linear interpolation between two numbers whose difference has 32 bits, to two units.
#[must_use]
pub(crate) const fn interpolated_q31(from: i32, to: i32, fraction_q32: u32) -> i32 {
    let half = mul_high_i32(to.wrapping_sub(from), (fraction_q32 >> 1).cast_signed());
    from.wrapping_add(half << 1)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;

    use super::*;

    /// The distance of a result from a·b + c·d over 2^shift, in units.
    fn off(result: i64, [a, b, c, d]: [i64; 4], shift: i32) -> f64 {
        let exact = i128::from(a) * i128::from(b) + i128::from(c) * i128::from(d);
        let off = (i128::from(result) << shift) - exact;
        off as f64 / f64::from(shift).exp2()
    }

    fn below(bits: u32) -> std::ops::Range<i64> {
        -(1 << bits)..1 << bits
    }

    proptest! {
        /// The product of the lower words is omitted, at most 2⁻² units, and the rest is rounded towards −∞.
        #[test]
        fn the_upper_part_of_a_product_is_near(a in below(62), b in below(62)) {
            let off = off(mul_high(a, b), [a, b, 0, 0], 64);
            prop_assert!((-1.25..=0.25).contains(&off), "{off}");
        }

        #[test]
        fn a_wide_product_is_rounded_down(value in -(1i128 << 126)..1 << 126, fraction: u32) {
            let words = [value >> 32, value & 0xffff_ffff];
            let [upper, lower] = words.map(|word| word * i128::from(fraction));
            prop_assert_eq!(wide_mul_q32(value, fraction), upper + (lower >> 32));
        }

        /// Rounded to nearest but for 2⁻³² of a unit, the part of the lower words that is omitted.
        #[test]
        fn a_product_with_a_direction_is_rounded_to_nearest(a in below(61), b in below(62)) {
            let off = off(mul_62(a, b), [a, b, 0, 0], 62);
            prop_assert!(off.abs() <= 0.5 + 1e-9, "{off}");
        }

        #[test]
        fn a_shifted_product_is_that_of_128_bits(a: u64, b: u64, shift in 32u32..64) {
            #[expect(clippy::cast_possible_truncation, reason = "modulo 2⁶⁴")]
            let exact = ((u128::from(a) * u128::from(b)) >> shift) as u64;
            prop_assert_eq!(shifted_product(a, b, shift), exact);
        }

        #[test]
        fn words_are_their_number(value in below(62)) {
            let words = Words::of(value);
            prop_assert_eq!((i64::from(words.upper) << 32) + i64::from(words.lower), value);
        }
    }

    /// 1 and −1 as a sine or cosine: a rotation by quarter turns is exact.
    #[test]
    fn a_product_with_one_is_exact() {
        for a in [1i64 << 4, -(1 << 4), 12_345_678_901_234 << 4, i64::MAX >> 3 & !15] {
            for one in [1i64 << 62, -(1 << 62)] {
                assert_eq!(mul_high(a, one), if one > 0 { a >> 2 } else { -(a >> 2) });
                assert_eq!(mul_62(a >> 4, one), if one > 0 { a >> 4 } else { -(a >> 4) });
            }
        }
    }

    /// To the nearest multiple, also of values whose half decides: 0.5 is 1 and −0.5 is 0.
    #[test]
    fn a_scaled_product_is_rounded_to_nearest() {
        for (a, b, rounded) in
            [(3, 5, 2), (1, 4, 1), (1, 3, 0), (-1, 4, 0), (-1, 5, -1), (-3, 5, -2), (7, 7, 6)]
        {
            assert_eq!(mul_shift::<3>(a, b), rounded, "{a}·{b}/8");
        }
    }

    /// The values next to those that saturate, and beyond them.
    #[test]
    fn a_shifted_number_saturates() {
        for shift in 0..32 {
            let exact = |value: i64| (value >> shift).clamp(i64::from(i32::MIN), i64::from(i32::MAX));
            let ends = [i64::from(i32::MIN) << shift, (i64::from(i32::MAX) + 1) << shift, i64::MIN, i64::MAX];
            for value in ends.into_iter().flat_map(|end| [end, end.saturating_sub(1), end.saturating_add(1)])
            {
                assert_eq!(i64::from(shifted_signed(value, shift)), exact(value), "{value} {shift}");
            }
        }
    }
}
