//! The header of a record.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

use super::error::SlotError;

/// Version of the format and of the messages in it. To be raised with every change of a stored type.
pub const VERSION: u16 = 8;

/// Length of a header in bytes.
pub(super) const HEADER: usize = 32;

/// Bytes of the header before its checksum.
const CHECKED: usize = HEADER - 4;

const MAGIC: [u8; 4] = *b"LMst";

/// CRC-32 with a table of 1 KiB.
pub(super) const CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// The fields of a valid header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub board: u32,
    pub sequence: u32,
    pub length: u32,
    pub content_crc: u32,
}

impl Header {
    pub fn to_bytes(self) -> [u8; HEADER] {
        let mut bytes = [0; HEADER];
        let version = u32::from(VERSION);
        let words =
            [u32::from_le_bytes(MAGIC), version, self.board, self.sequence, self.length, self.content_crc, 0];
        for (bytes, word) in bytes.chunks_exact_mut(4).zip(words) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        let (checked, crc) = bytes.split_at_mut(CHECKED);
        crc.copy_from_slice(&CRC.checksum(checked).to_le_bytes());
        bytes
    }

    /// Reads a header for a board.
    pub fn from_bytes(bytes: &[u8; HEADER], board: u32) -> Result<Self, SlotError> {
        if bytes.iter().all(|byte| *byte == 0xff) {
            return Err(SlotError::Empty);
        }
        let mut words = [0; HEADER / 4];
        for (word, bytes) in words.iter_mut().zip(bytes.chunks_exact(4)) {
            *word = bytes.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte));
        }
        let [magic, version, written_for, sequence, length, content_crc, zero, header_crc] = words;
        if magic != u32::from_le_bytes(MAGIC) {
            return Err(SlotError::NoRecord);
        }
        if CRC.checksum(&bytes[..CHECKED]) != header_crc {
            return Err(SlotError::Checksum);
        }
        if version != u32::from(VERSION) || zero != 0 {
            #[expect(clippy::cast_possible_truncation, reason = "the upper half is for later versions")]
            return Err(SlotError::Version(version as u16));
        }
        if written_for != board {
            return Err(SlotError::OtherBoard(written_for));
        }
        Ok(Self { board, sequence, length, content_crc })
    }
}
