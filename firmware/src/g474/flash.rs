//! The two slots for settings in the second bank of the flash: erasing, programming and reading them (RM0440, chapter 3).
//!
//! The program is executed from the first bank (`firmware/memory/board-g474.x`), which can be read while the second one is erased or
//! programmed (chapter 3): the ticks continue meanwhile. A page takes 22 ms to erase (DS12288), a slot 0.7 s.
//!
//! A double word has eight check bits. One whose programming was interrupted may have more errors than they can correct: reading it raises the
//! NMI, which [`take_interrupted_word`] tells from that of the crystal; the checksums of the record then refuse what was read.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use shared::storage::Slots;

use super::address::flash;
use super::bus::Bus;
use super::supply;

/// The slots, bytes from the start of the flash: the second half of its second bank.
pub const SLOTS: Slots = Slots { starts: [0x6_0000, 0x7_0000], length: 0x1_0000 };

/// Identity of the STM32G474 board in a record.
pub const BOARD: u32 = 0x4741_0002;

/// Bytes of the flash of an STM32G474RE, and of each of its banks.
pub const BYTES: usize = 0x8_0000;

/// Start of the second bank, bytes from the start of the flash.
pub const SECOND_BANK: u32 = 0x4_0000;

const _: () = assert!((SLOTS.starts[1] + SLOTS.length) as usize == BYTES);
const _: () = assert!(SLOTS.starts[0] >= SECOND_BANK && SLOTS.starts[0] + SLOTS.length == SLOTS.starts[1]);

/// Address of the flash.
pub const ADDRESS: u32 = 0x0800_0000;

/// Bytes of a page (chapter 3).
pub const PAGE: u32 = 0x800;

/// Bytes of a double word, which are programmed together (chapter 3).
pub const DOUBLE_WORD: u32 = 8;

/// The two keys of `FLASH_KEYR` (chapter 3).
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// Bits of `FLASH_SR` (chapter 3): the errors, each of which is cleared by a one, with the end of an operation; and busy.
const ERRORS: u32 = 1 << 1 | 1 << 3 | 1 << 4 | 1 << 5 | 1 << 6 | 1 << 7 | 1 << 8 | 1 << 9;
const BUSY: u32 = 1 << 16;

/// Bits of `FLASH_CR` (chapter 3): program, erase a page, the place of its number, the second bank, start, lock.
const PROGRAM: u32 = 1;
const ERASE_PAGE: u32 = 1 << 1;
const PAGE_AT: u32 = 3;
const IN_SECOND_BANK: u32 = 1 << 11;
const START: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;

/// Bits of `FLASH_ACR` (chapter 3): reset and enable of the data cache.
const DATA_CACHE_RESET: u32 = 1 << 12;
const DATA_CACHE_ENABLE: u32 = 1 << 10;

/// Bits of `FLASH_ECCR` (chapter 3): a double word that cannot be corrected, which a one clears; it is in the second bank.
const CANNOT_CORRECT: u32 = 1 << 31;
const ERROR_IN_SECOND_BANK: u32 = 1 << 21;

/// Option bits of `FLASH_OPTR` (chapter 3): two banks; start from the second one, which would exchange them.
const TWO_BANKS: u32 = 1 << 22;
const SECOND_FIRST: u32 = 1 << 20;

/// Greatest number of reads of the status until an operation has ended: at more than four cycles of 170 MHz each more than twice the 24.5 ms that
/// a page may take.
const READS: u32 = 3_000_000;

/// Whether the flash has two banks, and the program is in the first.
pub fn has_two_banks(bus: impl Bus) -> bool {
    bus.read(flash::OPTR) & (TWO_BANKS | SECOND_FIRST) == TWO_BANKS
}

/// For the NMI: whether it was raised by a double word of the second bank that cannot be corrected. Clears it.
pub fn take_interrupted_word(bus: impl Bus) -> bool {
    let error = bus.read(flash::ECCR);
    let is_here = error & (CANNOT_CORRECT | ERROR_IN_SECOND_BANK) == CANNOT_CORRECT | ERROR_IN_SECOND_BANK;
    if is_here {
        bus.write(flash::ECCR, CANNOT_CORRECT);
    }
    is_here
}

