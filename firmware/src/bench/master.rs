//! The encoder of a master, at the counter of x: it turns when the bench says so, and x can follow it.

use crate::setup::TICK_HZ;

/// Counts of a turn: 1000 lines.
pub const MASTER_TURN: i32 = 4000;

/// Counts per second while it turns.
const COUNTS_PER_S: u32 = 4000;

/// Ticks per count.
const TICKS: u32 = TICK_HZ / COUNTS_PER_S;

/// A master encoder.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Master {
    count: u32,
    ticks: u32,
}

impl Master {
    /// Turns for a tick, by a count in every fifth one as long as counts are left.
    pub fn step(&mut self, left: &mut i32) {
        self.ticks += 1;
        if self.ticks >= TICKS {
            let step = left.signum();
            self.ticks = 0;
            self.count = self.count.wrapping_add_signed(step);
            *left -= step;
        }
    }

    /// Its counter.
    pub const fn count(self) -> u32 {
        self.count
    }
}
