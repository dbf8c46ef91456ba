//! Settings in flash: saved by a host, applied at the start.

use embedded_storage::nor_flash::NorFlash;

use super::super::hosted_drive::HostedDrive;
use super::super::port::SharedDrive;
use super::super::refusal::Refusal;
use super::super::report::{SettingsReport, SettingsSource, StoredRecord};
use super::state::{Access, ServerState};
use crate::safety::Fault;
use crate::scalar::Scalar;
use crate::storage::{Reader, SlotError, StorageError};

/// Erases the older record and starts a new one.
pub(super) fn begin_save<'m, S: Scalar, D: SharedDrive<'m, S, N>, F: NorFlash, const N: usize>(
    access: &mut Access<'_, D, F>,
) -> Result<(), Refusal> {
    let Access { drive, memory } = access;
    access_flash(*drive, || memory.begin())
}

/// Accesses the flash with the power stages off. Only the server switches them on, so that they stay off meanwhile, without a lock that would
/// hold off the ticks.
pub(super) fn access_flash<'m, S: Scalar, R, const N: usize>(
    drive: &mut impl SharedDrive<'m, S, N>,
    access: impl FnOnce() -> Result<R, Refusal>,
) -> Result<R, Refusal> {
    drive.with(HostedDrive::begin_flash_access)?;
    let result = access();
    drive.with(HostedDrive::end_flash_access);
    result
}

impl<const N: usize> ServerState<N> {
    /// Makes the record that is being written the newest one.
    pub(super) fn save<'m, S: Scalar, D: SharedDrive<'m, S, N>, F: NorFlash>(
        &mut self,
        access: &mut Access<'_, D, F>,
    ) -> Result<(), Refusal> {
        let Access { drive, memory } = access;
        // Before the access, with which every axis loses its reference. Drives that are on are the first reason.
        if !drive.with(|drive| drive.machine().power().is_on()) {
            memory.check_draft()?;
        }
        let number = access_flash(*drive, || memory.commit())?;
        self.report = SettingsReport { source: SettingsSource::Record, stored: StoredRecord::Valid(number) };
        Ok(())
    }

    /// Applies the newest record, all of it or, with a fault, nothing.
    // Not inlined: its copy of the settings is not to stay on the stack of the idle loop.
    #[inline(never)]
    pub(super) fn load<'m, S: Scalar, D: SharedDrive<'m, S, N>, F: NorFlash>(
        &mut self,
        access: &mut Access<'_, D, F>,
    ) {
        let program = self.settings.clone();
        let stored = match access.memory.newest() {
            Ok(reader) => match self.apply_record(reader, access) {
                Ok(()) => {
                    self.report.source = SettingsSource::Record;
                    StoredRecord::Valid(reader.sequence())
                }
                Err(_) => StoredRecord::Refused(reader.sequence()),
            },
            Err(StorageError::NoRecord([SlotError::Empty, SlotError::Empty])) => StoredRecord::None,
            Err(StorageError::NoRecord(reasons)) => StoredRecord::Invalid(reasons),
            Err(_) => StoredRecord::Invalid([SlotError::Unreadable; 2]),
        };
        self.report.stored = stored;
        if matches!(stored, StoredRecord::Refused(_)) {
            // Accepted at the start.
            let _ = self.configure(program, access.drive);
        }
        if matches!(stored, StoredRecord::Refused(_) | StoredRecord::Invalid(_)) {
            access.drive.with(|drive| drive.inhibit_enable(Fault::StoredSettings));
        }
    }

    /// Applies the uploads of a record in their order.
    fn apply_record<'m, S: Scalar, D: SharedDrive<'m, S, N>, F: NorFlash>(
        &mut self,
        mut reader: Reader,
        access: &mut Access<'_, D, F>,
    ) -> Result<(), Refusal> {
        let mut applied = Ok(());
        while !reader.is_at_end() && applied.is_ok() {
            applied = match access.memory.next(&mut reader, &mut self.upload.bytes) {
                Ok(kind) => self.apply_upload(kind, access.drive),
                Err(_) => Err(Refusal::Storage),
            };
        }
        self.upload.bytes.clear();
        applied
    }
}
