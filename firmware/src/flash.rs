//! The two slots for settings in the flash of an STM32F405: erasing, programming and reading them through the registers of the flash
//! interface (RM0090, chapter 3), on any access to these registers. A test runs this code on a model of them.
//!
//! While a sector is erased, for two to four seconds (data sheet DS8626, byte by byte), the flash cannot be read, so that the program
//! stands still; a byte that is written takes 16 to 100 µs. Therefore the flash is accessed with the power stages off only
//! ([`shared::link::HostedDrive::begin_flash_access`]), and the watchdog gets its longest period meanwhile.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use shared::storage::Slots;

/// The slots, bytes from the start of the flash: its last two sectors, behind the program (`memory/board.x`).
pub const SLOTS: Slots = Slots { starts: [0xc_0000, 0xe_0000], length: 0x2_0000 };

/// Identity of the STM32F405 board in a record.
pub const BOARD: u32 = 0x4051_0002;

/// Bytes of the flash of an STM32F405RG.
pub const BYTES: usize = 0x10_0000;

const _: () = assert!((SLOTS.starts[1] + SLOTS.length) as usize == BYTES);

/// Registers of the flash interface (3.9).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    /// `FLASH_ACR`: caches.
    AccessControl,
    /// `FLASH_KEYR`: its two keys, one after the other, unlock `FLASH_CR`.
    Key,
    /// `FLASH_SR`: errors and the operation that goes on.
    Status,
    /// `FLASH_CR`: what an access does.
    Control,
}

/// The flash interface.
pub trait FlashRegisters {
    /// Reads a register.
    fn get(&self, register: Register) -> u32;

    /// Writes a register.
    fn set(&mut self, register: Register, value: u32);

    /// Reads a byte, `offset` bytes from the start of the flash.
    fn byte(&self, offset: u32) -> u8;

    /// Stores a byte, `offset` bytes from the start of the flash.
    fn set_byte(&mut self, offset: u32, byte: u8);
}

/// The flash interface with the watchdog that its accesses have to extend.
pub trait FlashAccess {
    /// The flash interface.
    type Registers: FlashRegisters;

    /// For accesses that do not stop the program.
    fn registers(&mut self) -> &mut Self::Registers;

    /// Executes accesses that stop the program, with the longest period of the watchdog.
    fn with_slow_watchdog<R>(&mut self, change: impl FnOnce(&mut Self::Registers) -> R) -> R;
}

/// The two keys of `FLASH_KEYR` (3.6.1).
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// Bits of `FLASH_SR` (3.9.5): the errors, each of which is cleared by a one, and busy.
const ERRORS: u32 = 1 << 7 | 1 << 6 | 1 << 5 | 1 << 4 | 1 << 1;
const BUSY: u32 = 1 << 16;

/// Bits of `FLASH_CR` (3.9.7): program, erase a sector, the place of its number, start, lock. Accesses are of one byte (PSIZE 00), which
/// every supply allows (table 7).
const PROGRAM: u32 = 1;
const ERASE_SECTOR: u32 = 1 << 1;
const SECTOR_AT: u32 = 3;
const START: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;

/// Bits of `FLASH_ACR` (3.9.2): reset and enable of the data cache.
const DATA_CACHE_RESET: u32 = 1 << 12;
const DATA_CACHE_ENABLE: u32 = 1 << 10;

/// The slots of the flash.
#[derive(Debug)]
pub struct SettingsFlash<A> {
    access: A,
}

impl<A: FlashAccess> SettingsFlash<A> {
    /// The slots behind an access to the flash.
    pub const fn new(access: A) -> Self {
        Self { access }
    }

    /// The access.
    pub const fn access_mut(&mut self) -> &mut A {
        &mut self.access
    }

    /// Changes the flash, which is locked before and afterwards.
    fn change(
        &mut self,
        change: impl FnOnce(&mut A::Registers) -> Result<(), NorFlashErrorKind>,
    ) -> Result<(), NorFlashErrorKind> {
        self.access.with_slow_watchdog(|registers| {
            // Errors of an earlier access.
            registers.set(Register::Status, ERRORS);
            for key in KEYS {
                registers.set(Register::Key, key);
            }
            let unlocked = registers.get(Register::Control) & LOCK == 0;
            let result = if unlocked { change(registers) } else { Err(NorFlashErrorKind::Other) };
            registers.set(Register::Control, LOCK);
            result
        })
    }
}

/// Waits for the end of an operation; the watchdog ends a wait for ever.
fn finish(registers: &impl FlashRegisters) -> Result<(), NorFlashErrorKind> {
    loop {
        let status = registers.get(Register::Status);
        if status & BUSY == 0 {
            return if status & ERRORS == 0 { Ok(()) } else { Err(NorFlashErrorKind::Other) };
        }
    }
}

/// Erases a sector (3.6.3).
fn erase(registers: &mut impl FlashRegisters, sector: u32) -> Result<(), NorFlashErrorKind> {
    let selected = ERASE_SECTOR | sector << SECTOR_AT;
    registers.set(Register::Control, selected);
    registers.set(Register::Control, selected | START);
    finish(registers)
}

/// Programs bytes (3.6.4).
fn program(registers: &mut impl FlashRegisters, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
    registers.set(Register::Control, PROGRAM);
    bytes.iter().zip(offset..).try_for_each(|(byte, at)| {
        registers.set_byte(at, *byte);
        finish(registers)
    })
}

/// Discards the lines of the data cache, which may hold what was erased (3.5.2). It is switched off for this, as the reset requires.
fn reset_data_cache(registers: &mut impl FlashRegisters) {
    let without = registers.get(Register::AccessControl) & !(DATA_CACHE_ENABLE | DATA_CACHE_RESET);
    for bits in [0, DATA_CACHE_RESET, 0, DATA_CACHE_ENABLE] {
        registers.set(Register::AccessControl, without | bits);
    }
}

impl<A> ErrorType for SettingsFlash<A> {
    type Error = NorFlashErrorKind;
}

impl<A: FlashAccess> ReadNorFlash for SettingsFlash<A> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        let registers = self.access.registers();
        bytes.iter_mut().zip(offset..).for_each(|(byte, at)| *byte = registers.byte(at));
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl<A: FlashAccess> NorFlash for SettingsFlash<A> {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SLOTS.length as usize;

    /// Erases one slot.
    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        if !SLOTS.starts.contains(&from) || to != from + SLOTS.length {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        // Sectors of 128 KiB from the address 0x2_0000 on, the first of which has the number 5 (table 5).
        let sector = from / SLOTS.length + 4;
        let result = self.change(|registers| erase(registers, sector));
        reset_data_cache(self.access.registers());
        result
    }

    /// Programs bytes of a slot.
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        if offset < SLOTS.starts[0] {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        self.change(|registers| program(registers, offset, bytes))
    }
}
