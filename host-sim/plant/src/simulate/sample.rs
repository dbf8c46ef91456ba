//! One row of a log, of one axis.

use shared::axis::Reading;

use crate::machine_sim::Measurement;
use files::log::Channel;

/// The logged channels of one axis at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Position command.
    pub command_mm: f64,
    /// Reading of the motor encoder.
    pub motor_mm: f64,
    /// Reading of the linear scale.
    pub table_mm: f64,
    /// Reading of the tool-point probe.
    pub tool_mm: f64,
    /// Force commanded for the last tick.
    pub force_n: f64,
}

impl Sample {
    /// The channels, in the order of a log's columns.
    pub const CHANNELS: [Channel; 5] =
        [Channel::Command, Channel::Motor, Channel::Table, Channel::Tool, Channel::Force];

    /// The values of [`Sample::CHANNELS`].
    #[must_use]
    pub const fn values(&self) -> [f64; 5] {
        [self.command_mm, self.motor_mm, self.table_mm, self.tool_mm, self.force_n]
    }

    pub(super) fn new(reading: &Reading, command_m: f64, measured: &Measurement) -> Self {
        Self {
            command_mm: 1e3 * command_m,
            motor_mm: 1e3 * (reading.motor.to_m() + measured.motor_offset_m),
            table_mm: 1e3 * measured.table_m,
            tool_mm: 1e3 * measured.tool_m,
            force_n: measured.force_n,
        }
    }
}
