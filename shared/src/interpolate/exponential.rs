//! Path length over time with an exponential approach to speed, and from it.
//!
//! The distance follows a target that moves at the feed F, and by how much is the lag between them:
//! d += α·(target − d), α = A/F, so that the first step, the steepest, accelerates by F·α = A. The lag that
//! the target leaves at the end decays as (1 − α)ⁿ; once it is no more than F·α, the last step takes it
//! all, and decelerates by no more than A. It stands for a tick before and behind, so that neither the first nor the
//! last step adds to what the neighbouring block does in one tick.

use super::error::PathError;
use super::fraction::{speed, whole};
use super::limits::Limits;
use crate::integer::wide_mul_q32;

/// Least α with 32 fraction bits: a time constant of 2²⁰ ticks, 52 s at 20 kHz.
const LEAST_SHARE: u32 = 1 << 12;

/// A planned curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exponential {
    /// Position units, 64 fraction bits.
    length: i128,
    feed: i128,
    /// F·α.
    last_step: i128,
    /// α, 32 fraction bits, below 1.
    share: u32,
}

impl Exponential {
    /// Plans a length from rest to rest.
    ///
    /// # Errors
    /// [`PathError::TooLong`] where the time constant is 2²⁰ ticks or more.
    pub fn plan(length: i64, limits: &Limits) -> Result<Self, PathError> {
        let share = (u128::from(limits.acceleration) << 32) / u128::from(limits.feed.max(1));
        let share = u32::try_from(share).unwrap_or(u32::MAX);
        if share < LEAST_SHARE {
            return Err(PathError::TooLong);
        }
        let feed = i128::from(limits.feed) << 48;
        Ok(Self { length: i128::from(length) << 64, feed, last_step: wide_mul_q32(feed, share), share })
    }

    /// Goes one tick on. Whole position units, and whether they are the end.
    pub fn advance(&self, progress: &mut Progress) -> (i64, bool) {
        if !core::mem::replace(&mut progress.begun, true) {
            return (0, false);
        }
        progress.target = (progress.target + self.feed).min(self.length);
        let lag = progress.target - progress.distance;
        let lands = progress.target == self.length && lag <= self.last_step;
        progress.step = if lands { lag } else { wide_mul_q32(lag, self.share) };
        progress.distance += progress.step;
        (whole(progress.distance), lag == 0)
    }
}

/// How far a curve has come, position units with 64 fraction bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    begun: bool,
    target: i128,
    distance: i128,
    step: i128,
}

impl Progress {
    /// At the start.
    pub const NONE: Self = Self { begun: false, target: 0, distance: 0, step: 0 };

    /// Position units per tick, 16 fraction bits.
    #[must_use]
    pub const fn speed(&self) -> u64 {
        speed(self.step)
    }

    /// Whole position units.
    #[must_use]
    pub const fn distance(&self) -> i64 {
        whole(self.distance)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Differences of whole units are off by 1, second differences by 2. The lag of F/α has to
        /// decay to F·α: ln(1/α²)/α ticks after the target, and some for the discrete decay being faster.
        #[test]
        #[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
        fn keeps_feed_and_acceleration_and_ends_exactly(
            length in 1i64 << 20..1 << 48, feed in 1u64 << 24..1 << 36, ticks in 1.0..2000.0f64,
        ) {
            prop_assume!(length.unsigned_abs() / feed < 200_000);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2⁵²")]
            let acceleration = ((feed << 16) as f64 / ticks) as u64;
            let curve = Exponential::plan(length, &Limits::new(feed << 16, acceleration, None)).unwrap();
            let mut progress = Progress::NONE;
            let mut distances = std::vec![0, 0];
            while {
                let (distance, ended) = curve.advance(&mut progress);
                distances.push(distance);
                !ended
            } {}
            distances.push(length);
            prop_assert_eq!(distances[distances.len() - 2], length);
            let steps: std::vec::Vec<i64> = distances.windows(2).map(|w| w[1] - w[0]).collect();
            prop_assert!(steps.iter().all(|&v| v >= 0 && v.unsigned_abs() <= feed + 1));
            prop_assert!(steps.windows(2).all(|w| (w[1] - w[0]).unsigned_abs() <= (acceleration >> 16) + 3));
            let least = length as f64 / feed as f64;
            prop_assert!(steps.len() as f64 <= least + ticks * (2.0 * libm::log(ticks)) + 6.0, "{}", steps.len());
            prop_assert!(steps.len() as f64 >= least);
        }
    }

    #[test]
    fn rises_as_an_exponential_does() {
        // One tick in of time constant 1000: the velocity after n ticks is F(1 − (1 − 1/1000)ⁿ).
        let feed = 1u64 << 30;
        let limits = Limits::new(feed << 16, (feed << 16) / 1000, None);
        let curve = Exponential::plan(1 << 50, &limits).unwrap();
        let mut progress = Progress::NONE;
        // It stands for a tick.
        assert_eq!(curve.advance(&mut progress), (0, false));
        for n in 1..5000 {
            let _ = curve.advance(&mut progress);
            let exact = feed as f64 * (1.0 - libm::pow(0.999, f64::from(n)));
            // α is rounded to 2⁻³².
            assert!((progress.speed() as f64 / 65_536.0 - exact).abs() < 1e-3 * exact.max(1.0));
        }
    }
}
