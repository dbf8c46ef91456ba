//! Uploads: collected in parts, checked as a whole, then applied or refused.

use super::super::envelope::AdmittedSettings;
use super::super::message::{BoardSettings, LONGEST_UPLOAD, UploadKind};
use super::super::packet;
use super::super::port::SharedDrive;
use super::super::refusal::{Refusal, UploadError};
use super::super::report::SettingsSource;
use super::compensation_reader;
use super::saving::access_flash;
use super::state::{Access, ServerState, Upload};
use crate::compensate::{AxisCompensation, AxisOf, CompensationSettings, Dependence};
use crate::config::Rates;
use crate::machine::{MachineConfig, MachineError};
use crate::scalar::Scalar;
use embedded_storage::nor_flash::NorFlash;

/// Greatest number of bytes of an upload, for messages.
#[expect(clippy::cast_possible_truncation, reason = "7680")]
const MAX_BYTES: u16 = LONGEST_UPLOAD as u16;

impl Upload {
    /// Appends a part.
    pub(super) fn append(&mut self, offset: u16, part: &[u8]) -> Result<(), Refusal> {
        if offset != 0 && usize::from(offset) != self.bytes.len() {
            return Err(Refusal::Upload(UploadError::OutOfOrder { expected: self.length() }));
        }
        if usize::from(offset) + part.len() > LONGEST_UPLOAD {
            return Err(Refusal::Upload(UploadError::TooLong { max: MAX_BYTES }));
        }
        if offset == 0 {
            self.bytes.clear();
        }
        // The length was checked.
        let _ = self.bytes.extend_from_slice(part);
        Ok(())
    }

    fn length(&self) -> u16 {
        u16::try_from(self.bytes.len()).unwrap_or(u16::MAX)
    }

    /// The bytes, if they are those that are meant.
    fn checked(&self, length: u16, checksum: u32) -> Result<&[u8], Refusal> {
        let found = self.length();
        if found != length {
            return Err(Refusal::Upload(UploadError::Length { found }));
        }
        if packet::checksum(&self.bytes) != checksum {
            return Err(Refusal::Upload(UploadError::Checksum));
        }
        Ok(&self.bytes)
    }
}

impl<const N: usize> ServerState<N> {
    /// Checks the upload and applies it. If a record is being written, the upload is written to it first, so that nothing has changed
    /// if the flash fails; an upload that is refused discards the record.
    pub(super) fn apply<'m, S: Scalar, D: SharedDrive<'m, S, N>, F: NorFlash>(
        &mut self,
        kind: UploadKind,
        length: u16,
        checksum: u32,
        access: &mut Access<'_, D, F>,
    ) -> Result<(), Refusal> {
        access.drive.with(|drive| drive.is_off())?;
        let bytes = self.upload.checked(length, checksum)?;
        let Access { drive, memory } = access;
        if memory.is_open() {
            access_flash(*drive, || memory.append(kind, bytes))?;
        }
        let applied = self.apply_upload(kind, *drive);
        match applied {
            Ok(()) => self.report.source = SettingsSource::Upload,
            Err(_) => memory.discard(),
        }
        applied
    }

    /// Applies the bytes of the upload.
    pub(super) fn apply_upload<'m, S: Scalar>(
        &mut self,
        kind: UploadKind,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Result<(), Refusal> {
        match kind {
            UploadKind::Settings => self.apply_settings(drive),
            UploadKind::Compensation { axis } => {
                compensate(&self.upload.bytes, usize::from(axis), self.settings.rates, drive)
            }
        }
    }

    // Not inlined, as the other functions with copies of settings: they are not on the stack while a compensation is converted.
    #[inline(never)]
    fn apply_settings<'m, S: Scalar>(
        &mut self,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Result<(), Refusal> {
        let settings = settings(&self.upload.bytes, self.identity.tick_hz)?;
        self.configure(self.identity.envelope.admit(settings)?, drive)
    }

    /// Replaces the settings; every compensation is discarded.
    #[inline(never)]
    pub(super) fn configure<'m, S: Scalar>(
        &mut self,
        settings: AdmittedSettings<N>,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Result<(), Refusal> {
        let config = MachineConfig::<S, N>::new(settings.rates, &settings.axes)?;
        drive.with(|drive| drive.configure(config))?;
        self.settings = settings;
        Ok(())
    }
}

fn settings<const N: usize>(bytes: &[u8], tick_hz: u32) -> Result<BoardSettings<N>, Refusal> {
    let settings = BoardSettings::read(bytes)?;
    let board_hz = f64::from(tick_hz);
    // Exact: the ticks of the board are what the gains are converted for.
    if settings.rates.velocity_loop_hz.to_bits() != board_hz.to_bits() {
        return Err(Refusal::TickRate { board_hz });
    }
    Ok(settings)
}

// Tables are large. Each of the following functions is not inlined: one
// copy of the settings and one of the converted tables are on the stack at a time.
#[inline(never)]
fn compensate<'m, S: Scalar, const N: usize>(
    bytes: &[u8],
    axis: usize,
    rates: Rates,
    drive: &mut impl SharedDrive<'m, S, N>,
) -> Result<(), Refusal> {
    if axis >= N {
        return Err(Refusal::NoSuchAxis);
    }
    let mut settings = CompensationSettings::default();
    compensation_reader::read(bytes, &mut settings).map_err(|_| Refusal::Upload(UploadError::Unreadable))?;
    convert_and_set(&settings, axis, rates, drive)
}

#[inline(never)]
fn convert_and_set<'m, S: Scalar, const N: usize>(
    settings: &CompensationSettings,
    axis: usize,
    rates: Rates,
    drive: &mut impl SharedDrive<'m, S, N>,
) -> Result<(), Refusal> {
    let dependence = Dependence::of(u8::try_from(axis).unwrap_or(u8::MAX), settings);
    let set = AxisCompensation::<S>::convert_for(settings, rates, AxisOf { axis, axes: N }, |compensation| {
        drive.with(|drive| {
            drive.is_off()?;
            drive.machine_mut().set_compensation(axis, compensation, dependence).map_err(Refusal::from)
        })
    });
    set.unwrap_or_else(|error| Err(MachineError::Config { axis, error }.into()))
}
