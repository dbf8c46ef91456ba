//! When the drives are on, what is watched, and what each fault does.
//!
//! | state | drives | path | event | next state |
//! |---|---|---|---|---|
//! | Off | off | stands, follows the axes as they are moved | enable | On |
//! | Off | | | fault, stopped, disable | Off |
//! | On | on | travels | fault that puts the drives off | Faulted |
//! | On | | | fault that stops | Stopping |
//! | On | | | fault that warns | On, the warning stands until disable |
//! | On | | | disable | Off, path forgotten |
//! | Stopping | on | slows down along itself | stopped | Faulted |
//! | Stopping | | | fault that puts the drives off | Faulted, with that fault |
//! | Stopping | | | another fault, enable | Stopping |
//! | Stopping | | | disable | Off |
//! | Faulted | off | forgotten | disable (acknowledge) | Off |
//! | Faulted | | | enable, fault, stopped | Faulted: nothing moves without a fresh enable after the acknowledgement |
//!
//! | fault | looked for | reaction | why |
//! |---|---|---|---|
//! | following error | every position tick | drives off | the loop does not hold the axis: it cannot stop it either |
//! | motor and scale disagree | every position tick | drives off | a coupling or a sensor has gone; which one is not known |
//! | encoder step | every tick | drives off | a motor cannot jump: what the loop reads is not where the axis is |
//! | overrun | every tick | drives off | the loops have not run in time |
//! | force saturated for a time, less a quarter of the time since that it was not | every tick | stop | the axis follows less than is asked for: asking for less helps |
//! | soft limit | every position tick | stop | all is well but the program |
//! | scale lost | every position tick | warn | the axis goes on with its motor encoder, from where it stood |

use serde::{Deserialize, Serialize};

/// What can go wrong on one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Hazard {
    /// Command and feedback are further apart than declared.
    FollowingError,
    /// Motor and linear scale are further apart than declared.
    Disagreement,
    /// The motor reading has moved further in a tick than the motor can.
    EncoderStep,
    /// The force has stood at its limit for longer than declared.
    ForceSaturated,
    /// The command has left the declared travel.
    SoftLimit,
    /// The loop uses a linear scale and has no reading of it.
    ScaleLost,
}

/// A fault, with the axis (counted from 0) that it happened on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// On one axis.
    Axis {
        /// Axis.
        axis: u8,
        /// What.
        hazard: Hazard,
    },
    /// A tick did not end before the next one was due.
    Overrun,
}

/// What a fault does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// No force from this tick on.
    DriveOff,
    /// Stop along the path with the declared deceleration, then no force.
    Stop,
    /// Go on, and say so.
    Warn,
}

impl Fault {
    /// What the fault does: see the table above.
    #[must_use]
    pub const fn reaction(self) -> Reaction {
        match self {
            Self::Overrun => Reaction::DriveOff,
            Self::Axis { hazard, .. } => match hazard {
                Hazard::FollowingError | Hazard::Disagreement | Hazard::EncoderStep => Reaction::DriveOff,
                Hazard::ForceSaturated | Hazard::SoftLimit => Reaction::Stop,
                Hazard::ScaleLost => Reaction::Warn,
            },
        }
    }
}

/// State of the drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Power {
    /// No force. The state after start-up.
    #[default]
    Off,
    /// The loops are closed.
    On,
    /// The loops are closed, and the path slows down.
    Stopping(Fault),
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
    /// A path that was to stop stands.
    Stopped,
}

impl Power {
    /// The state after an event: every transition there is.
    #[must_use]
    pub const fn after(self, event: Event) -> Self {
        match (self, event) {
            (Self::Off | Self::On, Event::Enable) => Self::On,
            (_, Event::Disable) | (Self::Off, Event::Fault(_) | Event::Stopped) => Self::Off,
            (Self::On | Self::Stopping(_), Event::Fault(fault)) => match (self, fault.reaction()) {
                (_, Reaction::DriveOff) => Self::Faulted(fault),
                (Self::On, Reaction::Stop) => Self::Stopping(fault),
                (state, _) => state,
            },
            (Self::Stopping(fault), Event::Stopped) => Self::Faulted(fault),
            (Self::On, Event::Stopped)
            | (Self::Stopping(_), Event::Enable)
            | (Self::Faulted(_), Event::Enable | Event::Fault(_) | Event::Stopped) => self,
        }
    }

    /// Whether the drives may give force.
    #[must_use]
    pub const fn is_on(self) -> bool {
        matches!(self, Self::On | Self::Stopping(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn on(hazard: Hazard) -> Fault {
        Fault::Axis { axis: 0, hazard }
    }

    const FAULTS: [Fault; 7] = [
        on(Hazard::FollowingError),
        on(Hazard::Disagreement),
        on(Hazard::EncoderStep),
        on(Hazard::ForceSaturated),
        on(Hazard::SoftLimit),
        on(Hazard::ScaleLost),
        Fault::Overrun,
    ];

    #[test]
    fn a_fault_needs_an_acknowledgement_before_an_enable() {
        for fault in FAULTS {
            let faulted = Power::Faulted(fault);
            for event in [Event::Enable, Event::Stopped, Event::Fault(Fault::Overrun)] {
                assert_eq!(faulted.after(event), faulted);
            }
            assert_eq!(faulted.after(Event::Disable).after(Event::Enable), Power::On);
        }
    }

    #[test]
    fn a_drive_that_is_off_comes_on_by_enable_alone() {
        for event in FAULTS.map(Event::Fault).into_iter().chain([Event::Disable, Event::Stopped]) {
            assert_eq!(Power::Off.after(event), Power::Off);
        }
        assert!(Power::Off.after(Event::Enable).is_on());
    }

    #[test]
    fn each_fault_does_what_it_deserves() {
        for fault in FAULTS {
            let after = Power::On.after(Event::Fault(fault));
            match fault.reaction() {
                Reaction::DriveOff => assert_eq!(after, Power::Faulted(fault)),
                Reaction::Stop => {
                    assert_eq!(after, Power::Stopping(fault));
                    assert_eq!(after.after(Event::Enable), after);
                    assert_eq!(after.after(Event::Stopped), Power::Faulted(fault));
                    assert_eq!(after.after(Event::Fault(Fault::Overrun)), Power::Faulted(Fault::Overrun));
                    assert_eq!(after.after(Event::Disable), Power::Off);
                }
                Reaction::Warn => assert_eq!(after, Power::On),
            }
        }
    }
}
