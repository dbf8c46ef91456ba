//! What was uploaded, in flash: the record of a save is the sequence of the uploads, as they were applied.
//!
//! A board has no memory for the settings of every axis in SI units beside those that it computes with. Therefore each upload is
//! written to the slot of the older record when it is applied, and a save makes that record valid. A start applies the uploads of
//! the newest record in their order, by the same code, and so with the same result to the bit.
//!
//! | message of a record | |
//! |---|---|
//! | 1, 3, 5 … | [`UploadKind`] |
//! | 2, 4, 6 … | the bytes of the upload, as the host has sent them |

use embedded_storage::nor_flash::NorFlash;

use super::message::UploadKind;
use super::refusal::Refusal;
use crate::storage::{Reader, StorageError, Store, Writer};

/// Greatest length of an [`UploadKind`] in postcard.
const KIND_BYTES: usize = 2;

/// A record that is being written.
#[derive(Debug)]
struct Draft {
    writer: Writer,
    /// Settings are among the uploads. They discard every compensation, so that the record has all that is applied.
    has_settings: bool,
}

/// The uploads that a board keeps in flash.
#[derive(Debug)]
pub struct SettingsMemory<F> {
    store: Store<F>,
    draft: Option<Draft>,
}

impl<F: NorFlash> SettingsMemory<F> {
    /// The memory in two slots of a flash.
    #[must_use]
    pub const fn new(store: Store<F>) -> Self {
        Self { store, draft: None }
    }

    /// The store.
    pub const fn store(&mut self) -> &mut Store<F> {
        &mut self.store
    }

    /// Erases the older record and starts a new one. The flash may stop the program meanwhile.
    pub(super) fn begin(&mut self) -> Result<(), Refusal> {
        self.draft = None;
        let writer = self.store.writer().map_err(|_| Refusal::Storage)?;
        self.draft = Some(Draft { writer, has_settings: false });
        Ok(())
    }

    /// Whether a record is being written.
    pub(super) const fn is_open(&self) -> bool {
        self.draft.is_some()
    }

    /// Appends an upload to the record that is being written. If that fails, the record is discarded.
    pub(super) fn append(&mut self, kind: UploadKind, contents: &[u8]) -> Result<(), Refusal> {
        let Some(mut draft) = self.draft.take() else { return Ok(()) };
        let writer = &mut draft.writer;
        let written =
            writer.message(&mut self.store, &kind).and_then(|()| writer.bytes(&mut self.store, contents));
        written.map_err(|_| Refusal::Storage)?;
        draft.has_settings |= kind == UploadKind::Settings;
        self.draft = Some(draft);
        Ok(())
    }

    /// Discards the record that is being written. The newest record stays.
    pub(super) fn discard(&mut self) {
        self.draft = None;
    }

    /// Whether there is a record with settings that could be committed.
    ///
    /// # Errors
    /// [`Refusal::NothingToSave`]; nothing has changed.
    pub(super) fn check_draft(&self) -> Result<(), Refusal> {
        let is_complete = self.draft.as_ref().is_some_and(|draft| draft.has_settings);
        if is_complete { Ok(()) } else { Err(Refusal::NothingToSave) }
    }

    /// Makes the record that is being written the newest one. Returns its number.
    pub(super) fn commit(&mut self) -> Result<u32, Refusal> {
        let draft = self.draft.take().filter(|draft| draft.has_settings).ok_or(Refusal::NothingToSave)?;
        draft.writer.commit(&mut self.store).map_err(|_| Refusal::Storage)
    }

    /// The newest record.
    pub(super) fn newest(&mut self) -> Result<Reader, StorageError> {
        self.store.newest()
    }

    /// Reads the next upload of a record to `contents`.
    pub(super) fn next<const N: usize>(
        &mut self,
        reader: &mut Reader,
        contents: &mut heapless::Vec<u8, N>,
    ) -> Result<UploadKind, StorageError> {
        let mut kind = [0; KIND_BYTES];
        let kind = reader.message(&mut self.store, &mut kind)?;
        let _ = contents.resize(N, 0);
        let read = reader.bytes(&mut self.store, contents).map(<[u8]>::len);
        contents.truncate(*read.as_ref().unwrap_or(&0));
        read.map(|_| kind)
    }
}
