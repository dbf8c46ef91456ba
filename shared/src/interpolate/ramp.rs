//! Ramps: how long a change of speed takes, how far it goes, and which speed can be reached, in integers.
//!
//! A change of speed by Δ with acceleration A and jerk J has three segments: the acceleration rises for t, holds for c and
//! falls for t. If A is reached (ΔJ ≥ A²), t = A/J and c = Δ/A − t; otherwise t = √(Δ/J) and c = 0; without a jerk limit
//! t = 0 and c = Δ/A. By symmetry the distance is (from + to)/2 · (2t + c). Times are rounded up, so that the limits are
//! kept.

use super::limits::Limits;

/// One tick as a time: 32 fraction bits.
pub const TICK: u64 = 1 << 32;

/// Longest segment at constant speed, in ticks: 29 h at 20 kHz.
pub const MAX_TICKS: u64 = 1 << 31;

/// Longest ramp, in ticks: 7 h at 20 kHz.
pub const MAX_RAMP_TICKS: u64 = 1 << 29;

/// Bisection steps for a speed: they narrow a bracket of 2⁶⁰ to one unit of 2⁻¹⁶.
const BISECTION_STEPS: u32 = 60;

/// The durations of a change of speed, in ticks with 32 fraction bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ramp {
    /// Duration of the rise of the acceleration, and of its fall.
    pub rise: u64,
    /// Duration of constant acceleration in between.
    pub hold: u64,
}

impl Ramp {
    /// The shortest ramp between two speeds within the limits.
    #[must_use]
    pub fn between(from: u64, to: u64, limits: &Limits) -> Self {
        let change = u128::from(from.abs_diff(to));
        let acceleration = u128::from(limits.acceleration.max(1));
        let Some(jerk) = limits.jerk.map(|jerk| u128::from(jerk.max(1))) else {
            return Self { rise: 0, hold: time((change << 32).div_ceil(acceleration)) };
        };
        if change * jerk >= acceleration * acceleration {
            let rise = (acceleration << 32).div_ceil(jerk);
            let hold = (change << 32).div_ceil(acceleration).saturating_sub(rise);
            Self { rise: time(rise), hold: time(hold) }
        } else {
            Self { rise: time(ceil_sqrt((change << 64).div_ceil(jerk))), hold: 0 }
        }
    }

    /// Whether the ramp is shorter than [`MAX_RAMP_TICKS`].
    #[must_use]
    pub const fn is_short(&self) -> bool {
        self.duration() < MAX_RAMP_TICKS << 32
    }

    /// Total duration, ticks with 32 fraction bits.
    #[must_use]
    pub const fn duration(&self) -> u64 {
        2 * self.rise + self.hold
    }

    /// Distance between two speeds, position units with 17 fraction bits, rounded up.
    fn distance(&self, from: u64, to: u64) -> u128 {
        ((u128::from(from) + u128::from(to)) * u128::from(self.duration())).div_ceil(1 << 32)
    }
}

/// A time, limited to [`MAX_RAMP_TICKS`]: a ramp of that length is rejected when the profile is composed.
fn time(ticks_q32: u128) -> u64 {
    u64::try_from(ticks_q32).unwrap_or(u64::MAX).min(MAX_RAMP_TICKS << 32)
}

/// Distance of the ramp between two speeds, position units with 17 fraction bits.
fn distance(from: u64, to: u64, limits: &Limits) -> u128 {
    Ramp::between(from, to, limits).distance(from, to)
}

/// The greatest speed up to `max` that a ramp connects with `speed` within a length. At least `speed` itself.
///
/// One square root without a jerk limit, at most 60 bisection steps with one.
#[must_use]
pub fn reachable(length: i64, speed: u64, max: u64, limits: &Limits) -> u64 {
    let available = u128::from(length.unsigned_abs()) << 17;
    if max <= speed || distance(speed, max, limits) <= available {
        return max.max(speed);
    }
    let search = Search { min: speed, max, limits, available };
    search.greatest(
        |top| distance(speed, top, limits),
        || {
            // to² = from² + 2AL
            square(speed).saturating_add(work(length, limits).saturating_mul(2))
        },
    )
}

/// The greatest speed up to the feed on a block with given entry and exit speeds.
///
/// Bounded as [`reachable`] is.
#[must_use]
pub fn peak(length: i64, entry: u64, exit: u64, limits: &Limits) -> u64 {
    let available = u128::from(length.unsigned_abs()) << 17;
    let min = entry.max(exit);
    let both = |top| distance(entry, top, limits) + distance(top, exit, limits);
    if limits.feed <= min || both(limits.feed) <= available {
        return limits.feed.max(min);
    }
    let search = Search { min, max: limits.feed, limits, available };
    search.greatest(both, || {
        // 2·top² = entry² + exit² + 2AL
        (square(entry) / 2 + square(exit) / 2).saturating_add(work(length, limits))
    })
}

/// A search for the greatest speed whose ramps fit a length.
struct Search<'a> {
    min: u64,
    max: u64,
    limits: &'a Limits,
    /// Position units with 17 fraction bits.
    available: u128,
}

