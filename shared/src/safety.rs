//! The power state of the drives, and the reaction to each fault.
//!
//! # Power states
//!
//! | state | drives | path | event | next state |
//! |---|---|---|---|---|
//! | Off | off | at rest, follows the axes when they are moved | enable | On; Enabling if an axis has a brake |
//! | Off | | | inhibit: the previous run ended by a fault, or a loop has no reading of the scale that it uses, or a gantry has skew | Faulted |
//! | Off | | | fault, stopped, disable | Off |
//! | On | on | runs | fault that switches the drives off | Faulted |
//! | On | | | fault that stops | Stopping |
//! | On | | | fault that warns | On; the warning stays until disable |
//! | On | | | disable | Off, path discarded |
//! | On | | | disable in order, with a brake | Disabling |
//! | Enabling | on | waits; the brakes open | brakes opened | On |
//! | Enabling | | | fault that switches the drives off | Faulted |
//! | Enabling | | | fault that stops | Disabling, then Faulted |
//! | Enabling | | | disable | Off |
//! | Enabling | | | disable in order | Disabling |
//! | Disabling | on | decelerates along the path, then the brakes close | brakes closed | Off; Faulted after a fault |
//! | Disabling | | | fault that switches the drives off | Faulted, with that fault |
//! | Disabling | | | fault that stops | Disabling, then Faulted |
//! | Disabling | | | disable | Off |
//! | Stopping | on | decelerates along the path | stopped | Faulted; Disabling, then Faulted if an axis has a brake |
//! | Stopping | | | fault that switches the drives off | Faulted, with that fault |
//! | Stopping | | | fault that stops | Stopping |
//! | Stopping | | | fault that warns | Stopping; the warning stays until disable |
//! | Stopping | | | enable | Stopping |
//! | Stopping | | | disable | Off |
//! | Faulted | off | discarded | disable (acknowledge) | Off |
//! | Faulted | | | enable, fault, stopped | Faulted: after the acknowledgement a new enable is needed |
//!
//! The power stages are enabled in On, Enabling, Disabling and Stopping only ([`Power::is_on`]). A fault that switches the drives off also
//! closes the brakes in the same tick: a stage whose force or reading is wrong must not hold an axis until its brake has closed.
//!
//! # Faults
//!
//! | fault | checked | reaction | reason |
//! |---|---|---|---|
//! | following error | every position tick | drives off | the loop does not control the axis, so it cannot stop it either |
//! | motor and scale disagree | every position tick | drives off | a coupling or a sensor has failed; which one is unknown |
//! | encoder step | every tick | drives off | a motor cannot jump: the reading is wrong |
//! | encoder frozen: the command has moved, the motor reading has not | every position tick | drives off | a broken wire or a blocked axis: the force would grow without feedback |
//! | scale frozen: with a scale in the loop, the motor has moved and the scale has not (the reverse is a frozen encoder) | every position tick | drives off | a dead scale or a broken coupling: the motor would move without end |
//! | gantry skew: the two motors of a gantry are further from a square beam than declared | every position tick; before an enable, which is inhibited until acknowledged | drives off | one of them does not follow, and the other would bend the beam; without force it is relieved |
//! | overrun: more late or missed ticks than the board tolerates | every tick, while the power stages are enabled | drives off | the loops have missed their deadline |
//! | hardware stop | every tick, by the board | drives off | emergency stop, a fault of a power stage, or a low supply of the chip; the hardware has disabled the stage, or the tick does |
//! | emergency stop | every tick, by the board | drives off | the hardware has cut the stages, or is about to |
//! | drive fault | every tick, by the board | drives off | the drive does not follow the force |
//! | encoder signal: sine and cosine of the motor outside their amplitudes | every tick, by the board | drives off | the reading is wrong, or will be |
//! | bus over-voltage | every tick, by the board | drives off | braking feeds the bus: without force it rises no further |
//! | bus under-voltage | every tick, by the board | drives off | the force is not what the loops compute |
//! | over-temperature | every tick, by the board | stop | there is time for an orderly stop |
//! | host silent for its declared time | by the connection | stop | nobody supervises the motion |
//! | limit switch: the command moves further onto it | every tick | stop | the way back stays open |
//! | watchdog | at start-up, by the board | enable inhibited until acknowledged | the previous run ended by a watchdog reset |
//! | stored settings: the flash holds settings that cannot be used | at start-up, by the board | enable inhibited until acknowledged | the settings are those of the program instead |
//! | force saturated for longer than its budget; unsaturated time earns back a quarter | every tick | stop | the axis cannot follow; a lower acceleration helps |
//! | soft limit: the command moves outwards beyond the travel, or further out than an axis that was enabled outside it; an axis that follows a counter could no longer stop within it | every position tick | stop | only the program is wrong; the way back stays open |
//! | gear lag: an axis that follows a counter is further from its setpoint than declared | every position tick | stop | the master is faster than the axis may be; caught up, it would go on for long after the master stands |
//! | scale lost | every position tick | warn | the axis continues on its motor encoder, without a step |
//! | scale lost | at enable | enable inhibited until acknowledged | when the scale returns, the axis would jump to its reading |
//! | displaced: an axis is away from the start of the waiting path | at enable | warn, discard the path | the axis holds its position instead of jumping to the start of the path |

