//! Feed hold of the path: see [`feed_hold`](super::super::feed_hold).

use super::super::feed_hold::{FeedHold, FeedState};
use super::super::planned::PlannedBlock;
use super::Path;

impl<const N: usize> Path<N> {
    /// Decelerates to standstill on the path, which [`Path::resume`] continues. The deceleration (per tick² with 16 fraction
    /// bits) is added to that of the block.
    pub fn hold(&mut self, deceleration: u64) {
        self.feed_hold.hold(self.feed(), deceleration);
    }

    /// Continues after a [hold](Path::hold), with the same acceleration.
    pub fn resume(&mut self, acceleration: u64) {
        self.feed_hold.resume(self.feed(), acceleration);
    }

    /// Decelerates as [`Path::hold`], then discards the rest of the path. The path can then be used again.
    pub fn discard(&mut self, deceleration: u64) {
        self.feed_hold.discard(self.feed(), deceleration);
        if self.feed_hold.is_to_be_discarded() {
            self.discard_rest();
        }
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
        self.feed_hold = FeedHold::RUNNING;
    }
}
