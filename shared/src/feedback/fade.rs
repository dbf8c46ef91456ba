//! A distance that fades away: exponentially, in integers, to exactly zero.

/// 1 − e^(−tick/time constant), times 2³².
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fade(u32);

impl Fade {
    /// For a time constant in ticks, above 0.
    #[must_use]
    pub fn new(ticks: f64) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of one saturates"
        )]
        Self((libm::rint(-libm::expm1(-1.0 / ticks) * 4_294_967_296.0) as u32).max(1))
    }

    /// What is left of a distance a tick later: at least one unit nearer to zero, and never beyond.
    #[must_use]
    pub fn step(self, distance: i64) -> i64 {
        // Nearly always.
        if distance == 0 {
            return 0;
        }
        // 32 × 64 bits, of which the lowest 32 are dropped: towards −∞, so one is added above zero.
        #[expect(
            clippy::cast_sign_loss,
            clippy::cast_possible_truncation,
            reason = "the low half, of any sign"
        )]
        let low = (u64::from(self.0) * u64::from(distance as u32)) >> 32;
        let high = i64::from(self.0) * (distance >> 32);
        let part = high.wrapping_add_unsigned(low).wrapping_add(i64::from(distance > 0));
        distance.wrapping_sub(part)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_time_constant_leaves_one_part_in_e() {
        let fade = Fade::new(2000.0);
        let left = (0..2000).fold(1i64 << 40, |left, _| fade.step(left));
        let exact = f64::from(1 << 30) * 1024.0 / core::f64::consts::E;
        // Half a step of the share, of 2³²/2000 steps, and a unit a tick.
        let bound = exact * 0.5 * 2000.0 / 4_294_967_296.0 + 2000.0;
        assert!((left as f64 - exact).abs() < bound, "{left} of {exact}");
    }

    #[test]
    fn the_slowest_and_the_fastest_end_too() {
        assert_eq!(Fade::new(1e12).step(-5), -4);
        assert_eq!(Fade::new(1e-12).step(1000), 0);
        assert_eq!(Fade::new(1e-12).step(-1000), 0);
    }

    proptest! {
        #[test]
        fn what_fades_goes_to_zero_and_not_beyond(distance: i64, share: u32) {
            let left = Fade(share.max(1)).step(distance);
            let nearer = left.unsigned_abs() < distance.unsigned_abs();
            prop_assert!(nearer || distance == 0 && left == 0);
            prop_assert!(left == 0 || (left > 0) == (distance > 0));
            // Against 128 bits.
            let part = i128::from(distance) * i128::from(share.max(1));
            let exact = i128::from(distance) - (part >> 32) - i128::from(distance > 0);
            prop_assert_eq!(i128::from(left), exact);
        }
    }
}
