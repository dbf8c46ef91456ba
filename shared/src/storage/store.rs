//! Two slots in a flash.

use embedded_storage::nor_flash::NorFlash;

use super::error::{SlotError, StorageError};
use super::header::{CRC, HEADER, Header};

/// Where the two slots are, bytes from the start of the flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slots {
    /// Start of each slot.
    pub starts: [u32; 2],
    /// Length of a slot: whole erase blocks.
    pub length: u32,
}

/// Two slots in a flash, for the settings of one board.
#[derive(Debug)]
pub struct Store<F> {
    pub(super) flash: F,
    pub(super) slots: Slots,
    board: u32,
}

impl<F: NorFlash> Store<F> {
    /// The slots of a board with an identity: content of other boards is not loaded.
    ///
    /// # Errors
    /// [`StorageError::Layout`]; also if the flash reads more than one byte or writes more than 32 bytes at a time.
    pub fn new(flash: F, slots: Slots, board: u32) -> Result<Self, StorageError> {
        let Slots { starts: [first, second], length } = slots;
        let aligned = [first, second, length].iter().all(|at| (*at as usize).is_multiple_of(F::ERASE_SIZE));
        let fits = [first, second]
            .iter()
            .all(|start| start.checked_add(length).is_some_and(|end| end as usize <= flash.capacity()));
        let apart = first.abs_diff(second) >= length;
        let sizes = F::READ_SIZE == 1 && F::WRITE_SIZE <= HEADER && HEADER.is_multiple_of(F::WRITE_SIZE);
        if aligned && fits && apart && sizes && length as usize > HEADER {
            Ok(Self { flash, slots, board })
        } else {
            Err(StorageError::Layout)
        }
    }

    /// The flash.
    pub const fn flash_mut(&mut self) -> &mut F {
        &mut self.flash
    }

    /// Greatest length of the content, bytes, including two for each message.
    #[must_use]
    pub const fn capacity(&self) -> usize {
        self.slots.length as usize - HEADER
    }

    /// For each slot, why its record cannot be used; `None` if it is valid.
    pub fn refused(&mut self) -> [Option<SlotError>; 2] {
        self.records().map(Result::err)
    }

    pub(super) const fn start(&self, slot: usize) -> u32 {
        let [first, second] = self.slots.starts;
        if slot == 0 { first } else { second }
    }

    pub(super) const fn content_start(&self, slot: usize) -> u32 {
        #[expect(clippy::cast_possible_truncation, reason = "32")]
        let header = HEADER as u32;
        self.start(slot) + header
    }

    pub(super) const fn board(&self) -> u32 {
        self.board
    }

    pub(super) fn records(&mut self) -> [Result<Header, SlotError>; 2] {
        [self.record(0), self.record(1)]
    }

    /// Checks header and content of a slot.
    pub(super) fn record(&mut self, slot: usize) -> Result<Header, SlotError> {
        let mut bytes = [0; HEADER];
        self.read(self.start(slot), &mut bytes)?;
        let header = Header::from_bytes(&bytes, self.board)?;
        if header.length as usize > self.capacity() {
            return Err(SlotError::NoRecord);
        }
        let mut digest = CRC.digest();
        let mut at = self.content_start(slot);
        let mut remaining = header.length as usize;
        while remaining > 0 {
            let chunk = &mut bytes[..remaining.min(HEADER)];
            self.read(at, chunk)?;
            digest.update(chunk);
            remaining -= chunk.len();
            #[expect(clippy::cast_possible_truncation, reason = "at most 32")]
            let length = chunk.len() as u32;
            at += length;
        }
        if digest.finalize() == header.content_crc { Ok(header) } else { Err(SlotError::Checksum) }
    }

    fn read(&mut self, at: u32, bytes: &mut [u8]) -> Result<(), SlotError> {
        self.flash.read(at, bytes).map_err(|_| SlotError::Unreadable)
    }
}

/// The valid record with the greater sequence number, which wraps.
pub(super) fn newest_of(records: [Result<Header, SlotError>; 2]) -> Option<(usize, Header)> {
    match records.map(Result::ok) {
        [Some(first), Some(second)] => {
            let second_is_newer = second.sequence.wrapping_sub(first.sequence).cast_signed() > 0;
            Some(if second_is_newer { (1, second) } else { (0, first) })
        }
        [Some(first), None] => Some((0, first)),
        [None, Some(second)] => Some((1, second)),
        [None, None] => None,
    }
}
