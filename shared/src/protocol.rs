//! What a host and a board say to each other, as postcard in frames of a fixed length.
//!
//! The host sends [`Setup`] and [`Order::Block`]s, then one [`Order::Tick`] a tick with the sensors;
//! the board answers each with one [`Answer`]. A frame is [`FRAME`] bytes, padded with zeros, so that
//! a reader knows how much to wait for.

use serde::{Deserialize, Serialize};

use crate::axis::Reading;
use crate::config::{AxisSettings, Rates};
use crate::interpolate::Block;
use crate::safety::Power;
use crate::units::Position;

/// Length of every frame in bytes.
pub const FRAME: usize = 256;

/// Axes of the protocol.
pub const AXES: usize = 2;

/// The number format that the board is to compute in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Format {
    /// [`crate::scalar::Fixed`].
    Fixed,
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}

/// The machine that the board is to control.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// Number format.
    pub format: Format,
    /// Loop rates.
    pub rates: Rates,
    /// Axes.
    pub axes: [AxisSettings; AXES],
    /// Where they stand.
    pub start: [Position; AXES],
}

/// From host to board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Order {
    /// Be this machine, drives off.
    Setup(Setup),
    /// Append to the path.
    Block(Block<AXES>),
    /// Drives on.
    Enable,
    /// Drives off; acknowledge a fault.
    Disable,
    /// One tick with these readings.
    Tick([Reading; AXES]),
    /// The run has ended.
    End,
}

/// From board to host, one for each order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// Done.
    Ready,
    /// Refused; see [`Refusal`].
    Refused(Refusal),
    /// Result of a tick.
    Tick(Ticked),
}

/// Why an order was refused. The host has the same code and can say more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// The bytes are no order.
    Unreadable,
    /// No [`Setup`] came before.
    NotSetUp,
    /// A setting of this axis is out of range.
    Settings {
        /// Axis.
        axis: u8,
    },
    /// The block cannot be planned.
    Path(crate::interpolate::PathError),
}

/// What a tick gave.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ticked {
    /// Bits of the force of each axis in the format of the setup.
    pub force_bits: [u64; AXES],
    /// Command of each axis.
    pub commands: [Position; AXES],
    /// State of the drives.
    pub power: Power,
    /// Whether every block has been travelled.
    pub done: bool,
    /// Cost of the tick as the board counts it: instructions where it is emulated, else cycles.
    pub cost: u32,
}

/// Writes a message into a frame.
///
/// # Errors
/// When the message does not fit: none of this protocol's is longer than [`FRAME`].
pub fn encode(message: &impl Serialize, frame: &mut [u8; FRAME]) -> postcard::Result<()> {
    frame.fill(0);
    postcard::to_slice(message, frame).map(|_| ())
}

/// Reads a message from a frame.
///
/// # Errors
/// When the bytes are no such message.
pub fn decode<'a, M: Deserialize<'a>>(frame: &'a [u8; FRAME]) -> postcard::Result<M> {
    postcard::take_from_bytes(frame).map(|(message, _)| message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_messages_fit_their_frame() {
        let far = Position(i64::MIN);
        let sensors = crate::config::Sensors::Dual { time_constant_s: -1.0 };
        let axis = AxisSettings { velocity_integral_time_s: Some(1.0), sensors, ..AxisSettings::default() };
        let setup = Setup {
            format: Format::F64,
            rates: Rates { velocity_loop_hz: 1.0, position_loop_divider: u32::MAX },
            axes: [axis; AXES],
            start: [far; AXES],
        };
        let reading = Reading { motor: far, table: Some(far) };
        for order in [Order::Setup(setup), Order::Tick([reading; AXES])] {
            let mut frame = [0; FRAME];
            encode(&order, &mut frame).unwrap();
            assert_eq!(decode::<Order>(&frame).unwrap(), order);
        }
    }
}
