//! What a host and a board say to each other, as postcard in frames of a fixed length.
//!
//! The host sends [`Setup`] and [`Order::Block`]s, then one [`Order::Tick`] a tick with the sensors;
//! the board answers each with one [`Answer`]. A frame is [`FRAME`] bytes, padded with zeros, so that
//! a reader knows how much to wait for. An order that is longer comes in [`Part`]s.

use serde::{Deserialize, Serialize};

use crate::axis::Reading;
use crate::compensate::{CompensationKind, CompensationSettings};
use crate::config::{AxisSettings, Rates};
use crate::interpolate::Block;
use crate::safety::{Fault, Power};
use crate::units::Position;

/// Length of every frame in bytes.
pub const FRAME: usize = 256;

/// Bytes of an order that fit into a part.
pub const PART: usize = FRAME - 8;

/// Length of the longest order in bytes.
pub const LONGEST_ORDER: usize = 4096;

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

/// A piece of an order that is longer than a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// The next bytes.
    pub bytes: heapless::Vec<u8, PART>,
    /// Whether the order is complete with them.
    pub last: bool,
}

/// From host to board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "one order at a time, and nothing to allocate it from")]
pub enum Order {
    /// A piece of another order. Answered by ready, the last one as that order is.
    Part(Part),
    /// Be this machine, drives off.
    Setup(Setup),
    /// Compensate so on an axis.
    Compensate(u8, CompensationSettings),
    /// Switch one compensation of an axis.
    Switch(u8, CompensationKind, bool),
    /// Go over to other loops on an axis.
    Change(u8, AxisSettings),
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
    Tick(TickResult),
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
    /// The machine has no such axis.
    NoSuchAxis,
    /// The block cannot be planned.
    Path(crate::interpolate::PathError),
}

/// What a tick gave.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TickResult {
    /// Bits of the force of each axis in the format of the setup.
    pub force_bits: [u64; AXES],
    /// Command of each axis.
    pub commands: [Position; AXES],
    /// State of the drives.
    pub power: Power,
    /// The first fault that the machine has gone on with.
    pub warning: Option<Fault>,
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

/// Reads a message from a frame, or from what parts have brought.
///
/// # Errors
/// When the bytes are no such message, or something follows it.
pub fn decode<'a, M: Deserialize<'a>>(frame: &'a [u8]) -> postcard::Result<M> {
    let (message, rest) = postcard::take_from_bytes(frame)?;
    if rest.iter().all(|byte| *byte == 0) {
        Ok(message)
    } else {
        Err(postcard::Error::DeserializeBadEncoding)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_message_of_a_tick_fits_a_frame() {
        let far = Position(i64::MIN);
        let order = Order::Tick([Reading { motor: far, table: Some(far) }; AXES]);
        let mut frame = [0; FRAME];
        encode(&order, &mut frame).unwrap();
        assert_eq!(decode::<Order>(&frame).unwrap(), order);
        let answer = Answer::Tick(TickResult {
            force_bits: [u64::MAX; AXES],
            commands: [far; AXES],
            power: Power::Faulted(Fault::Overrun),
            warning: Some(Fault::Overrun),
            done: true,
            cost: u32::MAX,
        });
        encode(&answer, &mut frame).unwrap();
        assert_eq!(decode::<Answer>(&frame).unwrap(), answer);
    }

    #[test]
    fn the_longest_part_fits_a_frame() {
        let bytes = heapless::Vec::from_slice(&[0xff; PART]).unwrap();
        let order = Order::Part(Part { bytes, last: true });
        let mut frame = [0; FRAME];
        encode(&order, &mut frame).unwrap();
        assert_eq!(decode::<Order>(&frame).unwrap(), order);
    }
}
