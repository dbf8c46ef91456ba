//! The message memory of FDCAN1 with its queues of three elements (RM0440, chapter 44), on a bus that takes frames when the test says so.

use std::collections::{BTreeMap, VecDeque};

use shared::link::can_frames::{CanFrame, LengthCode};

const RECEIVED: u32 = 0xb0;
const SENT: u32 = 0x278;
const ELEMENT: u32 = 72;

#[derive(Default)]
pub struct CanModel {
    /// Words by their offset.
    pub memory: BTreeMap<u32, u32>,
    pub is_on_bus: bool,
    /// Other nodes keep the bus.
    pub is_held: bool,
    /// Place of the oldest frame, and their number.
    oldest: u32,
    filled: u32,
    /// Places of the frames that wait.
    waiting: VecDeque<u32>,
    next: u32,
}

/// What was sent: identifier, the second word of the header, the data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sent {
    pub identifier: u32,
    pub header: u32,
    pub data: Vec<u8>,
}

impl CanModel {
    pub fn received_state(&self) -> u32 {
        let next = (self.oldest + self.filled) % 3;
        self.filled | self.oldest << 8 | next << 16 | u32::from(self.filled == 3) << 24
    }

    pub fn sending_state(&self) -> u32 {
        let waiting = u32::try_from(self.waiting.len()).unwrap();
        (3 - waiting) | self.next << 16 | u32::from(waiting == 3) << 21
    }

    /// A frame arrives. False: there was no place, or the filter refuses it.
    pub fn receive(&mut self, identifier: u32, frame: &CanFrame) -> bool {
        let filter = self.memory[&0];
        // Identifier and mask; to the first queue.
        assert_eq!((filter >> 30, filter >> 27 & 0b111), (0b10, 0b001));
        let mask = filter & 0x7ff;
        if !self.is_on_bus || self.filled == 3 || (filter >> 16 ^ identifier) & mask != 0 {
            return false;
        }
        let element = RECEIVED + (self.oldest + self.filled) % 3 * ELEMENT;
        self.memory.insert(element, identifier << 18);
        self.memory.insert(element + 4, u32::from(frame.length().code()) << 16 | 1 << 21 | 1 << 20);
        // What is behind the length stays from an earlier frame.
        let words = frame.data()[..frame.length().bytes()].chunks(4).zip((element + 8..).step_by(4));
        for (word, at) in words {
            let mut bytes = [0xee; 4];
            bytes[..word.len()].copy_from_slice(word);
            self.memory.insert(at, u32::from_le_bytes(bytes));
        }
        self.filled += 1;
        true
    }

    pub fn release(&mut self, place: u32) {
        assert!(self.filled > 0 && place == self.oldest, "not the oldest frame: {place}");
        self.oldest = (self.oldest + 1) % 3;
        self.filled -= 1;
    }

    pub fn send(&mut self, places: u32) {
        assert!(self.is_on_bus && places == 1 << self.next && self.waiting.len() < 3, "{places:#b}");
        self.waiting.push_back(self.next);
        self.next = (self.next + 1) % 3;
    }

    /// The oldest frame that waits leaves.
    pub fn transmit(&mut self) -> Option<Sent> {
        if self.is_held {
            return None;
        }
        let element = SENT + self.waiting.pop_front()? * ELEMENT;
        let header = self.memory[&(element + 4)];
        let length = LengthCode::from_low_bits((header >> 16 & 15) as u8).bytes();
        let word = |at: u32| self.memory.get(&(element + 8 + 4 * at)).copied().unwrap_or(0).to_le_bytes();
        let data = (0..16).flat_map(word).take(length).collect();
        Some(Sent { identifier: self.memory[&element] >> 18, header, data })
    }
}
