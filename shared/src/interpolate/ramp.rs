//! How long a change of speed takes, how far it goes, and which speed can be reached: the arithmetic of
//! planning, in integers.
//!
//! A change of speed by Δ with acceleration A and jerk J takes three pieces: the acceleration rises for
//! t, stands for c, falls for t. With A reached (ΔJ ≥ A²) t = A/J and c = Δ/A − t, otherwise
//! t = √(Δ/J) and c = 0; without a jerk limit t = 0 and c = Δ/A. By symmetry it goes
//! (from + to)/2 · (2t + c). Times are rounded up, so that the limits are kept.

use super::limits::Limits;

/// One as a time, in ticks.
pub const TICK: u64 = 1 << 32;

/// Longest piece at constant speed, in ticks: 29 h at 20 kHz.
pub const MOST_TICKS: u64 = 1 << 31;

/// Longest ramp, in ticks: 7 h at 20 kHz.
pub const MOST_RAMP_TICKS: u64 = 1 << 29;

/// Steps of the search for a speed: a bracket of 2⁶⁰ ends at one unit of 2⁻¹⁶.
const SEARCH_STEPS: u32 = 60;

/// The pieces of a change of speed, in ticks with 32 fraction bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ramp {
    /// The acceleration rises, and falls again, for so long.
    pub rise: u64,
    /// It stands in between.
    pub stand: u64,
}

impl Ramp {
    /// The shortest that changes the speed from one to the other within the limits.
    #[must_use]
    pub fn between(from: u64, to: u64, limits: &Limits) -> Self {
        let change = u128::from(from.abs_diff(to));
        let acceleration = u128::from(limits.acceleration.max(1));
        let Some(jerk) = limits.jerk.map(|jerk| u128::from(jerk.max(1))) else {
            return Self { rise: 0, stand: time((change << 32).div_ceil(acceleration)) };
        };
        if change * jerk >= acceleration * acceleration {
            let rise = (acceleration << 32).div_ceil(jerk);
            let stand = (change << 32).div_ceil(acceleration).saturating_sub(rise);
            Self { rise: time(rise), stand: time(stand) }
        } else {
            Self { rise: time(ceil_sqrt((change << 64).div_ceil(jerk))), stand: 0 }
        }
    }

    /// Whether it is shorter than the longest that is planned.
    #[must_use]
    pub const fn is_short(&self) -> bool {
        self.duration() < MOST_RAMP_TICKS << 32
    }

    /// From start to end, ticks with 32 fraction bits.
    #[must_use]
    pub const fn duration(&self) -> u64 {
        2 * self.rise + self.stand
    }

    /// How far it goes between two speeds, in position units with 17 fraction bits, rounded up.
    fn distance(&self, from: u64, to: u64) -> u128 {
        ((u128::from(from) + u128::from(to)) * u128::from(self.duration())).div_ceil(1 << 32)
    }
}

/// A time of at most [`MOST_RAMP_TICKS`]; a ramp as long as that is refused where pieces are put together.
fn time(ticks_q32: u128) -> u64 {
    u64::try_from(ticks_q32).unwrap_or(u64::MAX).min(MOST_RAMP_TICKS << 32)
}

/// How far the change from one speed to another goes, position units with 17 fraction bits.
fn distance(from: u64, to: u64, limits: &Limits) -> u128 {
    Ramp::between(from, to, limits).distance(from, to)
}

/// The greatest speed up to `most` that can be changed into `speed`, or reached from it, within a
/// length. At least `speed` itself.
///
/// One square root without a jerk limit, at most 60 steps of a search with one.
#[must_use]
pub fn reachable(length: i64, speed: u64, most: u64, limits: &Limits) -> u64 {
    let room = u128::from(length.unsigned_abs()) << 17;
    if most <= speed || distance(speed, most, limits) <= room {
        return most.max(speed);
    }
    greatest(
        speed,
        most,
        limits,
        room,
        |top| distance(speed, top, limits),
        || {
            // to² = from² + 2AL
            square(speed).saturating_add(work(length, limits).saturating_mul(2))
        },
    )
}

