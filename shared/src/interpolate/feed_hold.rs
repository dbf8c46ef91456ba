//! Feed hold: the path decelerates to standstill and can be continued.
//!
//! The time of the path runs at a rate r of 0 to 1 of that of the machine, so that every position remains on the path and each
//! axis keeps its place on it. With the planned speed v(τ) along the path, the speed is r·v and the acceleration r²·dv/dτ +
//! (dr/dt)·v. The rate changes by a/F per tick, with the feed F ≥ v of the running block: a hold adds at most a to the
//! acceleration of the block.

use super::ramp::TICK;

/// What a feed hold does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum FeedState {
    /// The path runs as planned.
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
    state: FeedState,
    /// Time per tick, 32 fraction bits: 0 to [`TICK`].
    rate: u64,
    /// Change of the rate per tick, at least 1.
    change: u64,
}

impl FeedHold {
    /// The path runs as planned.
    pub const RUNNING: Self = Self { state: FeedState::Running, rate: TICK, change: TICK };

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
        }
    }

    /// Whether the path stands and is to be discarded.
    #[must_use]
    pub const fn is_to_be_discarded(&self) -> bool {
        matches!(self.state, FeedState::Discarding) && self.rate == 0
    }

    /// A planned speed at the present rate.
    #[must_use]
    pub const fn scaled(&self, speed: u64) -> u64 {
        if self.rate >= TICK {
            return speed;
        }
        #[expect(clippy::cast_possible_truncation, reason = "not greater than the speed")]
        let scaled = ((speed as u128 * self.rate as u128) >> 32) as u64;
        scaled
    }

    /// The time by which the path advances in this tick, 32 fraction bits.
    #[inline]
    pub fn advance(&mut self) -> u64 {
        if self.state == FeedState::Running { TICK } else { self.change_rate() }
    }

    #[cold]
    #[inline(never)]
    fn change_rate(&mut self) -> u64 {
        match self.state {
            FeedState::Running => {}
            FeedState::Holding | FeedState::Held | FeedState::Discarding => {
                self.rate = self.rate.saturating_sub(self.change);
                if self.rate == 0 && self.state == FeedState::Holding {
                    self.state = FeedState::Held;
                }
            }
            FeedState::Resuming => {
                self.rate = (self.rate + self.change).min(TICK);
                if self.rate == TICK {
                    self.state = FeedState::Running;
                }
            }
        }
        self.rate
    }

    fn slow_down(&mut self, state: FeedState, feed: Option<u64>, deceleration: u64) {
        (self.state, self.change) = (state, change(feed, deceleration));
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
