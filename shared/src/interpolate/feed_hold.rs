//! Feed hold and feed override: the path decelerates to standstill and can be continued, or runs slower or faster than planned.
//!
//! The time of the path runs at a rate r of 0 to 2 of that of the machine, so that every position remains on the path and each
//! axis keeps its place on it. With the planned speed v(τ) along the path, the speed is r·v and the acceleration r²·dv/dτ +
//! (dr/dt)·v. The rate changes by a/F per tick, with the feed F ≥ v of the running block, or of the fastest block in the queue for an
//! override: a hold, a resume and a change of the override add at most a. The rate is continuous in time, and so is the speed.
//!
//! | state | rate |
//! |---|---|
//! | running | changes to the override, and stays there |
//! | holding, discarding | decreases to 0 |
//! | held | 0; an override that is set takes effect with the resume |
//! | resuming | changes to the override |
//! | without a running block | is the override at once |

use super::ramp::TICK;

/// Greatest override, %: the path runs at twice its planned speed.
pub const MOST_PERCENT: u8 = 200;

/// The rate of an override in percent, 32 fraction bits. Above [`MOST_PERCENT`] it is that of this one.
#[must_use]
pub const fn rate_of(percent: u8) -> u64 {
    let percent = if percent > MOST_PERCENT { MOST_PERCENT } else { percent };
    TICK * percent as u64 / 100
}

/// What a feed hold does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum FeedState {
    /// The path runs, at its override.
    #[default]
    Running,
    /// The path decelerates.
    Holding,
    /// The path stands.
    Held,
    /// The path accelerates again.
    Resuming,
    /// The path decelerates; the rest of it is then discarded.
    Discarding,
}

/// The rate of the path's time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeedHold {
    /// Whether state, rate and override are those of [`FeedHold::RUNNING`]: a tick looks at one byte.
    as_planned: bool,
    state: FeedState,
    /// Time per tick, 32 fraction bits: 0 to twice [`TICK`].
    rate: u64,
    /// The override: the rate of a path that runs.
    target: u64,
    /// Change of the rate per tick, at least 1.
    change: u64,
}

impl FeedHold {
    /// The path runs as planned.
    pub const RUNNING: Self =
        Self { as_planned: true, state: FeedState::Running, rate: TICK, target: TICK, change: TICK };

    /// What the hold does.
    #[must_use]
    pub const fn state(&self) -> FeedState {
        self.state
    }

    /// Starts a hold. `feed` is that of the running block, per tick, and `deceleration` per tick², with the same fraction
    /// bits. Without a running block the hold is complete at once.
    pub fn hold(&mut self, feed: Option<u64>, deceleration: u64) {
        if self.state != FeedState::Discarding {
            self.slow_down(FeedState::Holding, feed, deceleration);
        }
    }

    /// Starts a hold at the end of which the path is to be discarded.
    pub fn discard(&mut self, feed: Option<u64>, deceleration: u64) {
        self.slow_down(FeedState::Discarding, feed, deceleration);
    }

    /// Ends a hold. A path that is to be discarded does not continue.
    pub fn resume(&mut self, feed: Option<u64>, acceleration: u64) {
        if matches!(self.state, FeedState::Holding | FeedState::Held) {
            (self.state, self.change) = (FeedState::Resuming, change(feed, acceleration));
            self.as_planned = false;
        }
    }

    /// Sets the override, a rate of 0 to twice [`TICK`]. `feed` is the greatest of the path, `None` without a running block, and
    /// `acceleration` per tick², with the same fraction bits. A path that is held keeps its state, and one that is to be discarded
    /// stops as before.
    pub fn set_override(&mut self, target: u64, feed: Option<u64>, acceleration: u64) {
        (self.target, self.as_planned) = (target, false);
        if matches!(self.state, FeedState::Running | FeedState::Resuming) {
            self.change = change(feed, acceleration);
            if feed.is_none() {
                self.rest();
            }
        }
    }

    /// The path is at rest without blocks: the next one starts at the override.
    pub const fn rest(&mut self) {
        (self.state, self.rate) = (FeedState::Running, self.target);
        self.as_planned = self.target == TICK;
    }

