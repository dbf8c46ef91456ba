//! The holding brakes of the axes: when they open and close, and how long the drives hold the axes for them.
//!
//! The power stages of a machine come on and go off together, and so do its brakes, for which the slowest one counts.
//!
//! | tick | stages | brakes | power |
//! |---|---|---|---|
//! | n, an enable | on, with the preload | closed | Enabling |
//! | n + 1: the stages have had their force for a tick | on | open | Enabling |
//! | n + 1 + release | on | open | On: a path may move |
//! | m, a disable in order, axes at rest | on | closed | Disabling |
//! | m + engage | off | closed | Off |
//!
//! Axes that move decelerate first: m is then the tick after the one in which they have stopped.

use super::config::MachineConfig;
use crate::config::BrakeTicks;
use crate::safety::{Event, Power};
use crate::scalar::Scalar;

/// What the brakes do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Brakes {
    /// Whether their output opens them, as long as the stages are on.
    open: bool,
    /// Ticks until they have followed their output.
    remaining: u32,
}

impl Brakes {
    /// Closed.
    pub const CLOSED: Self = Self { open: false, remaining: 0 };

    /// Whether the output opens the brakes.
    pub const fn are_open(self) -> bool {
        self.open
    }

    /// The start of a tick in which the machine is neither on nor off: opens or closes the brakes, or lets their time pass.
    pub fn tick(&mut self, power: Power, times: BrakeTicks, at_rest: bool) -> Option<Event> {
        let (opens, time, done) = match power {
            Power::Enabling => (true, times.release, Event::BrakesOpened),
            Power::Disabling(_) => (false, times.engage, Event::BrakesClosed),
            Power::Off | Power::On | Power::Stopping(_) | Power::Faulted(_) => return None,
        };
        if self.open == opens {
            self.remaining = self.remaining.saturating_sub(1);
        } else if opens || at_rest {
            *self = Self { open: opens, remaining: time };
        } else {
            return None;
        }
        (self.remaining == 0).then_some(done)
    }
}

impl<S: Scalar, const N: usize> MachineConfig<S, N> {
    /// The times of the slowest brake; `None`: no axis has one.
    pub(super) fn brake_times(&self) -> Option<BrakeTicks> {
        self.axes
            .iter()
            .filter_map(|axis| axis.brake)
            .reduce(|a, b| BrakeTicks { release: a.release.max(b.release), engage: a.engage.max(b.engage) })
    }
}