use serde::{Deserialize, Serialize};

/// A fault that can occur on an axis. [`Fault`] adds which axis, and the faults of the whole machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FaultKind {
    /// The following error exceeds its limit.
    FollowingError,
    /// The difference between motor and linear scale exceeds its limit.
    Disagreement,
    /// The motor reading has moved further in a tick than the motor can.
    EncoderStep,
    /// The force has been at its limit for longer than its budget.
    ForceSaturated,
    /// The command has left the travel.
    SoftLimit,
    /// The loop uses a linear scale and has no reading of it.
    ScaleLost,
    /// The command, or the scale of the loop, has moved while the motor reading stood still.
    EncoderFrozen,
    /// The axis was enabled away from the start of the waiting path.
    Displaced,
    /// The drive reports a fault.
    DriveFault,
    /// The signals of the motor encoder or resolver are too weak or too strong to be read.
    EncoderSignal,
    /// The command moves further onto an active limit switch.
    LimitSwitch,
    /// The motor has moved while the scale of the loop stood still.
    ScaleFrozen,
    /// An axis that follows a counter is further from its setpoint than declared.
    GearLag,
    /// The two motors of a gantry are further from a square beam than declared; of its second motor.
    GantrySkew,
}

impl FaultKind {
    /// Every kind, the most severe reaction first.
    pub const ALL: [Self; 14] = [
        Self::FollowingError,
        Self::Disagreement,
        Self::EncoderStep,
        Self::EncoderFrozen,
        Self::ScaleFrozen,
        Self::DriveFault,
        Self::EncoderSignal,
        Self::GantrySkew,
        Self::ForceSaturated,
        Self::SoftLimit,
        Self::LimitSwitch,
        Self::GearLag,
        Self::ScaleLost,
        Self::Displaced,
    ];

    /// The reaction: see the [module](self).
    #[must_use]
    pub const fn reaction(self) -> Reaction {
        match self {
            Self::FollowingError
            | Self::Disagreement
            | Self::EncoderStep
            | Self::EncoderFrozen
            | Self::ScaleFrozen
            | Self::DriveFault
            | Self::EncoderSignal
            | Self::GantrySkew => Reaction::DriveOff,
            Self::ForceSaturated | Self::SoftLimit | Self::LimitSwitch | Self::GearLag => Reaction::Stop,
            Self::ScaleLost | Self::Displaced => Reaction::Warn,
        }
    }
}

/// The faults of an axis in one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultSet(u32);

impl FaultSet {
    /// No fault.
    pub const NONE: Self = Self(0);

    /// The set with `kind` added if it is `present`.
    #[must_use]
    pub const fn with(self, kind: FaultKind, present: bool) -> Self {
        Self(self.0 | (present as u32) << kind as u8)
    }

    /// Whether there is no fault.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The faults, the most severe reaction first.
    pub fn iter(self) -> impl Iterator<Item = FaultKind> {
        FaultKind::ALL.into_iter().filter(move |&kind| self.0 & 1 << kind as u8 != 0)
    }
}

/// A fault of an axis or of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// On one axis.
    Axis {
        /// Axis, counted from 0.
        axis: u8,
        /// What has failed.
        kind: FaultKind,
    },
    /// A tick did not end before the next one was due, or its interrupt was lost, more often than the board tolerates.
    Overrun,
    /// The emergency stop or a fault of a power stage has disabled the stages in hardware, or the supply of the chip is low.
    HardwareStop,
    /// The previous run ended by a reset of the watchdog.
    Watchdog,
    /// The emergency stop is pressed.
    EmergencyStop,
    /// The bus voltage is above its limit.
    BusOvervoltage,
    /// The bus voltage is below its limit.
    BusUndervoltage,
    /// A power stage is too hot.
    OverTemperature,
    /// The host that moves the machine has been silent for too long.
    HostSilent,
    /// The flash holds settings that cannot be used.
    StoredSettings,
}

