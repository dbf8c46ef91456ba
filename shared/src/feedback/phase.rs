//! Phases: the position of a resolver, a linear scale or a counter within its cycle.
//!
//! A cycle is 2³² steps of a `u32`, so that a phase wraps with the cycle and the difference of two phases is right across
//! the wrap without a branch.
//!
//! [`Phase::from_samples`] computes the phase of a sine and a cosine sample:
//!
//! 1. Signs and order of the two fold the circle to an octant, 0 ≤ short ≤ long.
//! 2. (long, short) is rotated by −π/8, so that the angle is within ±π/8:
//!    u = long + tan(π/8)·short, v = short − tan(π/8)·long.
//! 3. z = v/u, by a 32-bit division for 1/u to 2⁻¹⁵ and one Newton iteration to 2⁻³⁰.
//! 4. atan z/2π by the odd minimax polynomial of degree 11 on ±tan(π/8) (Remez): the error is at most 2·10⁻¹¹ cycle.
//! 5. The folds are undone.
//!
//! In integer arithmetic, every target gets the same bits. The total error of steps 2 to 4 is at most 4 steps of the phase
//! at any amplitude: 10⁻⁹ cycle, 2 pm for a scale of 2 mm pitch. The quantisation of the converter has a greater error: half a
//! count on both samples is an angle of up to 0.71/amplitude rad, 7 nm for that scale with 16 bits and 27 pm with 24.
//!
//! # Example
//!
//! ```
//! use shared::feedback::phase::Phase;
//!
//! let eighth = Phase::from_samples(20_000, 20_000, 10_000).unwrap();
//! assert!(eighth.difference(Phase(1 << 29)).abs() < 4);
//! assert_eq!(Phase::from_samples(20, -30, 10_000), None); // signal lost
//! ```

/// A phase: 2³² steps per cycle, wrapping.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize,
)]
pub struct Phase(pub u32);

/// tan(π/8)·2³².
const TAN_PI_8: u32 = 1_779_033_704;

/// π/8 as a phase, a sixteenth of a cycle.
const PI_8: i32 = 1 << 28;

/// atan z/2π = z·(c0 − z²·(c1 − z²·(c2 − …))), times 2³².
const ATAN: [u32; 6] = [683_565_273, 227_854_666, 136_692_706, 97_231_423, 71_641_709, 39_905_100];

impl Phase {
    /// The phase of a 16-bit counter whose range is a cycle.
    #[must_use]
    pub const fn from_counter(raw: u16) -> Self {
        Self((raw as u32) << 16)
    }

    /// The difference to another phase, −½ to ½ cycle.
    #[must_use]
    pub const fn difference(self, other: Self) -> i32 {
        self.0.wrapping_sub(other.0).cast_signed()
    }

    /// The phase of a sine and a cosine sample, in converter counts (2 to 32 bits) without their offset.
    ///
    /// `None`: the signal is lost. long + short/2, which is 1 to 1.12 times the amplitude, is compared with
    /// `min_amplitude`: a signal with that amplitude is always accepted, one below 0.89 times it never, and neither is a
    /// signal of zero. Half the nominal amplitude is a reasonable value.
    #[must_use]
    pub fn from_samples(sine: i32, cosine: i32, min_amplitude: u32) -> Option<Self> {
        let (across, along) = (sine.unsigned_abs(), cosine.unsigned_abs());
        let steep = across > along;
        let (long, short) = if steep { (across, along) } else { (along, across) };
        if long.wrapping_add(short >> 1) < min_amplitude.max(1) {
            return None;
        }
        let octant = octant(long, short);
        let quadrant = if steep { (1u32 << 30).wrapping_sub(octant) } else { octant };
        let half = if cosine.is_negative() { (1u32 << 31).wrapping_sub(quadrant) } else { quadrant };
        Some(Self(if sine.is_negative() { half.wrapping_neg() } else { half }))
    }
}

/// The phase of (long, short), 0 ≤ short ≤ long, 1 ≤ long ≤ 2³¹: 0 to 1/8 cycle.
fn octant(long: u32, short: u32) -> u32 {
    let normalisation = long.leading_zeros();
    // 2³⁰ ≤ x < 2³¹, so that u fits into 32 bits.
    let (x, y) = (long.wrapping_shl(normalisation) >> 1, short.wrapping_shl(normalisation) >> 1);
    let u = x.wrapping_add(mul_high(TAN_PI_8, y));
    let v = y.wrapping_sub(mul_high(TAN_PI_8, x)).cast_signed();

    // 2⁴⁷/u from u rounded to 17 bits. The divisor is odd, so the compiler knows that it is not zero.
    let reciprocal = (u32::MAX / (u >> 15 | 1)).cast_signed();
    let excess = (u64::from(reciprocal.cast_unsigned()) * u64::from(u)).wrapping_sub(1 << 47).cast_signed();
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the relative error of the reciprocal is below 2⁻¹⁴: |excess| < 2³⁴"
    )]
    let excess = (excess >> 16) as i32;
    #[expect(clippy::cast_possible_truncation, reason = "|v/u| ≤ tan(π/8) < ½, times 2³²")]
    let rough = ((i64::from(v) * i64::from(reciprocal)) >> 15) as i32;
    let z = rough.wrapping_sub(mul_high_signed(rough, excess).wrapping_mul(2));

    let square = mul_high_signed(z, z).cast_unsigned();
    let [c0, c1, c2, c3, c4, c5] = ATAN;
    // Horner's scheme. No difference is negative: z² < 0.18, and the coefficients decrease.
    let ratio = [c4, c3, c2, c1, c0].into_iter().fold(c5, |sum, c| c.wrapping_sub(mul_high(sum, square)));
    PI_8.wrapping_add(mul_high_signed(z, ratio.cast_signed())).cast_unsigned()
}

