//! Feed hold and override of the path: see [`feed_hold`](super::super::feed_hold).

use super::super::feed_hold::{FeedState, rate_of};
use super::super::planned::PlannedBlock;
use super::Path;

impl<const N: usize> Path<N> {
    /// Decelerates to standstill on the path, which [`Path::resume`] continues. The deceleration (per tick² with 16 fraction
    /// bits) is added to that of the block.
    /// Axes that follow counters decelerate, and nothing is held then.
    pub fn hold(&mut self, deceleration: u64) {
        if self.follows() {
            return self.followers.stop();
        }
        self.feed_hold.hold(self.feed(), deceleration);
    }

    /// Continues after a [hold](Path::hold), with the same acceleration.
    pub fn resume(&mut self, acceleration: u64) {
        self.feed_hold.resume(self.feed(), acceleration);
    }

    /// Decelerates as [`Path::hold`], then discards the rest of the path. The path can then be used again.
    pub fn discard(&mut self, deceleration: u64) {
        if self.follows() {
            return self.followers.stop();
        }
        self.feed_hold.discard(self.feed(), deceleration);
        if self.feed_hold.is_to_be_discarded() {
            self.discard_rest();
        }
    }

    /// Sets the feed override, 0 to [`MOST_PERCENT`](super::super::feed_hold::MOST_PERCENT) of the planned speed. The speed changes with
    /// the acceleration (per tick² with 16 fraction bits) at most, which is added to that of the block; at rest the override holds at
    /// once. It remains when the path ends; [`Path::reset`] sets 100 %.
    pub fn set_override(&mut self, percent: u8, acceleration: u64) {
        let moves = self.started || self.is_braking();
        let fastest = self.blocks.iter().map(PlannedBlock::feed).max().filter(|_| moves);
        self.feed_hold.set_override(rate_of(percent), fastest, acceleration);
    }

    /// The present rate of the time of the path, % of the planned one.
    #[must_use]
    pub const fn rate_percent(&self) -> u8 {
        self.feed_hold.percent()
    }

    /// What the feed hold does.
    #[must_use]
    pub const fn feed_state(&self) -> FeedState {
        self.feed_hold.state()
    }

    /// Feed of the running block.
    fn feed(&self) -> Option<u64> {
        self.blocks.front().filter(|_| self.started).map(PlannedBlock::feed)
    }

    /// At standstill: ends the path here.
    #[cold]
    pub(super) fn discard_rest(&mut self) {
        self.clear_queue();
        self.planned_end = self.position;
        self.feed_hold.rest();
    }
}
