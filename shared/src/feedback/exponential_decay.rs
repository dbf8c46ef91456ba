//! A distance that decays exponentially, in integers, to exactly zero.

/// An exponential decay.
///
/// Holds the fraction of a distance that decays per tick, 1 − e^(−tick/time constant), times 2³².
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExponentialDecay(u32);

impl ExponentialDecay {
    /// From a time constant in ticks, above 0.
    #[must_use]
    pub fn new(ticks: f64) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a fraction of 1 saturates"
        )]
        Self((libm::rint(-libm::expm1(-1.0 / ticks) * 4_294_967_296.0) as u32).max(1))
    }

    /// The distance a tick later: at least one unit nearer to zero, and never past it.
    #[must_use]
    pub fn step(self, distance: i64) -> i64 {
        // The usual case.
        if distance == 0 {
            return 0;
        }
        // The product of 32 and 64 bits, without its lowest 32: rounded towards −∞, so a positive one needs one more.
        #[expect(
            clippy::cast_sign_loss,
            clippy::cast_possible_truncation,
            reason = "the low half, whatever the sign"
        )]
        let low = (u64::from(self.0) * u64::from(distance as u32)) >> 32;
        let high = i64::from(self.0) * (distance >> 32);
        let decay = high.wrapping_add_unsigned(low).wrapping_add(i64::from(distance > 0));
        distance.wrapping_sub(decay)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_time_constant_leaves_one_part_in_e() {
        let fade = ExponentialDecay::new(2000.0);
        let remaining = (0..2000).fold(1i64 << 40, |distance, _| fade.step(distance));
        let exact = f64::from(1 << 30) * 1024.0 / core::f64::consts::E;
        // The fraction, 2³²/2000 steps, is rounded by half a step, and each tick rounds by up to a unit.
        let bound = exact * 0.5 * 2000.0 / 4_294_967_296.0 + 2000.0;
        assert!((remaining as f64 - exact).abs() < bound, "{remaining}, expected {exact}");
    }

    #[test]
    fn the_slowest_and_the_fastest_fade_end() {
        assert_eq!(ExponentialDecay::new(1e12).step(-5), -4);
        assert_eq!(ExponentialDecay::new(1e-12).step(1000), 0);
        assert_eq!(ExponentialDecay::new(1e-12).step(-1000), 0);
    }

    proptest! {
        #[test]
        fn a_fade_approaches_zero_and_does_not_pass_it(distance: i64, fraction: u32) {
            let remaining = ExponentialDecay(fraction.max(1)).step(distance);
            let nearer = remaining.unsigned_abs() < distance.unsigned_abs();
            prop_assert!(nearer || distance == 0 && remaining == 0);
            prop_assert!(remaining == 0 || (remaining > 0) == (distance > 0));
            // Against 128-bit arithmetic.
            let decay = i128::from(distance) * i128::from(fraction.max(1));
            let exact = i128::from(distance) - (decay >> 32) - i128::from(distance > 0);
            prop_assert_eq!(i128::from(remaining), exact);
        }
    }
}
