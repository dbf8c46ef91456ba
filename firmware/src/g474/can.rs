//! The registers of FDCAN1: frames of CAN FD of the link, 500 kbit/s and 2 Mbit/s in the data.
//!
//! Frames with the identifier of the board ([`setup::CAN_TO_BOARD`]) arrive in the first queue of the device, all others are refused by its
//! filter. A device that was switched off by errors (bus-off) joins the bus again by itself, after the pause of the standard.

use shared::link::can_frames::{CanFrame, DATA, LengthCode};

use super::address::fdcan;
use super::bus::Bus;
use super::clock::{CORE_HZ, Device};
use crate::setup;

/// Bits a second before and in the data, Hz.
const NOMINAL_HZ: u32 = 500_000;
const DATA_HZ: u32 = 2_000_000;

/// Divider of the clock for both, and quanta of a bit: one of synchronisation, and those before and after the sample point, at 76.5 % of both.
const DIVIDER: u32 = 5;
const NOMINAL: [u32; 2] = [51, 16];
const FAST: [u32; 2] = [12, 4];
const _: () = assert!(NOMINAL_HZ * DIVIDER * (1 + NOMINAL[0] + NOMINAL[1]) == CORE_HZ);
const _: () = assert!(DATA_HZ * DIVIDER * (1 + FAST[0] + FAST[1]) == CORE_HZ);

/// `FDCAN_NBTP` and `FDCAN_DBTP` (chapter 44): each value less one; jumps as long as the quanta behind the sample point; and the delay of the
/// transceiver is compensated.
const NOMINAL_TIMING: u32 =
    (NOMINAL[1] - 1) << 25 | (DIVIDER - 1) << 16 | (NOMINAL[0] - 1) << 8 | (NOMINAL[1] - 1);
const DATA_TIMING: u32 =
    1 << 23 | (DIVIDER - 1) << 16 | (FAST[0] - 1) << 8 | (FAST[1] - 1) << 4 | (FAST[1] - 1);

/// `FDCAN_TDCR` (chapter 44): the second sample point is where the first is, in cycles of the clock.
const COMPENSATION: u32 = (DIVIDER * (1 + FAST[0])) << 8;

/// `RCC_CCIPR` (chapter 7): the clock is that of the bus.
const CLOCK: u32 = 0b11 << 24;
const CLOCK_OF_BUS: u32 = 0b10 << 24;

/// Bits of `FDCAN_CCCR` (chapter 44): initialisation, change of the configuration, frames of CAN FD with the faster rate.
const INITIALISE: u32 = 1;
const CHANGE: u32 = 1 << 1;
const FD: u32 = 1 << 8 | 1 << 9;

/// `FDCAN_RXGFC` (chapter 44): one filter of identifiers of 11 bits; remote frames and all others are refused.
const FILTERS: u32 = 1 << 16 | 0b10 << 4 | 0b10 << 2 | 1 << 1 | 1;

/// The filter (chapter 44): identifier and mask (10), to the first queue (001).
const FILTER: u32 = 0b10 << 30 | 0b001 << 27 | (setup::CAN_TO_BOARD as u32) << 16 | 0x7ff;

/// Flags of `FDCAN_IR` (chapter 44): a frame was received, was sent, the device is off the bus.
const RECEIVED: u32 = 1;
const SENT: u32 = 1 << 7;
const BUS_OFF: u32 = 1 << 19;

/// `FDCAN_RXF0S` (chapter 44): number of frames, and the place of the oldest.
const FILL: u32 = 0b1111;
const OLDEST_AT: u32 = 8;

/// `FDCAN_TXFQS` (chapter 44): no place, and the place of the next frame.
const IS_FULL: u32 = 1 << 21;
const NEXT_AT: u32 = 16;
const PLACE: u32 = 0b11;

