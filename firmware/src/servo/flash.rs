//! The flash of the emulated board: a file beside the sockets of the emulator, which outlives it as a flash outlives the supply.
//!
//! Its layout is that of the STM32F405: two sectors of 128 KiB. Unlike there, the program does not stand still while it is erased.

use cortex_m_semihosting::{nr, syscall};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use shared::link::SettingsMemory;
use shared::storage::{Slots, Store};

/// The name of the file, in the working folder of the emulator.
const NAME: &[u8] = b"flash\0";

/// The slots, bytes from the start of the file.
const SLOTS: Slots = Slots { starts: [0, 0x2_0000], length: 0x2_0000 };

/// Identity of this board in a record.
const BOARD: u32 = 0x0a38_6001;

/// Erased bytes that are written at a time.
const ERASED: [u8; 1024] = [0xff; 1024];

/// Longest write of a record.
const LONGEST_WRITE: usize = 32;

/// The settings in the file, which is made if it does not exist. `None` if the emulator cannot write it.
#[must_use]
pub fn settings_memory() -> Option<SettingsMemory<FileFlash>> {
    Store::new(FileFlash::open()?, SLOTS, BOARD).ok().map(SettingsMemory::new)
}

/// A file with the rules of a NOR flash.
#[derive(Debug)]
pub struct FileFlash {
    handle: usize,
}

impl FileFlash {
    fn open() -> Option<Self> {
        let opened = |mode: usize| {
            // SAFETY: SYS_OPEN reads a name of the given length, which is static.
            let handle = unsafe { syscall!(OPEN, NAME.as_ptr(), mode, NAME.len() - 1) };
            (handle != usize::MAX).then_some(Self { handle })
        };
        if let Some(file) = opened(nr::open::RW_BINARY) {
            return Some(file);
        }
        let mut file = opened(nr::open::RW_TRUNC_BINARY)?;
        file.erase(0, SLOTS.length * 2).ok()?;
        Some(file)
    }

    fn seek(&self, offset: u32) -> Result<(), NorFlashErrorKind> {
        // SAFETY: SYS_SEEK with an open file.
        let failed = unsafe { syscall!(SEEK, self.handle, offset as usize) };
        if failed == 0 { Ok(()) } else { Err(NorFlashErrorKind::Other) }
    }

    fn put(&self, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        // SAFETY: SYS_WRITE reads at most the length of `bytes` from it.
        let missing = unsafe { syscall!(WRITE, self.handle, bytes.as_ptr(), bytes.len()) };
        if missing == 0 { Ok(()) } else { Err(NorFlashErrorKind::Other) }
    }
}

impl ErrorType for FileFlash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for FileFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        self.seek(offset)?;
        // SAFETY: SYS_READ writes at most the length of `bytes` into it.
        let missing = unsafe { syscall!(READ, self.handle, bytes.as_mut_ptr(), bytes.len()) };
        if missing == 0 { Ok(()) } else { Err(NorFlashErrorKind::Other) }
    }

    fn capacity(&self) -> usize {
        2 * SLOTS.length as usize
    }
}

impl NorFlash for FileFlash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SLOTS.length as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        self.seek(from)?;
        (from..to).step_by(ERASED.len()).try_for_each(|_| self.put(&ERASED))
    }

    /// Programs erased bytes. Others are an error, as on flashes with error correction.
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        let mut present = [0; LONGEST_WRITE];
        let present = present.get_mut(..bytes.len()).ok_or(NorFlashErrorKind::OutOfBounds)?;
        self.read(offset, present)?;
        if present.iter().any(|byte| *byte != 0xff) {
            return Err(NorFlashErrorKind::Other);
        }
        self.seek(offset)?;
        self.put(bytes)
    }
}
