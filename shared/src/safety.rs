//! When the drives are on, and what turns them off.
//!
//! | state | event | next state |
//! |---|---|---|
//! | Off | enable | On |
//! | On | disable | Off: drives off, path forgotten |
//! | On | fault | Faulted: drives off, path forgotten |
//! | Faulted | disable (acknowledge) | Off |
//! | Faulted | enable | Faulted: nothing moves without a fresh enable after the acknowledgement |

use serde::{Deserialize, Serialize};

/// What can go wrong, with the axis (counted from 0) it happened on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// Command and feedback are further apart than declared.
    FollowingError {
        /// Axis.
        axis: u8,
    },
    /// The loop needs a linear scale and has no reading of it.
    ScaleLost {
        /// Axis.
        axis: u8,
    },
    /// A tick did not end before the next one was due.
    Overrun,
}

/// State of the drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Power {
    /// No force. The state after start-up.
    #[default]
    Off,
    /// The loops are closed.
    On,
    /// No force until the fault is acknowledged.
    Faulted(Fault),
}

/// What may change the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The operator switches the drives on.
    Enable,
    /// The operator switches them off, or acknowledges a fault.
    Disable,
    /// Something went wrong.
    Fault(Fault),
}

impl Power {
    /// The state after an event: every transition there is.
    #[must_use]
    pub const fn after(self, event: Event) -> Self {
        match (self, event) {
            (Self::Off | Self::On, Event::Enable) => Self::On,
            (_, Event::Disable) | (Self::Off, Event::Fault(_)) => Self::Off,
            (Self::On, Event::Fault(fault)) => Self::Faulted(fault),
            (Self::Faulted(_), Event::Enable | Event::Fault(_)) => self,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_needs_an_acknowledgement_before_an_enable() {
        let fault = Fault::FollowingError { axis: 0 };
        let faulted = Power::On.after(Event::Fault(fault));
        assert_eq!(faulted, Power::Faulted(fault));
        assert_eq!(faulted.after(Event::Enable), faulted);
        assert_eq!(faulted.after(Event::Disable).after(Event::Enable), Power::On);
    }

    #[test]
    fn a_drive_that_is_off_does_not_come_on_by_a_fault() {
        assert_eq!(Power::Off.after(Event::Fault(Fault::Overrun)), Power::Off);
    }
}