/// Words of an element (chapter 44): identifier of 11 bits; length code; CAN FD with the faster rate.
const IDENTIFIER_AT: u32 = 18;
const LENGTH_AT: u32 = 16;
const FD_FRAME: u32 = 1 << 21 | 1 << 20;
const HEADER_BYTES: u32 = 8;

/// The device.
#[derive(Clone, Copy, Debug)]
pub struct Fdcan<B>(B);

impl<B: Bus> Fdcan<B> {
    /// Joins the bus, with the interrupts of the flags above.
    pub fn start(bus: B) -> Self {
        bus.set_field(super::address::rcc::CCIPR, CLOCK, CLOCK_OF_BUS);
        Device::FDCAN.restart(bus);
        bus.write(fdcan::CCCR, INITIALISE);
        bus.wait_for(fdcan::CCCR, INITIALISE, INITIALISE);
        bus.write(fdcan::CCCR, INITIALISE | CHANGE);
        // It is not reset with the device.
        (fdcan::MEMORY..fdcan::MEMORY + fdcan::MEMORY_BYTES).step_by(4).for_each(|at| bus.write(at, 0));
        bus.write(fdcan::MEMORY, FILTER);
        bus.write(fdcan::RXGFC, FILTERS);
        bus.write(fdcan::NBTP, NOMINAL_TIMING);
        bus.write(fdcan::DBTP, DATA_TIMING);
        bus.write(fdcan::TDCR, COMPENSATION);
        bus.write(fdcan::CCCR, INITIALISE | CHANGE | FD);
        bus.write(fdcan::TXBTIE, 0b111);
        bus.write(fdcan::IE, RECEIVED | SENT | BUS_OFF);
        bus.write(fdcan::ILE, 1);
        let device = Self(bus);
        device.join();
        device
    }

    /// Ends the initialisation, which also ends the change of the configuration.
    fn join(self) {
        self.0.write(fdcan::CCCR, FD);
    }

    /// Clears the flags of the interrupt, and joins the bus again after it was left.
    pub fn acknowledge(self) {
        let flags = self.0.read(fdcan::IR);
        self.0.write(fdcan::IR, flags);
        if flags & BUS_OFF != 0 {
            self.join();
        }
    }

    /// The oldest frame that was received.
    pub fn receive(self) -> Option<CanFrame> {
        let state = self.0.read(fdcan::RXF0S);
        if state & FILL == 0 {
            return None;
        }
        let place = state >> OLDEST_AT & PLACE;
        let element = fdcan::RECEIVED + place * fdcan::ELEMENT;
        let length = self.0.read(element + 4) >> LENGTH_AT;
        let mut data = [0; DATA];
        let (words, _) = data.as_chunks_mut::<4>();
        for (word, at) in words.iter_mut().zip((element + HEADER_BYTES..).step_by(4)) {
            *word = self.0.read(at).to_le_bytes();
        }
        self.0.write(fdcan::RXF0A, place);
        Some(CanFrame::received(LengthCode::from_low_bits((length & 15) as u8), data))
    }

    /// Whether a frame can be sent.
    pub fn can_send(self) -> bool {
        self.0.read(fdcan::TXFQS) & IS_FULL == 0
    }

    /// Sends a frame, after [`Fdcan::can_send`].
    pub fn send(self, frame: &CanFrame) {
        let place = self.0.read(fdcan::TXFQS) >> NEXT_AT & PLACE;
        let element = fdcan::SENT + place * fdcan::ELEMENT;
        self.0.write(element, u32::from(setup::CAN_FROM_BOARD) << IDENTIFIER_AT);
        self.0.write(element + 4, u32::from(frame.length().code()) << LENGTH_AT | FD_FRAME);
        let (words, _) = frame.data().as_chunks::<4>();
        let used = frame.length().bytes().div_ceil(4);
        for (word, at) in words.iter().take(used).zip((element + HEADER_BYTES..).step_by(4)) {
            self.0.write(at, u32::from_le_bytes(*word));
        }
        self.0.write(fdcan::TXBAR, 1 << place);
    }
}