/// a·b/2³².
fn mul_high(a: u32, b: u32) -> u32 {
    ((u64::from(a) * u64::from(b)) >> 32) as u32
}

/// a·b/2³², rounded towards −∞ (`SMMUL`).
fn mul_high_signed(a: i32, b: i32) -> i32 {
    ((i64::from(a) * i64::from(b)) >> 32) as i32
}

#[cfg(test)]
mod tests {
    extern crate std;

    use core::f64::consts::TAU;

    use proptest::prelude::*;

    use super::*;

    const CYCLE: f64 = 4_294_967_296.0;

    /// Difference in steps from the angle by libm (exact to 2⁻⁵⁰ cycle).
    fn error(sine: i32, cosine: i32) -> f64 {
        let found = f64::from(Phase::from_samples(sine, cosine, 1).unwrap().0);
        let exact = f64::from(sine).atan2(f64::from(cosine)) / TAU * CYCLE;
        (found - exact + CYCLE / 2.0).rem_euclid(CYCLE) - CYCLE / 2.0
    }

    #[expect(clippy::cast_possible_truncation, reason = "an amplitude of at most 2³¹ − 1")]
    fn samples(angle: f64, amplitude: f64) -> (i32, i32) {
        ((amplitude * angle.sin()).round() as i32, (amplitude * angle.cos()).round() as i32)
    }

    #[test]
    #[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
    fn finds_the_angle_of_the_samples_all_around_at_every_amplitude() {
        for amplitude in [1.0, 2.0, 7.0, 1000.0, 32_767.0, 524_287.0, 8_388_607.0, 2_147_483_647.0] {
            let mut worst = 0.0f64;
            for k in 0..100_000 {
                let (sine, cosine) = samples(TAU * f64::from(k) / 100_000.0, amplitude);
                worst = worst.max(error(sine, cosine).abs());
            }
            // Error budget in steps: polynomial 0.1; rounding of u and v 1.3, of z 0.4, of the reciprocal 0.3, of the terms of
            // the polynomial 0.6, of the product 1. The rounding to an integer reaches half a step, except for amplitudes
            // with only eight or twelve angles.
            std::println!("{worst:.2} steps of 2^-32 cycle at an amplitude of {amplitude}");
            assert!(worst < 4.0, "{worst} at {amplitude}");
            assert!(worst > 0.5 || amplitude < 3.0, "{worst} at {amplitude}");
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
    fn the_phase_error_is_below_that_of_the_converter() {
        // Half a count on both samples, perpendicular to the vector, is √½/amplitude rad. Among 10⁵ angles one is close to the
        // worst case, so half the bound must be exceeded.
        for bits in [16, 20, 24] {
            let amplitude = f64::from((1 << (bits - 1)) - 1);
            let mut worst = 0.0f64;
            for k in 0..100_000 {
                let angle = TAU * (f64::from(k) + 0.3) / 100_000.0;
                let (sine, cosine) = samples(angle, amplitude);
                let found = f64::from(Phase::from_samples(sine, cosine, 1).unwrap().0) / CYCLE * TAU;
                worst = worst.max(((found - angle + 3.0).rem_euclid(TAU) - 3.0).abs());
            }
            let bound = 0.5f64.sqrt() / amplitude + 4.0 / CYCLE * TAU;
            assert!(worst < bound && worst > bound / 2.0, "{worst}, bound {bound}, {bits} bits");
        }
    }

    #[test]
    fn multiples_of_an_eighth_are_exact_at_both_ends_of_the_range() {
        let steps = [(0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)];
        for (eighth, (sine, cosine)) in (0u32..).zip(steps) {
            for amplitude in [1, i32::MAX] {
                let found = Phase::from_samples(sine * amplitude, cosine * amplitude, 1).unwrap();
                assert!(found.difference(Phase(eighth << 29)).abs() < 4, "{eighth}: {found:?}");
            }
        }
        assert!(error(i32::MIN, i32::MIN).abs() < 4.0 && error(i32::MAX, i32::MIN).abs() < 4.0);
    }

    #[test]
    fn a_weak_signal_is_lost() {
        assert_eq!(Phase::from_samples(0, 0, 0), None);
        for k in 0..1000 {
            let angle = TAU * f64::from(k) / 1000.0;
            // Rounding may reduce a sample by a count.
            let (sine, cosine) = samples(angle, 10_002.0);
            assert!(Phase::from_samples(sine, cosine, 10_000).is_some());
            let (sine, cosine) = samples(angle, 8_900.0);
            assert_eq!(Phase::from_samples(sine, cosine, 10_000), None);
        }
    }

    proptest! {
        #[test]
        fn any_pair_of_samples(sine: i32, cosine: i32, fewer in 0u32..31) {
            let (sine, cosine) = (sine >> fewer, cosine >> fewer);
            prop_assume!((sine, cosine) != (0, 0));
            prop_assert!(error(sine, cosine).abs() < 4.0);
        }

        /// A lead below half a cycle is exact across any wrap.
        #[test]
        fn a_difference_wraps(phase: u32, lead: i32) {
            let ahead = Phase(phase.wrapping_add_signed(lead));
            prop_assert_eq!(ahead.difference(Phase(phase)), lead);
        }
    }
}