/// The reaction to a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// No force from this tick on.
    DriveOff,
    /// Stop along the path with the declared deceleration, then no force.
    Stop,
    /// Continue, and report a warning.
    Warn,
}

impl Fault {
    /// The faults of the whole machine.
    pub const OF_THE_MACHINE: [Self; 9] = [
        Self::Overrun,
        Self::HardwareStop,
        Self::Watchdog,
        Self::EmergencyStop,
        Self::BusOvervoltage,
        Self::BusUndervoltage,
        Self::OverTemperature,
        Self::HostSilent,
        Self::StoredSettings,
    ];

    /// The reaction: see the [module](self).
    #[must_use]
    pub const fn reaction(self) -> Reaction {
        match self {
            Self::Overrun
            | Self::HardwareStop
            | Self::Watchdog
            | Self::StoredSettings
            | Self::EmergencyStop
            | Self::BusOvervoltage
            | Self::BusUndervoltage => Reaction::DriveOff,
            Self::OverTemperature | Self::HostSilent => Reaction::Stop,
            Self::Axis { kind, .. } => kind.reaction(),
        }
    }
}

/// Power state of the drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Power {
    /// No force. The state after start-up.
    #[default]
    Off,
    /// The loops are closed.
    On,
    /// The loops are closed, and the path decelerates.
    Stopping(Fault),
    /// No force until the fault is acknowledged.
    Faulted(Fault),
    /// The loops are closed and hold the axes, whose brakes open: a motion has to wait.
    Enabling,
    /// The loops are closed and hold the axes until their brakes have closed; a path that runs decelerates before. Then the drives go off,
    /// by a fault if there was one.
    Disabling(Option<Fault>),
}

/// An event that may change the power state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The operator enables the drives.
    Enable,
    /// The operator enables the drives of a machine with a brake.
    EnableWithBrakes,
    /// The brakes have opened.
    BrakesOpened,
    /// The operator disables them, or acknowledges a fault.
    Disable,
    /// The drives of a machine with a brake are disabled in order: by the operator, or after a stop.
    DisableWithBrakes,
    /// The brakes have closed.
    BrakesClosed,
    /// A fault has occurred.
    Fault(Fault),
    /// The path has come to rest after a stop.
    Stopped,
    /// A fault that is found while the drives are off prevents that they are enabled.
    Inhibit(Fault),
}

impl Power {
    /// The state after an event. Total: every transition is listed.
    #[must_use]
    pub const fn after(self, event: Event) -> Self {
        match (self, event) {
            (Self::Off, Event::Enable) | (Self::Enabling, Event::BrakesOpened) => Self::On,
            (Self::Off, Event::EnableWithBrakes) => Self::Enabling,
            (_, Event::Disable) | (Self::Disabling(None), Event::BrakesClosed) => Self::Off,
            (Self::On | Self::Enabling, Event::DisableWithBrakes) => Self::Disabling(None),
            (Self::Stopping(fault), Event::DisableWithBrakes) => Self::Disabling(Some(fault)),
            (Self::Off | Self::Faulted(_), Event::Fault(_)) => self,
            (_, Event::Fault(fault)) => self.after_fault(fault),
            (Self::Stopping(fault), Event::Stopped)
            | (Self::Disabling(Some(fault)), Event::BrakesClosed)
            | (Self::Off, Event::Inhibit(fault)) => Self::Faulted(fault),
            (
                _,
                Event::Enable
                | Event::EnableWithBrakes
                | Event::BrakesOpened
                | Event::DisableWithBrakes
                | Event::BrakesClosed
                | Event::Stopped
                | Event::Inhibit(_),
            ) => self,
        }
    }

    /// The state after a fault of drives that are on.
    const fn after_fault(self, fault: Fault) -> Self {
        match (self, fault.reaction()) {
            (_, Reaction::DriveOff) => Self::Faulted(fault),
            (Self::On, Reaction::Stop) => Self::Stopping(fault),
            (Self::Enabling | Self::Disabling(None), Reaction::Stop) => Self::Disabling(Some(fault)),
            (state, _) => state,
        }
    }