/// The slots of the flash.
#[derive(Clone, Copy, Debug)]
pub struct SettingsFlash<B> {
    bus: B,
}

impl<B: Bus> SettingsFlash<B> {
    /// The slots behind the bus.
    pub const fn new(bus: B) -> Self {
        Self { bus }
    }

    /// Changes the flash, which is locked before and afterwards. Refused while the supply is low, and while an operation that has not ended in time
    /// goes on: a write to the registers would then stall the program.
    fn change(
        &self,
        change: impl FnOnce(B) -> Result<(), NorFlashErrorKind>,
    ) -> Result<(), NorFlashErrorKind> {
        let bus = self.bus;
        if supply::is_low(bus) || is_busy(bus) {
            return Err(NorFlashErrorKind::Other);
        }
        // Errors of an earlier access.
        bus.write(flash::SR, ERRORS);
        for key in KEYS {
            bus.write(flash::KEYR, key);
        }
        let unlocked = bus.read(flash::CR) & LOCK == 0;
        let result = if unlocked { change(bus) } else { Err(NorFlashErrorKind::Other) };
        if !is_busy(bus) {
            bus.write(flash::CR, LOCK);
        }
        // The data cache may hold what was erased or programmed.
        reset_data_cache(bus);
        result
    }
}

fn is_busy(bus: impl Bus) -> bool {
    bus.read(flash::SR) & BUSY != 0
}

/// Waits for the end of an operation.
fn finish(bus: impl Bus) -> Result<(), NorFlashErrorKind> {
    let has_ended = bus.within_reads(READS, flash::SR, BUSY, 0);
    if has_ended && bus.read(flash::SR) & ERRORS == 0 { Ok(()) } else { Err(NorFlashErrorKind::Other) }
}

/// Erases a page of the second bank (chapter 3).
fn erase_page(bus: impl Bus, offset: u32) -> Result<(), NorFlashErrorKind> {
    let number = (offset - SECOND_BANK) / PAGE;
    let selected = ERASE_PAGE | IN_SECOND_BANK | number << PAGE_AT;
    bus.write(flash::CR, selected);
    bus.write(flash::CR, selected | START);
    finish(bus)
}

/// Programs double words (chapter 3).
fn program(bus: impl Bus, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
    bus.write(flash::CR, PROGRAM);
    let (words, _) = bytes.as_chunks::<4>();
    let (pairs, _) = words.as_chunks::<2>();
    pairs.iter().zip((offset..).step_by(DOUBLE_WORD as usize)).try_for_each(|([low, high], at)| {
        bus.write(ADDRESS + at, u32::from_le_bytes(*low));
        bus.write(ADDRESS + at + 4, u32::from_le_bytes(*high));
        finish(bus)
    })
}

/// Discards the lines of the data cache, which may hold what was erased (chapter 3). It is switched off for this, as the reset requires.
fn reset_data_cache(bus: impl Bus) {
    let without = bus.read(flash::ACR) & !(DATA_CACHE_ENABLE | DATA_CACHE_RESET);
    for bits in [0, DATA_CACHE_RESET, 0, DATA_CACHE_ENABLE] {
        bus.write(flash::ACR, without | bits);
    }
}

impl<B> ErrorType for SettingsFlash<B> {
    type Error = NorFlashErrorKind;
}

impl<B: Bus> ReadNorFlash for SettingsFlash<B> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        for (byte, at) in bytes.iter_mut().zip(offset..) {
            let word = self.bus.read(ADDRESS + at / 4 * 4);
            *byte = word.to_le_bytes()[at as usize % 4];
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl<B: Bus> NorFlash for SettingsFlash<B> {
    const WRITE_SIZE: usize = DOUBLE_WORD as usize;
    const ERASE_SIZE: usize = PAGE as usize;

    /// Erases pages of one slot or of both.
    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        if from < SLOTS.starts[0] {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        self.change(|bus| (from..to).step_by(PAGE as usize).try_for_each(|page| erase_page(bus, page)))
    }

    /// Programs double words of the slots.
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        if offset < SLOTS.starts[0] {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        self.change(|bus| program(bus, offset, bytes))
    }
}
