//! Uploads and recordings, which are longer than a packet.

use std::time::Duration;

use serde::Serialize;
use shared::link::message::{LONGEST_UPLOAD, PART, PerAxis, Reply, Request, UploadKind};
use shared::link::packet;
use shared::link::report::CaptureReport;

use crate::client::Client;
use crate::error::BoardError;
use crate::samples::{self, AxisSample};

/// Longest wait while the flash is erased: at most 4 s on an STM32F405.
const ERASE_TIMEOUT: Duration = Duration::from_secs(10);

impl Client {
    /// Sends settings or a compensation; the board checks and applies them as a whole.
    ///
    /// # Errors
    /// [`BoardError`], a setting that the board refuses included.
    pub fn upload(&mut self, kind: UploadKind, contents: &impl Serialize) -> Result<(), BoardError> {
        let mut buffer = vec![0; LONGEST_UPLOAD];
        let bytes = postcard::to_slice(contents, &mut buffer).map_err(|_| BoardError::TooLong)?;
        let length = u16::try_from(bytes.len()).map_err(|_| BoardError::TooLong)?;
        for (part, offset) in bytes.chunks(PART).zip((0u16..).step_by(PART)) {
            let bytes = heapless::Vec::from_slice(part).map_err(|_| BoardError::TooLong)?;
            self.command(&Request::Upload { offset, bytes })?;
        }
        self.command(&Request::Apply { kind, length, checksum: packet::checksum(bytes) })
    }

    /// Erases a record in the flash of the board: what is uploaded from here on is written to it. The drives have to be off.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn begin_save(&mut self) -> Result<(), BoardError> {
        self.command_within(&Request::BeginSave, ERASE_TIMEOUT)
    }

    /// The state of the recording.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn capture_report(&mut self) -> Result<CaptureReport, BoardError> {
        match self.request(&Request::Capture)? {
            Reply::Capture(report) => Ok(report),
            _ => Err(BoardError::Unexpected),
        }
    }

    /// Reads a complete recording.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn read_capture(&mut self) -> Result<Vec<PerAxis<AxisSample>>, BoardError> {
        let report = self.capture_report()?;
        let mut bytes: Vec<u8> = Vec::new();
        while bytes.len() < report.bytes as usize {
            let offset = u32::try_from(bytes.len()).map_err(|_| BoardError::TooLong)?;
            match self.request(&Request::ReadCapture { offset })? {
                Reply::Bytes(part) if !part.is_empty() => bytes.extend_from_slice(&part),
                _ => return Err(BoardError::Unexpected),
            }
        }
        let steps = self.welcome().steps.clone();
        samples::decode(&steps, report.period, report.samples, &bytes).map_err(|_| BoardError::Unexpected)
    }
}
