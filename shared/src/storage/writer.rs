//! Writing the messages of a record.

use crc::{Digest, Table};
use embedded_storage::nor_flash::NorFlash;
use serde::Serialize;

use super::error::StorageError;
use super::header::{CRC, HEADER, Header};
use super::store::{Store, newest_of};

/// A record that is being written. It becomes valid by [`Writer::commit`]; dropped before, it leaves the old record valid.
pub struct Writer {
    slot: usize,
    sequence: u32,
    length: u32,
    digest: Digest<'static, u32, Table<1>>,
    /// Bytes that do not fill a word of the flash yet.
    pending: heapless::Vec<u8, HEADER>,
}

impl core::fmt::Debug for Writer {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Writer")
            .field("slot", &self.slot)
            .field("length", &self.length)
            .finish_non_exhaustive()
    }
}

impl<F: NorFlash> Store<F> {
    /// Erases the slot that does not hold the newest record, and starts a new one in it. Writers that were started before are not
    /// to be used any more.
    ///
    /// # Errors
    /// [`StorageError::Flash`].
    pub fn writer(&mut self) -> Result<Writer, StorageError> {
        let newest = newest_of(self.records());
        let (slot, sequence) =
            newest.map_or((0, 1), |(slot, header)| (1 - slot, header.sequence.wrapping_add(1)));
        let start = self.start(slot);
        self.flash.erase(start, start + self.slots.length).map_err(|_| StorageError::Flash)?;
        Ok(Writer::new(slot, sequence))
    }
}

impl Writer {
    fn new(slot: usize, sequence: u32) -> Self {
        static TABLE: crc::Crc<u32, Table<1>> = CRC;
        Self { slot, sequence, length: 0, digest: TABLE.digest(), pending: heapless::Vec::new() }
    }

    /// Appends the bytes of a message.
    ///
    /// # Errors
    /// [`StorageError::MessageTooLong`], [`StorageError::TooLong`], [`StorageError::Flash`]. The record is not to be committed
    /// then.
    pub fn bytes<F: NorFlash>(&mut self, store: &mut Store<F>, message: &[u8]) -> Result<(), StorageError> {
        self.begin_message(store, message.len())?;
        message.iter().try_for_each(|byte| self.push(store, *byte))
    }

    /// Appends a message.
    ///
    /// # Errors
    /// As for [`Writer::bytes`].
    pub fn message<F: NorFlash>(
        &mut self,
        store: &mut Store<F>,
        message: &impl Serialize,
    ) -> Result<(), StorageError> {
        let length = postcard::serialize_with_flavor(message, postcard::ser_flavors::Size::default());
        self.begin_message(store, length.map_err(|_| StorageError::Message)?)?;
        let mut result = Ok(());
        let flavor = ToFlash { writer: self, store, result: &mut result };
        let serialised = postcard::serialize_with_flavor(message, flavor);
        result.and_then(|()| serialised.map_err(|_| StorageError::Message))
    }

    fn begin_message<F: NorFlash>(
        &mut self,
        store: &mut Store<F>,
        length: usize,
    ) -> Result<(), StorageError> {
        let prefix = u16::try_from(length).map_err(|_| StorageError::MessageTooLong)?;
        if self.length as usize + 2 + length > store.capacity() {
            return Err(StorageError::TooLong);
        }
        prefix.to_le_bytes().iter().try_for_each(|byte| self.push(store, *byte))
    }

    fn push<F: NorFlash>(&mut self, store: &mut Store<F>, byte: u8) -> Result<(), StorageError> {
        self.digest.update(&[byte]);
        self.length += 1;
        self.pending.push(byte).map_err(|_| StorageError::TooLong)?;
        if self.pending.is_full() { self.flush(store) } else { Ok(()) }
    }

    /// Writes the pending bytes, filled up to a whole word with the erased value.
    fn flush<F: NorFlash>(&mut self, store: &mut Store<F>) -> Result<(), StorageError> {
        #[expect(clippy::cast_possible_truncation, reason = "at most 32")]
        let at = store.content_start(self.slot) + self.length - self.pending.len() as u32;
        while !self.pending.len().is_multiple_of(F::WRITE_SIZE) {
            self.pending.push(0xff).map_err(|_| StorageError::TooLong)?;
        }
        store.flash.write(at, &self.pending).map_err(|_| StorageError::Flash)?;
        self.pending.clear();
        Ok(())
    }

    /// Writes the header, which makes the record valid and the newest one, and checks it. Returns its sequence number.
    ///
    /// # Errors
    /// [`StorageError::Flash`], [`StorageError::Verification`].
    pub fn commit<F: NorFlash>(mut self, store: &mut Store<F>) -> Result<u32, StorageError> {
        self.flush(store)?;
        let Self { slot, sequence, length, digest, .. } = self;
        let header = Header { board: store.board(), sequence, length, content_crc: digest.finalize() };
        let start = store.start(slot);
        store.flash.write(start, &header.to_bytes()).map_err(|_| StorageError::Flash)?;
        match store.record(slot) {
            Ok(read) if read == header => Ok(sequence),
            Ok(_) => Err(StorageError::Verification(super::SlotError::Checksum)),
            Err(error) => Err(StorageError::Verification(error)),
        }
    }
}

/// Serialises to a writer. Its error is kept beside it, because postcard's has no place for it.
struct ToFlash<'w, F> {
    writer: &'w mut Writer,
    store: &'w mut Store<F>,
    result: &'w mut Result<(), StorageError>,
}

impl<F: NorFlash> postcard::ser_flavors::Flavor for ToFlash<'_, F> {
    type Output = ();

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        *self.result = self.writer.push(self.store, byte);
        self.result.map_err(|_| postcard::Error::SerializeBufferFull)
    }

    fn finalize(self) -> postcard::Result<()> {
        Ok(())
    }
}
