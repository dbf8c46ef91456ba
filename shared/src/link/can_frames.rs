//! The byte stream of the link in frames of CAN FD.
//!
//! A frame of CAN FD has 0 to 8, 12, 16, 20, 24, 32, 48 or 64 data bytes (ISO 11898-1, table 5). The first data byte is the number of bytes of
//! the stream that follow, 1 to 63; the rest up to the length of the frame is zero, and the frame is the shortest that holds them. A frame of any
//! other content is not of the link, and is refused: padding cannot be taken for data.
//!
//! The stream itself is that of a serial port: packets in COBS with a zero after each ([`super::packet`]). A frame that is lost, repeated or exchanged
//! with another changes the bytes of a packet, which its checksum detects, or repeats a whole packet, which its sequence number detects
//! ([`super::session`]).

use super::port::BytePort;

/// Greatest number of data bytes of a frame.
pub const DATA: usize = 64;

/// Greatest number of bytes of the stream in a frame.
pub const CONTENT: usize = DATA - 1;

/// Data bytes of a frame by its length code.
const LENGTHS: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];

/// The length code of a frame, 0 to 15.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LengthCode(u8);

impl LengthCode {
    /// The lowest four bits of a number.
    #[must_use]
    pub const fn from_low_bits(code: u8) -> Self {
        Self(code & 15)
    }

    /// That of the shortest frame that holds a number of bytes, for up to [`DATA`] bytes.
    fn for_bytes(bytes: usize) -> Self {
        let shorter = LENGTHS.iter().filter(|length| **length < bytes).count();
        Self(u8::try_from(shorter).unwrap_or(15).min(15))
    }

    /// The number.
    #[must_use]
    pub const fn code(self) -> u8 {
        self.0
    }

    /// Data bytes of the frame.
    #[must_use]
    pub fn bytes(self) -> usize {
        LENGTHS.get(usize::from(self.0)).copied().unwrap_or(DATA)
    }
}

/// The data of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CanFrame {
    length: LengthCode,
    data: [u8; DATA],
}

impl CanFrame {
    /// A frame as it was received: what is behind its length is ignored.
    #[must_use]
    pub fn received(length: LengthCode, mut data: [u8; DATA]) -> Self {
        data.iter_mut().skip(length.bytes()).for_each(|byte| *byte = 0);
        Self { length, data }
    }

    /// A frame with the first bytes of a part of the stream, and their number. `None` for no bytes.
    #[must_use]
    pub fn of_stream(bytes: &[u8]) -> Option<(Self, usize)> {
        let taken = bytes.len().min(CONTENT);
        let count = u8::try_from(taken).ok().filter(|count| *count > 0)?;
        let mut data = [0; DATA];
        let content = core::iter::once(&count).chain(bytes.iter().take(taken));
        data.iter_mut().zip(content).for_each(|(to, from)| *to = *from);
        Some((Self { length: LengthCode::for_bytes(taken + 1), data }, taken))
    }

    /// The length code.
    #[must_use]
    pub const fn length(&self) -> LengthCode {
        self.length
    }

    /// The data bytes, zero behind the length.
    #[must_use]
    pub const fn data(&self) -> &[u8; DATA] {
        &self.data
    }

    /// The bytes of the stream. `None` for a frame that is not of the link.
    #[must_use]
    pub fn stream(&self) -> Option<&[u8]> {
        let (count, rest) = self.data.split_first()?;
        let count = usize::from(*count);
        let (content, padding) = rest.split_at_checked(count)?;
        let is_shortest = count > 0 && self.length == LengthCode::for_bytes(count + 1);
        (is_shortest && padding.iter().all(|byte| *byte == 0)).then_some(content)
    }
}

/// Frames to and from a bus, none of which is waited for.
pub trait FramePort {
    /// The next frame that has been received.
    fn receive(&mut self) -> Option<CanFrame>;

    /// Sends a frame. False if it cannot be taken now.
    fn send(&mut self, frame: &CanFrame) -> bool;
}

/// A bus with frames as a port of bytes.
#[derive(Debug)]
pub struct CanPort<F> {
    frames: F,
    /// The last frame of the link, and how many of its bytes have been read.
    frame: Option<CanFrame>,
    read: usize,
    refused: u32,
}

impl<F: FramePort> CanPort<F> {
    /// The port behind frames.
    pub const fn new(frames: F) -> Self {
        Self { frames, frame: None, read: 0, refused: 0 }
    }

    /// The frames.
    pub const fn frames(&mut self) -> &mut F {
        &mut self.frames
    }

    /// Frames that were not of the link.
    #[must_use]
    pub const fn refused(&self) -> u32 {
        self.refused
    }
}

impl<F: FramePort> BytePort for CanPort<F> {
    fn read(&mut self) -> Option<u8> {
        loop {
            let next = self.frame.as_ref().and_then(CanFrame::stream).and_then(|bytes| bytes.get(self.read));
            if let Some(byte) = next {
                self.read += 1;
                return Some(*byte);
            }
            let frame = self.frames.receive()?;
            self.refused = self.refused.saturating_add(u32::from(frame.stream().is_none()));
            (self.frame, self.read) = (Some(frame), 0);
        }
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let mut taken = 0;
        while let Some((frame, count)) = CanFrame::of_stream(bytes.get(taken..).unwrap_or_default()) {
            if !self.frames.send(&frame) {
                break;
            }
            taken += count;
        }
        taken
    }
}