    /// The present rate, %, rounded.
    #[must_use]
    pub const fn percent(&self) -> u8 {
        #[expect(clippy::cast_possible_truncation, reason = "at most 200")]
        let percent = ((self.rate * 100 + TICK / 2) >> 32) as u8;
        percent
    }

    /// Whether the path stands and is to be discarded.
    #[must_use]
    pub const fn is_to_be_discarded(&self) -> bool {
        matches!(self.state, FeedState::Discarding) && self.rate == 0
    }

    /// A planned speed at the present rate.
    #[must_use]
    pub const fn scaled(&self, speed: u64) -> u64 {
        if self.rate == TICK {
            return speed;
        }
        #[expect(clippy::cast_possible_truncation, reason = "at most twice the speed, which is below 2⁵⁷")]
        let scaled = ((speed as u128 * self.rate as u128) >> 32) as u64;
        scaled
    }

    /// The acceleration of a stop that ends no later on the path than planned, for a planned acceleration: beyond 100 % that of the path
    /// at the present rate, r²·A, rounded up; otherwise the planned one.
    #[must_use]
    pub fn stop_acceleration(&self, planned: u64) -> u64 {
        if self.rate <= TICK {
            return planned;
        }
        let squared = (u128::from(self.rate) * u128::from(self.rate)) >> 32;
        u64::try_from((u128::from(planned) * squared) >> 32).unwrap_or(u64::MAX - 1) + 1
    }

    /// Whether the path runs at 100 %, with nothing else to do: it advances by a tick then.
    #[inline]
    #[must_use]
    pub const fn is_as_planned(&self) -> bool {
        self.as_planned
    }

    /// The time by which the path advances in this tick, 32 fraction bits.
    #[cold]
    #[inline(never)]
    pub fn advance(&mut self) -> u64 {
        match self.state {
            FeedState::Running | FeedState::Resuming => {
                self.rate = if self.rate < self.target {
                    (self.rate + self.change).min(self.target)
                } else {
                    self.rate.saturating_sub(self.change).max(self.target)
                };
                if self.rate == self.target {
                    self.state = FeedState::Running;
                    self.as_planned = self.target == TICK;
                }
            }
            FeedState::Holding | FeedState::Held | FeedState::Discarding => {
                self.rate = self.rate.saturating_sub(self.change);
                if self.rate == 0 && self.state == FeedState::Holding {
                    self.state = FeedState::Held;
                }
            }
        }
        self.rate
    }

    fn slow_down(&mut self, state: FeedState, feed: Option<u64>, deceleration: u64) {
        (self.state, self.change) = (state, change(feed, deceleration));
        self.as_planned = false;
        if feed.is_none() || self.rate == 0 {
            self.rate = 0;
            if state == FeedState::Holding {
                self.state = FeedState::Held;
            }
        }
    }
}

/// The change of the rate per tick: acceleration/feed with 32 fraction bits.
fn change(feed: Option<u64>, acceleration: u64) -> u64 {
    let Some(feed) = feed else { return TICK };
    let change = (u128::from(acceleration) << 32) / u128::from(feed.max(1));
    u64::try_from(change).unwrap_or(TICK).clamp(1, TICK)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_override_ends_at_200_percent() {
        assert_eq!([0, 50, 100, 150].map(rate_of), [0, TICK / 2, TICK, TICK * 3 / 2]);
        for percent in [200, 201, u8::MAX] {
            assert_eq!(rate_of(percent), 2 * TICK, "{percent}");
        }
    }

    /// At 150 % a planned deceleration of 10 is one of 22.5 on the path: rounded up, a stop is no longer than planned. The largest saturates.
    #[test]
    fn the_deceleration_of_a_stop_is_that_of_the_rate_rounded_up() {
        let at = |percent| {
            let mut feed = FeedHold::RUNNING;
            feed.set_override(rate_of(percent), None, 1);
            feed
        };
        for (percent, expected) in [(50, 10), (100, 10), (150, 23)] {
            assert_eq!(at(percent).stop_acceleration(10), expected, "{percent} %");
        }
        assert_eq!(at(200).stop_acceleration(u64::MAX), u64::MAX);
    }
}
