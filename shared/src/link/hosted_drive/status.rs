//! The state of the drives, for a host.

use super::HostedDrive;
use crate::homing::HomingStatus;
use crate::link::packet::MAX_AXES;
use crate::link::receiver::LinkCounts;
use crate::link::report::{
    AxisStatus, DirectionReport, GantryStatus, HomingReport, SettingsReport, Status, UsbState,
};
use crate::machine::Reference;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> HostedDrive<'_, S, N> {
    /// The state, with what the server knows beside it; without the USB port.
    #[must_use]
    pub fn status(&self, link: LinkCounts, settings: SettingsReport) -> Status {
        let machine = self.machine();
        Status {
            tick: self.tick,
            power: machine.power(),
            warning: machine.warning(),
            not_armed: self.system.armed().err(),
            activity: self.activity,
            feed: machine.feed_state(),
            feed_override: self.feed_override(),
            rate_percent: machine.rate_percent(),
            at_rest: self.is_at_rest().is_ok(),
            blocks_left: self.blocks_left,
            axes: (0..N.min(MAX_AXES)).map(|axis| self.axis_status(axis)).collect(),
            ticks: self.system.tick_counts(),
            supply: self.system.supply(),
            homing: match self.system.homing_status() {
                None => HomingReport::None,
                Some((_, HomingStatus::Running)) => HomingReport::Running,
                Some((_, HomingStatus::Homed)) => HomingReport::Homed,
                Some((_, HomingStatus::Failed(error))) => HomingReport::Failed(error.into()),
            },
            probe: self.system.probe_status().map(|(_, status)| status),
            direction: match self.system.direction_check() {
                None => DirectionReport::None,
                Some((axis, None)) => DirectionReport::Running { axis: number(axis) },
                Some((axis, Some(result))) => DirectionReport::Ended { axis: number(axis), result },
            },
            capture: self.capture.state(),
            lost_samples: self.stream.lost(),
            settings,
            link,
            usb: UsbState::None,
        }
    }

    /// The state of an axis of the board.
    fn axis_status(&self, axis: usize) -> AxisStatus {
        let machine = self.machine();
        let inputs = &self.system.inputs().axes[axis];
        AxisStatus {
            command: machine.command()[axis],
            motor: self.readings[axis].motor,
            table: self.readings[axis].table,
            #[expect(clippy::cast_possible_truncation, reason = "for display")]
            force_n: self.forces[axis].value() as f32,
            homed: machine.reference(axis) == Some(Reference::Homed),
            signals: inputs.signals.map(|signals| signals.figures()),
            rms: self.rms_meter.axis(axis),
            counter: inputs.counter,
            lag: machine.following_lag(axis),
            gantry: self.gantry_status(axis),
        }
    }

    /// The gantry of a second motor.
    fn gantry_status(&self, axis: usize) -> Option<GantryStatus> {
        let machine = self.machine();
        Some(GantryStatus { first: number(machine.first_motor(axis)?), skew: machine.skew(axis)? })
    }
}

/// The number of an axis in a message.
fn number(axis: usize) -> u8 {
    u8::try_from(axis).unwrap_or(u8::MAX)
}
