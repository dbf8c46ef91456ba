//! A board with two drives, on any chip: what its inputs mean, and what its outputs are set to. A chip has the registers ([`Registers`]).
//!
//! | chip | registers |
//! |---|---|
//! | STM32F405 | `firmware/src/board` |
//! | STM32G474 | `firmware/src/g474` |

pub mod counters;
mod hardware;
mod sensors;
pub mod serial;
mod stages;
pub mod switches;

#[cfg(any(feature = "board", feature = "board-g474"))]
pub mod locked;

pub use hardware::Hardware;
pub use sensors::Sensors;

use counters::Counters;
use shared::drive::DriveSettings;
use shared::link::HostedDrive;
use shared::scalar::Fixed;
use switches::{Levels, Wiring};

use crate::setup::{AXES, AxisTable};

/// The drives under the control of a host.
pub type Drive = HostedDrive<'static, Fixed, AXES>;

/// Results of one trigger of the converters, counts of 12 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Conversions {
    /// Sine and cosine of each axis.
    pub resolvers: [[u16; 2]; AXES],
    /// Bus voltage.
    pub bus: u16,
    /// Temperature.
    pub temperature: u16,
}

/// The registers of a chip that a tick accesses.
pub trait Registers {
    /// Its counters.
    type Counters: Counters;

    /// Pins of the switches.
    const WIRING: &'static Wiring;

    /// The start of a tick: clears the flag of its interrupt. If it is set again during the tick, the next tick is due.
    fn acknowledge_tick(&mut self);

    /// Whether the next tick is due.
    fn tick_is_due(&self) -> bool;

    /// The count of the clock cycles of the core at the start of the present tick.
    fn started_at(&self) -> u32;

    /// Input data of the ports.
    fn levels(&self) -> Levels;

    /// Results of the last trigger.
    fn conversions(&self) -> Conversions;

    /// Sets the direction pins: high for a negative force.
    fn set_directions(&mut self, reverse: [bool; AXES]);

    /// Sets the compare value of an axis, which takes effect with the next period: the pulse begins there and ends with the period.
    fn set_compare(&mut self, axis: usize, counts: u16);

    /// Sets the analogue output of an axis, counts of 12 bits, which takes effect at once.
    fn set_analog(&mut self, axis: usize, counts: u16);

    /// Enables or disables the stages: main output of the PWM, and the enable pin.
    fn set_outputs(&mut self, on: bool);

    /// Opens or closes the brakes.
    fn set_brakes_open(&mut self, open: bool);

    /// Whether the hardware has stopped the PWM since the last call.
    fn take_stop(&mut self) -> bool;

    /// Switches the fault light.
    fn set_light(&mut self, lit: bool);
}

/// Counts of the converter for 0 V.
#[must_use]
pub const fn zero_volts(axis: AxisTable) -> u16 {
    match axis.drive {
        DriveSettings::Analog(settings) => settings.zero,
        DriveSettings::Pwm { .. } | DriveSettings::Steps { .. } => 2048,
    }
}
