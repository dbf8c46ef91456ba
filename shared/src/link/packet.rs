//! A message in bytes.
//!
//! | bytes | contents |
//! |---|---|
//! | 1 | [`VERSION`] |
//! | 4 | session, little-endian |
//! | 4 | sequence number, little-endian |
//! | up to [`MAX_MESSAGE`] | the message in postcard |
//! | 4 | CRC-32 (ISO-HDLC) of everything before, little-endian |
//!
//! The bytes are COBS-encoded and end with a zero, which occurs nowhere else: a receiver that has lost its place finds it at
//! the next zero.

use crc::{CRC_32_ISO_HDLC, Crc};
use serde::{Deserialize, Serialize};

/// Version of the packets and messages.
pub const VERSION: u8 = 17;

/// Greatest number of axes of a board. How many a board has is a constant of its program; its messages carry the number.
pub const MAX_AXES: usize = 4;

/// A value of each axis of a board, in a message: its number of axes is the length.
pub type PerAxis<T> = heapless::Vec<T, MAX_AXES>;

/// Greatest length of a message in postcard, bytes.
pub const MAX_MESSAGE: usize = 480;

/// Bytes before the message.
const HEADER: usize = 9;

/// Bytes of the checksum.
const CHECKSUM: usize = 4;

/// Greatest length of a packet before COBS.
pub const MAX_PACKET: usize = HEADER + MAX_MESSAGE + CHECKSUM;

/// Greatest length of a frame with its zero.
pub const MAX_FRAME: usize = cobs::max_encoding_length(MAX_PACKET) + 1;

/// The bytes of a packet on the line, with the zero at their end.
pub type Frame = heapless::Vec<u8, MAX_FRAME>;

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// What identifies a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Number of the session, given by the board; 0: none.
    pub session: u32,
    /// Number of the request in the session, from 1; a reply has the number of its request.
    pub sequence: u32,
}

impl Header {
    /// The header of a request without a session, with any number: its reply has both.
    #[must_use]
    pub const fn without_session(sequence: u32) -> Self {
        Self { session: 0, sequence }
    }
}

/// A packet whose checksum is right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packet<'a> {
    /// Session and sequence number.
    pub header: Header,
    /// The message in postcard.
    pub message: &'a [u8],
    /// The checksum, which identifies the contents.
    pub checksum: u32,
}

/// Why bytes are not a packet of this version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketError {
    /// More bytes than a frame has, without a zero.
    TooLong,
    /// Too few bytes for a packet.
    TooShort,
    /// Not COBS.
    Encoding,
    /// The checksum is wrong.
    Checksum,
    /// The checksum is right, but the version is another one.
    Version {
        /// The version of the packet.
        found: u8,
    },
}

/// The message does not fit a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageTooLong;

/// The frame of a message.
///
/// # Errors
/// [`MessageTooLong`] beyond [`MAX_MESSAGE`].
// Not inlined: one copy of it for all replies in the flash of a board.
#[inline(never)]
pub fn encode(header: Header, message: &impl Serialize, frame: &mut Frame) -> Result<(), MessageTooLong> {
    encode_version(VERSION, header, message, frame)
}

/// The frame of a message with any version, for tests of other versions.
///
/// # Errors
/// [`MessageTooLong`] beyond [`MAX_MESSAGE`].
pub fn encode_version(
    version: u8,
    header: Header,
    message: &impl Serialize,
    frame: &mut Frame,
) -> Result<(), MessageTooLong> {
    let mut packet = [0; MAX_PACKET];
    packet[0] = version;
    packet[1..5].copy_from_slice(&header.session.to_le_bytes());
    packet[5..HEADER].copy_from_slice(&header.sequence.to_le_bytes());
    let message = postcard::to_slice(message, &mut packet[HEADER..HEADER + MAX_MESSAGE]);
    let end = HEADER + message.map_err(|_| MessageTooLong)?.len();
    let checksum = CRC.checksum(&packet[..end]);
    packet[end..end + CHECKSUM].copy_from_slice(&checksum.to_le_bytes());
    // Large enough by its definition; one byte is for the zero.
    let _ = frame.resize(MAX_FRAME, 0);
    let encoded = cobs::try_encode(&packet[..end + CHECKSUM], &mut frame[..MAX_FRAME - 1]);
    frame.truncate(encoded.map_err(|_| MessageTooLong)? + 1);
    if let Some(last) = frame.last_mut() {
        *last = 0;
    }
    Ok(())
}