/// The greatest speed up to the feed on a block that is entered and left at given speeds.
///
/// Bounded as [`reachable`] is.
#[must_use]
pub fn peak(length: i64, entry: u64, exit: u64, limits: &Limits) -> u64 {
    let room = u128::from(length.unsigned_abs()) << 17;
    let least = entry.max(exit);
    let both = |top| distance(entry, top, limits) + distance(top, exit, limits);
    if limits.feed <= least || both(limits.feed) <= room {
        return limits.feed.max(least);
    }
    greatest(least, limits.feed, limits, room, both, || {
        // 2·top² = entry² + exit² + 2AL
        (square(entry) / 2 + square(exit) / 2).saturating_add(work(length, limits))
    })
}

/// The greatest speed from `least` to `most` whose ramps find room: by its square where the acceleration
/// alone limits, else by halving.
fn greatest(
    least: u64,
    most: u64,
    limits: &Limits,
    room: u128,
    needed: impl Fn(u64) -> u128,
    squared: impl Fn() -> u128,
) -> u64 {
    if limits.jerk.is_none() {
        #[expect(clippy::cast_possible_truncation, reason = "the root of 128 bits has 64")]
        return (squared().isqrt() as u64).clamp(least, most);
    }
    let (mut low, mut high) = (least, most);
    for _ in 0..SEARCH_STEPS {
        // 2⁻²⁴ below the greatest speed lengthens a block by less than that.
        if high - low <= 1 + (low >> 24) {
            break;
        }
        let middle = low.midpoint(high);
        if needed(middle) <= room {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// A·L, with the fraction bits of a speed squared.
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

    /// 16 fraction bits.
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
        /// The pieces' own acceleration and jerk, from their durations, against the limits: at most them,
        /// and one of them reached, unless the change takes so little of a tick that 2⁻³² of it shows.
        #[test]
        fn a_ramp_keeps_its_limits_and_reaches_one(limits in limits(), share in 0.0..1.0f64) {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below the feed")]
            let to = (limits.feed as f64 * share) as u64;
            prop_assume!(to > 1 << 16);
            let ramp = Ramp::between(0, to, &limits);
            prop_assume!(ramp.is_short());
            let (rise, stand) = (ramp.rise as f64 / TICK as f64, ramp.stand as f64 / TICK as f64);
            let acceleration = to as f64 / (rise + stand);
            prop_assert!(acceleration <= limits.acceleration as f64 * (1.0 + 1e-9));
            let mut closest = acceleration / limits.acceleration as f64;
            if let Some(jerk) = limits.jerk {
                prop_assert!(acceleration / rise <= jerk as f64 * (1.0 + 1e-9));
                closest = closest.max(acceleration / rise / jerk as f64);
            }
            prop_assert!(closest > 1.0 - 1e-6 || ramp.duration() < 1 << 24, "{closest}");
        }

        /// What is reachable fits, and 1e-6 more does not, or is more than the feed.
        #[test]
        fn a_peak_is_the_greatest_that_fits(limits in limits(), length in 1i64 << 20..1 << 51, entry in 0.0..1.0f64) {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below the feed")]
            let entry = reachable(length, 0, (limits.feed as f64 * entry) as u64, &limits);
            let top = peak(length, entry, 0, &limits);
            prop_assert!(top <= limits.feed && top >= entry);
            let room = (length as f64) * 2.0 * ONE;
            let needed = |top| (distance(entry, top, &limits) + distance(top, 0, &limits)) as f64;
            prop_assert!(needed(top) <= room * (1.0 + 1e-6) + 4.0 * ONE, "{} of {room}", needed(top));
            let more = top + 2 + top / 1_000_000;
            prop_assert!(top == limits.feed || needed(more) >= room * (1.0 - 1e-9) - 4.0 * ONE);
        }
    }
}
