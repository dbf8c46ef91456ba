//! Ticks that end late, and ticks that are missed.
//!
//! A tick is late if it has not ended when the next one is due. It is missed if its interrupt was lost: the timer has demanded it twice
//! before it could start, which only a free-running counter shows. Both are counted while the power stages are enabled: the program
//! stands still while the flash is erased, with the stages off.

use core::num::NonZeroU32;

use serde::{Deserialize, Serialize};

/// How the ticks of a board are timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickClock {
    /// Counts of the counter of [`Board::started_at`](super::Board::started_at) in a period of the ticks.
    pub counts_per_tick: NonZeroU32,
    /// Late and missed ticks, from one enable of the power stages to the next, that are no fault.
    pub tolerated: u32,
}

/// What was counted since the start of the board, while the power stages were enabled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TickCounts {
    /// Ticks that had not ended when the next one was due.
    pub late: u32,
    /// Ticks whose interrupt was lost.
    pub missed: u32,
    /// The longest delay of the start of a tick, thousandths of a period, rounded up.
    pub longest_delay_permille: u32,
}

/// Counts late and missed ticks.
#[derive(Clone, Copy, Debug)]
pub struct TickWatch {
    clock: Option<TickClock>,
    /// Count at which the next tick is due; `None` while the power stages are off.
    due: Option<u32>,
    late: u32,
    missed: u32,
    /// Late and missed ticks since the power stages were enabled.
    since_enable: u32,
    /// Counts of the counter.
    longest_delay: u32,
}

impl TickWatch {
    /// Without a counter no tick is known to be missed, and no late one is tolerated.
    #[must_use]
    pub const fn new(clock: Option<TickClock>) -> Self {
        Self { clock, due: None, late: 0, missed: 0, since_enable: 0, longest_delay: 0 }
    }

    /// A tick starts, `at` a count of the counter. `enabled`: whether the tick before has enabled the power stages.
    pub const fn started(&mut self, at: Option<u32>, enabled: bool) {
        if !enabled {
            (self.since_enable, self.due) = (0, None);
        }
        let (Some(TickClock { counts_per_tick, .. }), Some(at)) = (self.clock, at) else { return };
        let due = match self.due {
            // Half of the range is before the time at which it is due.
            Some(due) if at.wrapping_sub(due) <= u32::MAX / 2 => due,
            _ => at,
        };
        let delay = at.wrapping_sub(due);
        let missed = delay / counts_per_tick.get();
        if delay > self.longest_delay {
            self.longest_delay = delay;
        }
        self.missed = self.missed.saturating_add(missed);
        self.since_enable = self.since_enable.saturating_add(missed);
        if enabled {
            self.due = Some(due.wrapping_add((missed + 1).wrapping_mul(counts_per_tick.get())));
        }
    }

    /// A tick ends that has enabled the power stages. `next_is_due`: whether the next one is due.
    pub const fn ended(&mut self, next_is_due: bool) {
        self.late = self.late.saturating_add(next_is_due as u32);
        self.since_enable = self.since_enable.saturating_add(next_is_due as u32);
    }

    /// Whether there were more late and missed ticks than are tolerated since the power stages were enabled.
    #[must_use]
    pub const fn is_exceeded(&self) -> bool {
        let tolerated = match self.clock {
            Some(clock) => clock.tolerated,
            None => 0,
        };
        self.since_enable > tolerated
    }

    /// What was counted.
    #[must_use]
    pub fn counts(&self) -> TickCounts {
        let permille = self.clock.map_or(0, |clock| {
            let counts_per_tick = u64::from(clock.counts_per_tick.get());
            let permille = (1000 * u64::from(self.longest_delay)).div_ceil(counts_per_tick);
            u32::try_from(permille).unwrap_or(u32::MAX)
        });
        TickCounts { late: self.late, missed: self.missed, longest_delay_permille: permille }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: u32 = 1000;

    fn watch(tolerated: u32) -> TickWatch {
        let counts_per_tick = NonZeroU32::new(PERIOD).unwrap();
        TickWatch::new(Some(TickClock { counts_per_tick, tolerated }))
    }

    /// Ticks that start at these counts, with the stages enabled since the first.
    fn of_starts(starts: &[u32]) -> TickCounts {
        let mut watch = watch(0);
        watch.started(Some(starts[0].wrapping_sub(PERIOD)), false);
        for at in starts {
            watch.started(Some(*at), true);
        }
        watch.counts()
    }

    fn counts(missed: u32, longest_delay_permille: u32) -> TickCounts {
        TickCounts { late: 0, missed, longest_delay_permille }
    }

    /// Ticks are due at 0, 1000, 2000 and so on, also beyond the range of the counter. One that starts a period late replaces the one that
    /// was due before: the interrupt of that one was lost. The next due time is not moved by a delay.
    #[test]
    fn each_tick_that_did_not_start_is_counted_once() {
        assert_eq!(of_starts(&[0, 1000, 2000, 3000]), counts(0, 0));
        assert_eq!(of_starts(&[0, 1999, 2000, 3000]), counts(0, 999));
        assert_eq!(of_starts(&[0, 2000, 3000]), counts(1, 1000));
        assert_eq!(of_starts(&[0, 2999, 3000, 4000]), counts(1, 1999));
        assert_eq!(of_starts(&[0, 3001, 4000, 6500, 7000]), counts(3, 2001));
        assert_eq!(of_starts(&[u32::MAX - 999, 0, 2100, 3000]), counts(1, 1100));
    }

    /// If the stop of the PWM or its start moves the phase of the ticks forwards, the next ones are due from there.
    #[test]
    fn a_tick_that_starts_early_sets_the_phase() {
        assert_eq!(of_starts(&[0, 700, 1700, 2700]), counts(0, 0));
        assert_eq!(of_starts(&[0, 700, 2700]), counts(1, 1000));
    }

    /// The fault is the first one above what is tolerated, of both kinds together; the next enable of the stages begins at none, and
    /// the counts remain.
    #[test]
    fn more_than_is_tolerated_since_the_enable_exceeds_it() {
        let mut watch = watch(3);
        watch.started(Some(0), false);
        watch.started(Some(1000), true);
        watch.ended(true);
        watch.started(Some(4000), true);
        assert!(!watch.is_exceeded());
        watch.ended(true);
        assert!(watch.is_exceeded());
        watch.ended(false);
        assert!(watch.is_exceeded());
        assert_eq!((watch.counts().late, watch.counts().missed), (2, 2));
        watch.started(Some(5000), false);
        assert!(!watch.is_exceeded());
        assert_eq!((watch.counts().late, watch.counts().missed), (2, 2));
    }

    /// With the stages off the program may stand still for seconds.
    #[test]
    fn nothing_is_missed_while_the_stages_are_off() {
        let mut watch = watch(0);
        for at in [0, 90_000, 1_000_000] {
            watch.started(Some(at), false);
        }
        assert_eq!((watch.counts(), watch.is_exceeded()), (TickCounts::default(), false));
    }

    #[test]
    fn without_a_counter_late_ticks_are_counted_and_none_is_tolerated() {
        let mut watch = TickWatch::new(None);
        watch.started(None, true);
        watch.ended(false);
        assert!(!watch.is_exceeded());
        watch.ended(true);
        assert!(watch.is_exceeded());
        assert_eq!(watch.counts(), TickCounts { late: 1, ..TickCounts::default() });
    }
}
