//! The protocol between a host and a chip: postcard messages in frames of a fixed length.
//!
//! The host sends a [`Setup`] and [`Order::Block`]s, then one [`Order::Tick`] per tick with the sensor readings; the chip
//! answers each order with one [`Answer`]. A frame has [`FRAME`] bytes, padded with zeros, so that the receiver knows how many
//! to read. A longer order is sent in [`Part`]s.

use serde::{Deserialize, Serialize};

use crate::compensate::{CompensationKind, CompensationSettings};
use crate::config::{AxisSettings, Rates};
use crate::feedback::Reading;
use crate::interpolate::{Block, PathError};
use crate::safety::{Fault, Power};
use crate::scalar::Format;
use crate::units::Position;

/// Length of every frame in bytes.
pub const FRAME: usize = 256;

/// Greatest number of bytes of an order in a part.
pub const PART: usize = FRAME - 8;

/// Length of the longest order in bytes: a compensation with every table at its capacity has 7.6 kB.
pub const LONGEST_ORDER: usize = 7808;

/// Number of axes of the protocol.
pub const AXES: usize = 2;

/// The machine that the chip is to control.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// Number format.
    pub format: Format,
    /// Loop rates.
    pub rates: Rates,
    /// Axes.
    pub axes: [AxisSettings; AXES],
    /// Positions of the axes.
    pub start: [Position; AXES],
}

/// A part of an order that is longer than a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// The next bytes.
    pub bytes: heapless::Vec<u8, PART>,
    /// Whether this is the last part.
    pub last: bool,
}

/// A message from host to chip.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "one order at a time, and nothing to allocate it from")]
pub enum Order {
    /// A part of another order. Answered by [`Answer::Ready`]; the last one by the answer to that order.
    Part(Part),
    /// Configure the machine, drives off.
    Setup(Setup),
    /// Replace the compensation of an axis.
    Compensate(u8, CompensationSettings),
    /// Switch one compensation of an axis on or off.
    Switch(u8, CompensationKind, bool),
    /// Change the loops of an axis.
    Change(u8, AxisSettings),
    /// Append a block to the path.
    Block(Block<AXES>),
    /// Enable the drives.
    Enable,
    /// Disable the drives, or acknowledge a fault.
    Disable,
    /// Run one tick with these readings.
    Tick([Reading; AXES]),
    /// End the run.
    End,
    /// Raise a fault, for tests of the reactions.
    Fault(Fault),
    /// Tell the version of the chip's program. Answered by [`Answer::Sources`].
    Identify,
    /// Feed hold: decelerate along the path, drives on.
    Hold,
    /// Continue after a hold.
    Resume,
    /// Decelerate along the path and discard the rest of it, drives on.
    Stop,
    /// Set the feed override, %.
    Override(u8),
}

/// A message from chip to host, one per order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// Executed.
    Ready,
    /// Not executed; nothing has changed.
    Rejected(Rejection),
    /// Result of a tick.
    Tick(TickResult),
    /// [`SOURCES`](crate::SOURCES) of the chip's program.
    Sources(u64),
}

/// Why an order was rejected. The host runs the same code and can report details.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Rejection {
    /// The bytes are not an order.
    Unreadable,
    /// There was no [`Setup`] before.
    NotSetUp,
    /// A setting of this axis is out of range.
    Settings {
        /// Axis.
        axis: u8,
    },
    /// The machine has no such axis.
    NoSuchAxis,
    /// The block cannot be planned.
    Path(PathError),
}

/// The result of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TickResult {
    /// Bits of the force of each axis in the number format of the setup.
    pub force_bits: [u64; AXES],
    /// Command of each axis.
    pub commands: [Position; AXES],
    /// Power state of the drives.
    pub power: Power,
    /// The first warning since the drives were enabled.
    pub warning: Option<Fault>,
    /// Whether every block has ended.
    pub done: bool,
    /// Cost of the tick: instructions on the emulator, else cycles.
    pub cost: u32,
}

/// Writes a message into a frame.
///
/// # Errors
/// If the message is longer than [`FRAME`]: only orders that are sent in parts are.
pub fn encode(message: &impl Serialize, frame: &mut [u8; FRAME]) -> postcard::Result<()> {
    frame.fill(0);
    postcard::to_slice(message, frame).map(|_| ())
}

/// Reads a message from a frame, or from the bytes of all parts.
///
/// # Errors
/// If the bytes are not such a message, or other than zeros follow it.
pub fn decode<'a, M: Deserialize<'a>>(frame: &'a [u8]) -> postcard::Result<M> {
    let (message, padding) = postcard::take_from_bytes(frame)?;
    if padding.iter().all(|byte| *byte == 0) {
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

    /// Less than a frame remains free, so that the capacity is not larger than necessary.
    #[test]
    fn the_longest_order_fits_its_capacity() {
        let order = Order::Compensate(u8::MAX, CompensationSettings::longest());
        let mut bytes = [0; LONGEST_ORDER];
        let length = postcard::to_slice(&order, &mut bytes).unwrap().len();
        assert!(length > LONGEST_ORDER - FRAME, "{length} bytes");
        assert_eq!(decode::<Order>(&bytes).unwrap(), order);
    }

    /// Less than eight bytes remain free: a shorter part would be a longer transfer.
    #[test]
    fn the_longest_part_fits_a_frame() {
        let bytes = heapless::Vec::from_slice(&[0xff; PART]).unwrap();
        let order = Order::Part(Part { bytes, last: true });
        let mut frame = [0; FRAME];
        let length = postcard::to_slice(&order, &mut frame).unwrap().len();
        assert!(length > FRAME - 8, "{length} bytes");
        encode(&order, &mut frame).unwrap();
        assert_eq!(decode::<Order>(&frame).unwrap(), order);
    }
}
