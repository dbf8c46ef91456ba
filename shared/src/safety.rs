//! When the drives are on, what is watched, and what each fault does.
//!
//! | state | drives | path | event | next state |
//! |---|---|---|---|---|
//! | Off | off | stands, follows the axes as they are moved | enable | On |
//! | Off | | | the run before ended by a fault; an enable while a loop has no reading of the scale that it needs | Faulted |
//! | Off | | | fault, stopped, disable | Off |
//! | On | on | travels | fault that puts the drives off | Faulted |
//! | On | | | fault that stops | Stopping |
//! | On | | | fault that warns | On, the warning stands until disable |
//! | On | | | disable | Off, path forgotten |
//! | Stopping | on | slows down along itself | stopped | Faulted |
//! | Stopping | | | fault that puts the drives off | Faulted, with that fault |
//! | Stopping | | | fault that stops | Stopping |
//! | Stopping | | | fault that warns | Stopping, the warning stands until disable |
//! | Stopping | | | enable | Stopping |
//! | Stopping | | | disable | Off |
//! | Faulted | off | forgotten | disable (acknowledge) | Off |
//! | Faulted | | | enable, fault, stopped | Faulted: nothing moves without a fresh enable after the acknowledgement |
//!
//! The power stages are enabled in On and in Stopping ([`Power::is_on`]), and nowhere else.
//!
//! | fault | looked for | reaction | why |
//! |---|---|---|---|
//! | following error | every position tick | drives off | the loop does not hold the axis: it cannot stop it either |
//! | motor and scale disagree | every position tick | drives off | a coupling or a sensor has gone; which one is not known |
//! | encoder step | every tick | drives off | a motor cannot jump: what the loop reads is not where the axis is |
//! | encoder frozen: the command has moved on, the motor reading has not | every position tick | drives off | a wire is broken or the axis is stuck: the force would grow without anybody seeing what it does |
//! | overrun | every tick | drives off | the loops have not run in time |
//! | hardware stop | every tick, by the board | drives off | emergency stop, or the power stage's own fault: the hardware has cut the stage already |
//! | watchdog | at the start, by the board | stays off until acknowledged | the run before did not end by itself |
//! | force saturated for a time, less a quarter of the time since that it was not | every tick | stop | the axis follows less than is asked for: asking for less helps |
//! | soft limit: the command goes outwards beyond the travel, or further out than an axis that came on outside it | every position tick | stop | all is well but the program; the way back is open |
//! | scale lost | every position tick | warn | the axis goes on with its motor encoder, from where it stood |
//! | scale lost | when the drives are to come on | stays off until acknowledged | once the scale is back, the axis would go to wherever that sees it |
//! | displaced: an axis stands away from where the path that waits begins | when the drives come on | warn, forget the path | the axis holds where it is and does not jump to where the path was planned from |

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
    /// The command has moved on while the motor reading stood.
    EncoderFrozen,
    /// The drives came on with the axis away from where the waiting path begins.
    Displaced,
}

impl Hazard {
    /// All there are, the gravest first: what puts the drives off, what stops, what warns.
    pub const ALL: [Self; 8] = [
        Self::FollowingError,
        Self::Disagreement,
        Self::EncoderStep,
        Self::EncoderFrozen,
        Self::ForceSaturated,
        Self::SoftLimit,
        Self::ScaleLost,
        Self::Displaced,
    ];

    /// What it does on any axis: see the table above.
    #[must_use]
    pub const fn reaction(self) -> Reaction {
        match self {
            Self::FollowingError | Self::Disagreement | Self::EncoderStep | Self::EncoderFrozen => {
                Reaction::DriveOff
            }
            Self::ForceSaturated | Self::SoftLimit => Reaction::Stop,
            Self::ScaleLost | Self::Displaced => Reaction::Warn,
        }
    }
}

/// The hazards of an axis in one tick: a grave one does not hide a light one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hazards(u8);

impl Hazards {
    /// All is well.
    pub const NONE: Self = Self(0);

    /// These and, where `seen`, one more.
    #[must_use]
    pub const fn with(self, hazard: Hazard, seen: bool) -> Self {
        Self(self.0 | (seen as u8) << hazard as u8)
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Each of them, the gravest first.
    pub fn iter(self) -> impl Iterator<Item = Hazard> {
        Hazard::ALL.into_iter().filter(move |&hazard| self.0 & 1 << hazard as u8 != 0)
    }
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
    /// The emergency stop, or a fault of a power stage, has cut the stages in hardware.
    HardwareStop,
    /// The run before ended because nothing fed the watchdog.
    Watchdog,
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
            Self::Overrun | Self::HardwareStop | Self::Watchdog => Reaction::DriveOff,
            Self::Axis { hazard, .. } => hazard.reaction(),
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
    /// A fault is found before the drives are on: the run before ended by it, or a loop lacks its sensor.
    Found(Fault),
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
            (Self::Stopping(fault), Event::Stopped) | (Self::Off, Event::Found(fault)) => {
                Self::Faulted(fault)
            }
            (Self::On, Event::Stopped)
            | (Self::Stopping(_), Event::Enable)
            | (Self::Faulted(_), Event::Enable | Event::Fault(_) | Event::Stopped)
            | (_, Event::Found(_)) => self,
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

    fn faults() -> impl Iterator<Item = Fault> {
        let others = [Fault::Overrun, Fault::HardwareStop, Fault::Watchdog];
        Hazard::ALL.into_iter().map(on).chain(others)
    }

    #[test]
    fn a_grave_hazard_hides_no_light_one() {
        let seen = Hazards::NONE.with(Hazard::ScaleLost, true).with(Hazard::Displaced, false);
        let seen = seen.with(Hazard::SoftLimit, true);
        assert!(!seen.is_empty() && Hazards::NONE.is_empty());
        assert!(seen.iter().eq([Hazard::SoftLimit, Hazard::ScaleLost]));
        let all = Hazard::ALL.into_iter().fold(Hazards::NONE, |all, hazard| all.with(hazard, true));
        assert!(all.iter().eq(Hazard::ALL));
        // What is there already stays there.
        assert_eq!(all.with(Hazard::SoftLimit, true), all);
        assert_eq!(all.with(Hazard::SoftLimit, false), all);
    }

    #[test]
    fn what_ended_the_run_before_has_to_be_acknowledged() {
        let found = Event::Found(Fault::Watchdog);
        assert_eq!(Power::Off.after(found), Power::Faulted(Fault::Watchdog));
        // Only while the drives are off is there anything to be found.
        for power in [Power::On, Power::Stopping(on(Hazard::SoftLimit)), Power::Faulted(Fault::Overrun)] {
            assert_eq!(power.after(found), power);
        }
    }

    #[test]
    fn a_fault_needs_an_acknowledgement_before_an_enable() {
        for fault in faults() {
            let faulted = Power::Faulted(fault);
            for event in [Event::Enable, Event::Stopped, Event::Fault(Fault::Overrun)] {
                assert_eq!(faulted.after(event), faulted);
            }
            assert_eq!(faulted.after(Event::Disable).after(Event::Enable), Power::On);
        }
    }

    #[test]
    fn a_drive_that_is_off_comes_on_by_enable_alone() {
        for event in faults().map(Event::Fault).chain([Event::Disable, Event::Stopped]) {
            assert_eq!(Power::Off.after(event), Power::Off);
        }
        assert!(Power::Off.after(Event::Enable).is_on());
    }

    #[test]
    fn each_fault_does_what_it_deserves() {
        for fault in faults() {
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
