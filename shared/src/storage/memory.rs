//! A flash in RAM with the rules of a NOR flash, for tests and for a board without flash.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

/// A flash of `SIZE` bytes with erase blocks of `BLOCK` and words of `WORD` bytes.
#[derive(Clone, Debug)]
pub struct MemoryFlash<const SIZE: usize, const BLOCK: usize, const WORD: usize> {
    bytes: [u8; SIZE],
}

impl<const SIZE: usize, const BLOCK: usize, const WORD: usize> MemoryFlash<SIZE, BLOCK, WORD> {
    /// Erased.
    #[must_use]
    pub const fn erased() -> Self {
        Self { bytes: [0xff; SIZE] }
    }

    /// The content of all blocks.
    pub const fn bytes_mut(&mut self) -> &mut [u8; SIZE] {
        &mut self.bytes
    }
}

impl<const SIZE: usize, const BLOCK: usize, const WORD: usize> ErrorType for MemoryFlash<SIZE, BLOCK, WORD> {
    type Error = NorFlashErrorKind;
}

impl<const SIZE: usize, const BLOCK: usize, const WORD: usize> ReadNorFlash
    for MemoryFlash<SIZE, BLOCK, WORD>
{
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        let at = offset as usize;
        bytes.copy_from_slice(&self.bytes[at..at + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl<const SIZE: usize, const BLOCK: usize, const WORD: usize> NorFlash for MemoryFlash<SIZE, BLOCK, WORD> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = BLOCK;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        self.bytes[from as usize..to as usize].fill(0xff);
        Ok(())
    }

    /// Programs erased words. A word that is not erased is an error, as on flashes with error correction.
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        let at = offset as usize;
        let words = &mut self.bytes[at..at + bytes.len()];
        if words.iter().any(|byte| *byte != 0xff) {
            return Err(NorFlashErrorKind::Other);
        }
        words.copy_from_slice(bytes);
        Ok(())
    }
}