/// The packet in the bytes of a frame, without its zero. They are decoded in place.
///
/// # Errors
/// [`PacketError`].
pub fn decode(frame: &mut [u8]) -> Result<Packet<'_>, PacketError> {
    let length = cobs::decode_in_place(frame).map_err(|_| PacketError::Encoding)?;
    let (contents, checksum) =
        frame.get(..length).and_then(|packet| packet.split_last_chunk()).ok_or(PacketError::TooShort)?;
    let checksum = u32::from_le_bytes(*checksum);
    if CRC.checksum(contents) != checksum {
        return Err(PacketError::Checksum);
    }
    let (&[version, s0, s1, s2, s3, n0, n1, n2, n3], message) =
        contents.split_first_chunk::<HEADER>().ok_or(PacketError::TooShort)?;
    if version != VERSION {
        return Err(PacketError::Version { found: version });
    }
    let header = Header {
        session: u32::from_le_bytes([s0, s1, s2, s3]),
        sequence: u32::from_le_bytes([n0, n1, n2, n3]),
    };
    Ok(Packet { header, message, checksum })
}

/// CRC-32 (ISO-HDLC) of bytes: the checksum of an upload.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// The message of a packet.
///
/// # Errors
/// If the bytes are not such a message, or others follow it.
pub fn message<'a, M: Deserialize<'a>>(bytes: &'a [u8]) -> postcard::Result<M> {
    let (message, rest) = postcard::take_from_bytes(bytes)?;
    if rest.is_empty() { Ok(message) } else { Err(postcard::Error::DeserializeBadEncoding) }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;

    use super::*;

    const HEAD: Header = Header { session: 7, sequence: 0xdead_beef };

    /// Message and frame of a number of bytes.
    fn frame_of(bytes: &[u8]) -> Frame {
        let message = heapless::Vec::<u8, MAX_MESSAGE>::from_slice(bytes).unwrap();
        let mut frame = Frame::new();
        encode(HEAD, &message, &mut frame).unwrap();
        frame
    }

    proptest! {
        #[test]
        fn a_packet_is_read_as_written_and_has_one_zero(bytes in proptest::collection::vec(any::<u8>(), 0..470)) {
            let mut frame = frame_of(&bytes);
            prop_assert_eq!(frame.iter().position(|byte| *byte == 0), Some(frame.len() - 1));
            let end = frame.len() - 1;
            let packet = decode(&mut frame[..end]).unwrap();
            prop_assert_eq!(packet.header, HEAD);
            let message: heapless::Vec<u8, MAX_MESSAGE> = message(packet.message).unwrap();
            prop_assert_eq!(&message[..], &bytes[..]);
        }

        /// CRC-32 detects every burst of up to 32 bits; COBS may turn a wrong byte into another length, so that single wrong
        /// bytes are tried at every place.
        #[test]
        fn a_wrong_byte_is_detected(bytes in proptest::collection::vec(any::<u8>(), 0..200), flip in 1u8..=255) {
            let frame = frame_of(&bytes);
            for at in 0..frame.len() - 1 {
                let mut damaged = frame.clone();
                damaged[at] ^= flip;
                let end = damaged.iter().position(|byte| *byte == 0).unwrap();
                prop_assert!(decode(&mut damaged[..end]).is_err());
            }
        }
    }

    #[test]
    fn another_version_is_named() {
        let mut frame = Frame::new();
        encode_version(VERSION + 1, HEAD, &5u8, &mut frame).unwrap();
        let end = frame.len() - 1;
        assert_eq!(decode(&mut frame[..end]), Err(PacketError::Version { found: VERSION + 1 }));
    }

    #[test]
    fn a_message_that_is_too_long_is_refused() {
        let message = |bytes| core::iter::repeat_n(1, bytes).collect::<heapless::Vec<u8, 600>>();
        let mut frame = Frame::new();
        // Two bytes are the length in postcard.
        assert_eq!(encode(HEAD, &message(MAX_MESSAGE - 2), &mut frame), Ok(()));
        assert_eq!(encode(HEAD, &message(MAX_MESSAGE - 1), &mut frame), Err(MessageTooLong));
    }

    /// The check value of CRC-32/ISO-HDLC.
    #[test]
    fn the_checksum_is_that_of_its_name() {
        assert_eq!(checksum(b"123456789"), 0xcbf4_3926);
    }
}
