//! Path length over time with trapezoidal speed: limits kept by construction, the end met exactly.
//!
//! The ramps take a whole number n of ticks and the cruise a whole number m, both rounded up; then
//! speed v = L/(n + m) and acceleration a = v/n are at most what was asked for, and the sum over all
//! ticks is L. The state adds a and v with 64 fraction bits, so that 24 h of ticks lose less than
//! 1e-5 of a position unit; the last tick lands on L itself.

/// What the planner must keep to, per tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Position units per tick.
    pub feed: u64,
    /// Position units per tick².
    pub acceleration: u64,
}

/// A planned speed profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trapezoid {
    length: i64,
    ramp_ticks: u64,
    cruise_ticks: u64,
    /// Position units per tick², 64 fraction bits.
    acceleration: i128,
}

/// How far a profile has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    tick: u64,
    /// Position units, 64 fraction bits.
    distance: i128,
    /// Position units per tick, 64 fraction bits.
    velocity: i128,
}

impl Trapezoid {
    /// Plans `length` position units (not negative); both limits are at least 1.
    ///
    /// One square root (64 steps) and three divisions: bounded for any input.
    #[must_use]
    pub fn plan(length: i64, limits: Limits) -> Self {
        let (l, feed) = (u128::from(length.unsigned_abs()), u128::from(limits.feed.max(1)));
        let acceleration = u128::from(limits.acceleration.max(1));
        let ramp_to_feed = feed.div_ceil(acceleration);
        let ramp_of_triangle = ceil_sqrt(l.div_ceil(acceleration));
        let ramp = ramp_to_feed.min(ramp_of_triangle).max(1);
        let cruise = l.div_ceil(feed).saturating_sub(ramp);
        // length < 2⁶³, so the shifted length fits; ramp·(ramp + cruise) ≥ 1.
        let acceleration = (l << 64) / (ramp * (ramp + cruise));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_possible_wrap,
            reason = "ramp and cruise are at most length + 1, acceleration at most length·2⁶⁴"
        )]
        Self {
            length: length.wrapping_abs(),
            ramp_ticks: ramp as u64,
            cruise_ticks: cruise as u64,
            acceleration: acceleration as i128,
        }
    }

    /// A profile that stands still for a number of ticks.
    #[must_use]
    pub const fn dwell(ticks: u64) -> Self {
        Self { length: 0, ramp_ticks: 0, cruise_ticks: ticks, acceleration: 0 }
    }

    /// Ticks from start to end.
    #[must_use]
    pub const fn ticks(&self) -> u64 {
        2 * self.ramp_ticks + self.cruise_ticks
    }

    /// Goes one tick on. The distance along the path, and whether it is the end.
    #[must_use]
    pub fn advance(&self, progress: &mut Progress) -> (i64, bool) {
        progress.tick = progress.tick.wrapping_add(1);
        if progress.tick >= self.ticks() {
            return (self.length, true);
        }
        let phase = if progress.tick <= self.ramp_ticks {
            self.acceleration
        } else if progress.tick <= self.ramp_ticks + self.cruise_ticks {
            0
        } else {
            -self.acceleration
        };
        progress.distance += progress.velocity + (phase >> 1);
        progress.velocity += phase;
        let whole = (progress.distance >> 64) as i64;
        (whole, false)
    }
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

    fn run(plan: &Trapezoid) -> std::vec::Vec<i64> {
        let mut progress = Progress::default();
        let mut distances = std::vec![0];
        loop {
            let (distance, ended) = plan.advance(&mut progress);
            distances.push(distance);
            if ended {
                return distances;
            }
        }
    }

    /// Miri is slow: 4 mm, and some hundred ticks at the slowest.
    const LONGEST: i64 = if cfg!(miri) { 1 << 42 } else { 1 << 51 };
    const SLOWEST: u64 = if cfg!(miri) { 1 << 33 } else { 1 << 16 };

    proptest! {
        /// From 1 nm to 2 m, 1 µm/s to 1 m/s, 1 mm/s² to 20 m/s² at 20 kHz. Positions are whole
        /// units, so a first difference is off by up to 1 and a second by up to 2.
        #[test]
        fn keeps_its_limits_and_ends_exactly(
            length in 1i64 << 20..LONGEST,
            feed in SLOWEST..1 << 36,
            acceleration in 1u64 << 12..1 << 26,
        ) {
            // Runs of more than a million ticks are left to the long test below.
            prop_assume!(length.unsigned_abs() / feed < 1_000_000 && feed / acceleration < 1_000_000);
            let limits = Limits { feed, acceleration };
            let distances = run(&Trapezoid::plan(length, limits));
            prop_assert_eq!(*distances.last().unwrap(), length);
            let steps: std::vec::Vec<i64> = distances.windows(2).map(|w| w[1] - w[0]).collect();
            prop_assert!(steps.iter().all(|&v| v >= 0 && v.unsigned_abs() <= feed + 1));
            prop_assert!(steps.windows(2).all(|w| (w[1] - w[0]).unsigned_abs() <= acceleration + 2));
            prop_assert!(steps[0].unsigned_abs() <= acceleration / 2 + 2);
        }
    }

    #[test]
    fn takes_no_longer_than_it_must() {
        // 100 mm at 100 mm/s and 1 m/s²: 1 s + 0.1 s, at 20 kHz 22,000 ticks; rounding up adds at most 2.
        let limits = Limits { feed: 5_242_880_000, acceleration: 2_621_440 };
        let plan = Trapezoid::plan(104_857_600_000_000, limits);
        assert!((22_000..=22_002).contains(&plan.ticks()), "{}", plan.ticks());
    }

    extern crate std;
}