    /// The fault that stops the path, or has switched the drives off.
    #[must_use]
    pub const fn fault(self) -> Option<Fault> {
        match self {
            Self::Stopping(fault) | Self::Faulted(fault) | Self::Disabling(Some(fault)) => Some(fault),
            Self::Off | Self::On | Self::Enabling | Self::Disabling(None) => None,
        }
    }

    /// Whether the drives may produce force.
    #[must_use]
    pub const fn is_on(self) -> bool {
        !matches!(self, Self::Off | Self::Faulted(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn on(kind: FaultKind) -> Fault {
        Fault::Axis { axis: 0, kind }
    }

    fn faults() -> impl Iterator<Item = Fault> {
        FaultKind::ALL.into_iter().map(on).chain(Fault::OF_THE_MACHINE)
    }

    #[test]
    fn a_fault_set_keeps_every_fault() {
        let faults = FaultSet::NONE.with(FaultKind::ScaleLost, true).with(FaultKind::Displaced, false);
        let faults = faults.with(FaultKind::SoftLimit, true);
        assert!(!faults.is_empty() && FaultSet::NONE.is_empty());
        assert!(faults.iter().eq([FaultKind::SoftLimit, FaultKind::ScaleLost]));
        let all = FaultKind::ALL.into_iter().fold(FaultSet::NONE, |all, kind| all.with(kind, true));
        assert!(all.iter().eq(FaultKind::ALL));
        // Adding a fault that is in the set changes nothing.
        assert_eq!(all.with(FaultKind::SoftLimit, true), all);
        assert_eq!(all.with(FaultKind::SoftLimit, false), all);
    }

    #[test]
    fn a_fault_of_the_previous_run_needs_an_acknowledgement() {
        let inhibit = Event::Inhibit(Fault::Watchdog);
        assert_eq!(Power::Off.after(inhibit), Power::Faulted(Fault::Watchdog));
        // An inhibit acts while the drives are off only.
        for power in [Power::On, Power::Stopping(on(FaultKind::SoftLimit)), Power::Faulted(Fault::Overrun)] {
            assert_eq!(power.after(inhibit), power);
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
    fn only_an_enable_switches_the_drives_on() {
        for event in faults().map(Event::Fault).chain([Event::Disable, Event::Stopped]) {
            assert_eq!(Power::Off.after(event), Power::Off);
        }
        assert!(Power::Off.after(Event::Enable).is_on());
    }

    /// With brakes, each way from off to on and back leads over the state that waits for them.
    #[test]
    fn brakes_open_before_a_motion_and_close_before_the_drives_go_off() {
        let enabling = Power::Off.after(Event::EnableWithBrakes);
        assert_eq!((enabling, enabling.after(Event::BrakesOpened)), (Power::Enabling, Power::On));
        for power in [Power::On, Power::Enabling] {
            let disabling = power.after(Event::DisableWithBrakes);
            assert_eq!(
                (disabling, disabling.after(Event::BrakesClosed)),
                (Power::Disabling(None), Power::Off)
            );
            assert_eq!(disabling.after(Event::EnableWithBrakes), disabling);
        }
        let fault = on(FaultKind::SoftLimit);
        let disabling = Power::Stopping(fault).after(Event::DisableWithBrakes);
        assert_eq!(disabling, Power::Disabling(Some(fault)));
        assert_eq!(disabling.after(Event::BrakesClosed), Power::Faulted(fault));
    }

    /// While brakes open or close the axes stand: a fault that stops closes the brakes; one that switches the drives off does so at
    /// once, as does a disable.
    #[test]
    fn each_fault_has_its_reaction_while_brakes_move() {
        for fault in faults() {
            for power in [Power::Enabling, Power::Disabling(None), Power::Disabling(Some(Fault::HostSilent))]
            {
                let after = power.after(Event::Fault(fault));
                match (fault.reaction(), power) {
                    (Reaction::DriveOff, _) => assert_eq!(after, Power::Faulted(fault)),
                    (Reaction::Warn, _) | (_, Power::Disabling(Some(_))) => assert_eq!(after, power),
                    (Reaction::Stop, _) => assert_eq!(after, Power::Disabling(Some(fault))),
                }
                assert!(power.is_on() && power.after(Event::Disable) == Power::Off);
            }
        }
    }

    #[test]
    fn each_fault_has_its_reaction() {
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
