//! Path length over time as a first-order lag: exponential acceleration and deceleration.
//!
//! The distance d follows a target that moves at the feed F: d += α·(target − d) per tick, α = A/F, so that the first
//! step, the steepest, has the acceleration F·α = A. When the target has reached the end, the lag decays as (1 − α)ⁿ; as
//! soon as it is at most F·α, the last step covers all of it with a deceleration of at most A. The curve is at rest for one
//! tick at both ends, so that its first and last step do not add to those of the adjacent blocks within a tick.

use super::error::PathError;
use super::fraction::{speed, whole};
use super::limits::Limits;
use crate::integer::wide_mul_q32;

/// Least α, 32 fraction bits: a time constant of 2²⁰ ticks, 52 s at 20 kHz.
const MIN_ALPHA: u32 = 1 << 12;

/// A planned curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exponential {
    /// Length and feed, position units (per tick), 64 fraction bits.
    length: i128,
    feed: i128,
    /// F·α, the greatest last step.
    last_step: i128,
    /// α, 32 fraction bits, below 1.
    alpha: u32,
}

impl Exponential {
    /// Plans a length from rest to rest.
    ///
    /// # Errors
    /// [`PathError::TooLong`] if the time constant is more than 2²⁰ ticks.
    pub fn plan(length: i64, limits: &Limits) -> Result<Self, PathError> {
        let alpha = (u128::from(limits.acceleration) << 32) / u128::from(limits.feed.max(1));
        let alpha = u32::try_from(alpha).unwrap_or(u32::MAX);
        if alpha < MIN_ALPHA {
            return Err(PathError::TooLong);
        }
        let feed = i128::from(limits.feed) << 48;
        Ok(Self { length: i128::from(length) << 64, feed, last_step: wide_mul_q32(feed, alpha), alpha })
    }

    /// Advances by a time up to a tick (32 fraction bits). Returns the distance in position units, and whether the curve has
    /// ended. In a fraction t of a tick, target and distance move by the fraction t of their steps.
    pub fn advance(&self, progress: &mut Progress, time: u64) -> (i64, bool) {
        if !core::mem::replace(&mut progress.started, true) {
            return (0, false);
        }
        // A whole tick has no fraction.
        let part = u32::try_from(time).ok();
        let of = |step: i128| part.map_or(step, |part| wide_mul_q32(step, part));
        progress.target = (progress.target + of(self.feed)).min(self.length);
        let lag = progress.target - progress.distance;
        let lands = progress.target == self.length && lag <= of(self.last_step);
        let whole_step = wide_mul_q32(lag, self.alpha);
        progress.distance += if lands { lag } else { of(whole_step) };
        progress.step = if lands { lag } else { whole_step };
        (whole(progress.distance), lag == 0)
    }
}

/// Progress along a curve, position units with 64 fraction bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    started: bool,
    target: i128,
    distance: i128,
    /// Step of a whole tick.
    step: i128,
}

impl Progress {
    /// At the start.
    pub const NONE: Self = Self { started: false, target: 0, distance: 0, step: 0 };

    /// Speed, position units per tick with 16 fraction bits.
    #[must_use]
    pub const fn speed(&self) -> u64 {
        speed(self.step)
    }

    /// Distance from the start, whole position units.
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
    use crate::interpolate::ramp::TICK;

    proptest! {
        /// Rounding changes a difference of distances by up to 1 and a second difference by up to 2. After the target has
        /// reached the end, the lag F/α decays to F·α in ln(1/α²)/α ticks.
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
                let (distance, ended) = curve.advance(&mut progress, TICK);
                distances.push(distance);
                !ended
            } {}
            distances.push(length);
            prop_assert_eq!(distances[distances.len() - 2], length);
            let steps: std::vec::Vec<i64> = distances.windows(2).map(|w| w[1] - w[0]).collect();
            prop_assert!(steps.iter().all(|&v| v >= 0 && v.unsigned_abs() <= feed + 1));
            prop_assert!(steps.windows(2).all(|w| (w[1] - w[0]).unsigned_abs() <= (acceleration >> 16) + 3));
            let shortest = length as f64 / feed as f64;
            prop_assert!(steps.len() as f64 <= shortest + ticks * (2.0 * libm::log(ticks)) + 6.0, "{}", steps.len());
            prop_assert!(steps.len() as f64 >= shortest);
        }
    }

    #[test]
    fn the_longest_time_constant_has_its_limit() {
        let plan = |ticks: u64| Exponential::plan(1 << 50, &Limits::new(1 << 40, (1 << 40) / ticks, None));
        assert!(plan(1 << 20).is_ok());
        assert_eq!(plan((1 << 20) + 300).err(), Some(PathError::TooLong));
    }

    #[test]
    fn the_speed_rises_exponentially() {
        // α = 1/1000: the speed after n ticks is F(1 − (1 − 1/1000)ⁿ).
        let feed = 1u64 << 30;
        let limits = Limits::new(feed << 16, (feed << 16) / 1000, None);
        let curve = Exponential::plan(1 << 50, &limits).unwrap();
        let mut progress = Progress::NONE;
        // The first tick is at rest.
        assert_eq!(curve.advance(&mut progress, TICK), (0, false));
        for n in 1..5000 {
            let _ = curve.advance(&mut progress, TICK);
            let exact = feed as f64 * (1.0 - libm::pow(0.999, f64::from(n)));
            // α is rounded to 2⁻³².
            assert!((progress.speed() as f64 / 65_536.0 - exact).abs() < 1e-3 * exact.max(1.0));
        }
    }
}