impl Search<'_> {
    /// The greatest speed: from its square if only the acceleration is limited, else by bisection of the required length.
    fn greatest(&self, required: impl Fn(u64) -> u128, squared: impl Fn() -> u128) -> u64 {
        if self.limits.jerk.is_none() {
            #[expect(clippy::cast_possible_truncation, reason = "the root of 128 bits has 64")]
            return (squared().isqrt() as u64).clamp(self.min, self.max);
        }
        let (mut low, mut high) = (self.min, self.max);
        for _ in 0..BISECTION_STEPS {
            // A speed too low by 2⁻²⁴ makes the block longer by less than that.
            if high - low <= 1 + (low >> 24) {
                break;
            }
            let middle = low.midpoint(high);
            if required(middle) <= self.available {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}

/// A·L, with the fraction bits of a squared speed.
fn work(length: i64, limits: &Limits) -> u128 {
    u128::from(limits.acceleration).saturating_mul(u128::from(length.unsigned_abs()) << 16)
}

fn square(speed: u64) -> u128 {
    u128::from(speed) * u128::from(speed)
}

/// The least n with n² ≥ value.
fn ceil_sqrt(value: u128) -> u128 {
    let floor = value.isqrt();
    floor + u128::from(floor * floor < value)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_root_is_rounded_up() {
        for (value, root) in
            [(0, 0), (1, 1), (2, 2), (3, 2), (4, 2), (5, 3), (8, 3), (9, 3), (10, 4), (16, 4), (17, 5)]
        {
            assert_eq!(ceil_sqrt(value), root, "{value}");
        }
    }

    /// A speed above the greatest one stays, also where no ramp to it would fit.
    #[test]
    fn a_speed_is_not_reduced_to_the_greatest_one() {
        let limits = Limits::new(1 << 40, 1 << 16, None);
        assert_eq!(reachable(1, 1 << 40, 1 << 30, &limits), 1 << 40);
    }

    /// Without a jerk limit: top² = (entry² + exit²)/2 + A·L.
    #[test]
    fn the_peak_is_that_of_the_work_of_both_ramps() {
        let (acceleration, length) = (3.0, 40_000.0);
        let limits = Limits::new(1 << 50, 3 << 16, None);
        for (entry, exit) in [(0u64, 200u64), (200, 0), (300, 100)] {
            let exact = ((entry * entry + exit * exit) as f64 / 2.0 + acceleration * length).sqrt();
            let found = peak(40_000, entry << 16, exit << 16, &limits) as f64 / ONE;
            assert!((found - exact).abs() < 1e-3, "{entry}, {exit}: {found}, {exact}");
        }
    }

    /// 1 with 16 fraction bits.
    const ONE: f64 = 65_536.0;

    fn limits() -> impl Strategy<Value = Limits> {
        (16u32..50, 16u32..44, prop::option::of(16u32..40), 1.0..2.0f64).prop_map(
            |(feed, acceleration, jerk, m)| {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2⁵¹")]
                let scaled = |bits: u32| (f64::from(bits).exp2() * m) as u64;
                Limits::new(scaled(feed), scaled(acceleration), jerk.map(scaled))
            },
        )
    }

    proptest! {
        /// Acceleration and jerk, computed from the durations: within the limits, and one limit reached unless the ramp is so
        /// short that the rounding of its durations to 2⁻³² ticks shows.
        #[test]
        fn a_ramp_keeps_its_limits_and_reaches_one(limits in limits(), fraction in 0.0..1.0f64) {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below the feed")]
            let to = (limits.feed as f64 * fraction) as u64;
            prop_assume!(to > 1 << 16);
            let ramp = Ramp::between(0, to, &limits);
            prop_assume!(ramp.is_short());
            let (rise, hold) = (ramp.rise as f64 / TICK as f64, ramp.hold as f64 / TICK as f64);
            let acceleration = to as f64 / (rise + hold);
            prop_assert!(acceleration <= limits.acceleration as f64 * (1.0 + 1e-9));
            let mut closest = acceleration / limits.acceleration as f64;
            if let Some(jerk) = limits.jerk {
                prop_assert!(acceleration / rise <= jerk as f64 * (1.0 + 1e-9));
                closest = closest.max(acceleration / rise / jerk as f64);
            }
            prop_assert!(closest > 1.0 - 1e-6 || ramp.duration() < 1 << 24, "{closest}");
        }

        /// The peak speed fits the length; 1e-6 more does not fit, or exceeds the feed.
        #[test]
        fn a_peak_is_the_greatest_that_fits(limits in limits(), length in 1i64 << 20..1 << 51, entry in 0.0..1.0f64) {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below the feed")]
            let entry = reachable(length, 0, (limits.feed as f64 * entry) as u64, &limits);
            let top = peak(length, entry, 0, &limits);
            prop_assert!(top <= limits.feed && top >= entry);
            let available = (length as f64) * 2.0 * ONE;
            let required = |top| (distance(entry, top, &limits) + distance(top, 0, &limits)) as f64;
            prop_assert!(required(top) <= available * (1.0 + 1e-6) + 4.0 * ONE, "{} of {available}", required(top));
            let more = top + 2 + top / 1_000_000;
            prop_assert!(top == limits.feed || required(more) >= available * (1.0 - 1e-9) - 4.0 * ONE);
        }
    }
}
