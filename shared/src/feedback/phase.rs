//! A phase: where in its cycle a resolver, a linear scale or a counter stands.
//!
//! A cycle is 2³² steps of a `u32`, so that a phase wraps where the cycle does and the difference of
//! two is right across the wrap without a branch.
//!
//! [`Phase::from_samples`] makes one of the two windings' samples, sine and cosine:
//!
//! 1. The signs and the order of the two fold the circle to an octant, 0 ≤ short ≤ long.
//! 2. (long, short) is turned back by π/8, which leaves an angle of at most π/8 either way:
//!    u = long + tan(π/8)·short, v = short − tan(π/8)·long.
//! 3. z = v/u, by one division of 32 bits for 1/u to 2⁻¹⁵ and one step of Newton's rule to 2⁻³⁰.
//! 4. atan z/2π by an odd polynomial of degree 11, the best in the greatest error on ±tan(π/8)
//!    (Remez): it misses by at most 2·10⁻¹¹ cycle.
//! 5. The folds are undone.
//!
//! Everything is integer, so every target finds the same bits. Steps 2 to 4 lose at most 4 steps of
//! the phase together, at any amplitude: 10⁻⁹ cycle, 2 pm of a scale of 2 mm. What the converter's own
//! steps lose is more: half a count on both samples is an angle of up to 0.71/amplitude rad, 7 nm of
//! that scale with 16 bits and 27 pm with 24.

/// Where in its cycle something stands: 2³² steps a cycle, wrapping.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize,
)]
pub struct Phase(pub u32);

/// tan(π/8)·2³².
const TAN: u32 = 1_779_033_704;

/// π/8 as a phase.
const SIXTEENTH: i32 = 1 << 28;

/// atan z/2π = z·(c0 − z²·(c1 − z²·(c2 − …))), times 2³².
const ARC: [u32; 6] = [683_565_273, 227_854_666, 136_692_706, 97_231_423, 71_641_709, 39_905_100];

impl Phase {
    /// A counter of 16 bits: its whole range is a cycle.
    #[must_use]
    pub const fn from_counter(raw: u16) -> Self {
        Self((raw as u32) << 16)
    }

    /// How far this is ahead of another phase, −½ to ½ cycle: wraps with both of them.
    #[must_use]
    pub const fn difference(self, other: Self) -> i32 {
        self.0.wrapping_sub(other.0).cast_signed()
    }

    /// The phase whose sine and cosine were sampled, in converter counts with their offset taken off,
    /// from 2 bits to 32.
    ///
    /// `None`: the signal is lost. What is compared with `min_amplitude` is long + short/2, which is
    /// between 1 and 1.12 times the amplitude, so every signal of that amplitude passes, and none below
    /// 0.89 times it. A signal of zero is lost whatever is asked for. Half of the amplitude that the
    /// converter sees in good order is a fair value.
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
        let half = if cosine < 0 { (1u32 << 31).wrapping_sub(quadrant) } else { quadrant };
        Some(Self(if sine < 0 { half.wrapping_neg() } else { half }))
    }
}

/// The phase of (long, short), 0 ≤ short ≤ long, 1 ≤ long ≤ 2³¹: 0 to an eighth of a cycle.
fn octant(long: u32, short: u32) -> u32 {
    let lift = long.leading_zeros();
    // 2³⁰ ≤ x < 2³¹: u then fits 32 bits.
    let (x, y) = (long.wrapping_shl(lift) >> 1, short.wrapping_shl(lift) >> 1);
    let u = x.wrapping_add(part(TAN, y));
    let v = y.wrapping_sub(part(TAN, x)).cast_signed();

    // 2⁴⁷/u, by u rounded to 17 bits. The odd divisor is never zero, which the compiler can see.
    let reciprocal = (u32::MAX / (u >> 15 | 1)).cast_signed();
    let excess = (u64::from(reciprocal.cast_unsigned()) * u64::from(u)).wrapping_sub(1 << 47).cast_signed();
    #[expect(clippy::cast_possible_truncation, reason = "the reciprocal is right to 2⁻¹⁴, so |excess| < 2³⁴")]
    let excess = (excess >> 16) as i32;
    #[expect(clippy::cast_possible_truncation, reason = "|v/u| ≤ tan(π/8) < ½, times 2³²")]
    let rough = ((i64::from(v) * i64::from(reciprocal)) >> 15) as i32;
    let z = rough.wrapping_sub(high(rough, excess).wrapping_mul(2));

    let square = high(z, z).cast_unsigned();
    let [c0, c1, c2, c3, c4, c5] = ARC;
    // Never below zero: z² < 0.18, and every coefficient is smaller than the one before it.
    let arc = [c4, c3, c2, c1, c0].into_iter().fold(c5, |rest, c| c.wrapping_sub(part(rest, square)));
    SIXTEENTH.wrapping_add(high(z, arc.cast_signed())).cast_unsigned()
}

/// a·b/2³².
fn part(a: u32, b: u32) -> u32 {
    ((u64::from(a) * u64::from(b)) >> 32) as u32
}

/// a·b/2³², towards −∞ (`SMMUL`).
fn high(a: i32, b: i32) -> i32 {
    ((i64::from(a) * i64::from(b)) >> 32) as i32
}

#[cfg(test)]
mod tests {
    extern crate std;

    use core::f64::consts::TAU;

    use proptest::prelude::*;

    use super::*;

    const CYCLE: f64 = 4_294_967_296.0;

    /// Steps from the angle that libm finds for the same samples (right to 2⁻⁵⁰ cycle) to the phase.
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
            // Steps of the phase: 0.1 by the polynomial, and roundings: u and v 1.3, z 0.4, its
            // reciprocal 0.3, the polynomial's terms 0.6, the product 1. Half a step is what an integer
            // must lose somewhere, except where the samples know only eight or twelve angles.
            std::println!("{worst:.2} steps of 2^-32 cycle at an amplitude of {amplitude}");
            assert!(worst < 4.0, "{worst} at {amplitude}");
            assert!(worst > 0.5 || amplitude < 3.0, "{worst} at {amplitude}");
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
    fn loses_less_than_the_converter() {
        // Half a count on both samples, across the angle: √½/amplitude rad. It is nearly met somewhere
        // among 10⁵ angles, so half the bound must be exceeded.
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
            assert!(worst < bound && worst > bound / 2.0, "{worst} of {bound} with {bits} bits");
        }
    }

    #[test]
    fn a_quarter_lies_between_the_axes_at_the_ends_of_the_range() {
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
            // Rounding may take a count.
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

        /// However often both have wrapped, a lead below half a cycle is found as it is.
        #[test]
        fn a_difference_wraps(phase: u32, lead: i32) {
            let ahead = Phase(phase.wrapping_add_signed(lead));
            prop_assert_eq!(ahead.difference(Phase(phase)), lead);
        }
    }
}
