//! Reading the messages of a record.

use embedded_storage::nor_flash::NorFlash;
use serde::Deserialize;

use super::error::{SlotError, StorageError};
use super::header::Header;
use super::store::{Store, newest_of};

/// The messages of a valid record, one after the other.
#[derive(Clone, Copy, Debug)]
pub struct Reader {
    at: u32,
    end: u32,
    sequence: u32,
}

impl<F: NorFlash> Store<F> {
    /// The newest valid record.
    ///
    /// # Errors
    /// [`StorageError::NoRecord`] with the reason for each slot.
    pub fn newest(&mut self) -> Result<Reader, StorageError> {
        let records = self.records();
        match newest_of(records) {
            Some((slot, header)) => Ok(Reader::new(self.content_start(slot), header)),
            None => {
                Err(StorageError::NoRecord(records.map(|record| record.err().unwrap_or(SlotError::NoRecord))))
            }
        }
    }
}

impl Reader {
    const fn new(start: u32, header: Header) -> Self {
        Self { at: start, end: start + header.length, sequence: header.sequence }
    }

    /// Sequence number of the record: it increases with every save.
    #[must_use]
    pub const fn sequence(&self) -> u32 {
        self.sequence
    }

    /// Whether every message has been read.
    #[must_use]
    pub const fn is_at_end(&self) -> bool {
        self.at >= self.end
    }

    /// Reads the bytes of the next message to a buffer.
    ///
    /// # Errors
    /// [`StorageError::NoMessage`] at the end, [`StorageError::MessageTooLong`] if the buffer is too small,
    /// [`StorageError::Flash`]. The reader stays at the message then.
    pub fn bytes<'b, F: NorFlash>(
        &mut self,
        store: &mut Store<F>,
        buffer: &'b mut [u8],
    ) -> Result<&'b [u8], StorageError> {
        let content = self.at.checked_add(2).filter(|at| *at <= self.end).ok_or(StorageError::NoMessage)?;
        let mut length = [0; 2];
        store.flash.read(self.at, &mut length).map_err(|_| StorageError::Flash)?;
        let length = u16::from_le_bytes(length);
        let end = content + u32::from(length);
        if end > self.end {
            return Err(StorageError::NoMessage);
        }
        let buffer = buffer.get_mut(..usize::from(length)).ok_or(StorageError::MessageTooLong)?;
        store.flash.read(content, buffer).map_err(|_| StorageError::Flash)?;
        self.at = end;
        Ok(buffer)
    }

    /// Reads the next message.
    ///
    /// # Errors
    /// As for [`Reader::bytes`], and [`StorageError::Message`] if the bytes are not exactly such a message.
    pub fn message<'b, M: Deserialize<'b>, F: NorFlash>(
        &mut self,
        store: &mut Store<F>,
        buffer: &'b mut [u8],
    ) -> Result<M, StorageError> {
        let bytes = self.bytes(store, buffer)?;
        match postcard::take_from_bytes(bytes) {
            Ok((message, [])) => Ok(message),
            _ => Err(StorageError::Message),
        }
    }
}
