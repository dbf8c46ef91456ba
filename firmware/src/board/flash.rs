//! The two slots for settings: the last two sectors of the flash, 128 KiB each, behind the program (`memory/board.x`).
//!
//! While a sector is erased, for two to four seconds (data sheet DS8626, byte by byte), the flash cannot be read, so that the program
//! stands still; a byte that is written takes 16 to 100 µs. Therefore the flash is accessed with the power stages off only
//! ([`shared::link::HostedDrive::without_ticks`]), and the watchdog gets its longest period meanwhile.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use rtic::Mutex;
use shared::link::SettingsMemory;
use shared::storage::{Slots, Store};
use stm32f4xx_hal::flash::{FlashExt, UnlockedFlash};
use stm32f4xx_hal::pac::FLASH;

use super::watchdog::Watchdog;

/// The slots, bytes from the start of the flash.
pub const SLOTS: Slots = Slots { starts: [0xc_0000, 0xe_0000], length: 0x2_0000 };

/// Identity of this board in a record.
pub const BOARD: u32 = 0x4051_0002;

/// Bytes of the flash of an STM32F405RG.
const BYTES: usize = 0x10_0000;

/// Address of the flash.
const ADDRESS: usize = 0x0800_0000;

/// The flash of the chip, with the watchdog that its accesses have to extend.
pub struct SettingsFlash<W> {
    flash: FLASH,
    watchdog: W,
}

/// The settings in the flash.
///
/// # Panics
/// Never: the slots are constants that fit the flash.
pub fn settings_memory<W: Mutex<T = Watchdog>>(
    flash: FLASH,
    watchdog: W,
) -> SettingsMemory<SettingsFlash<W>> {
    const {
        assert!(SLOTS.length as usize == <UnlockedFlash<'_> as NorFlash>::ERASE_SIZE);
        assert!((SLOTS.starts[1] + SLOTS.length) as usize == BYTES);
    }
    let store = Store::new(SettingsFlash { flash, watchdog }, SLOTS, BOARD);
    SettingsMemory::new(store.expect("the slots are constants that fit the flash"))
}

impl<W: Mutex<T = Watchdog>> SettingsFlash<W> {
    /// Changes the flash.
    fn change(
        &mut self,
        access: impl FnOnce(&mut UnlockedFlash<'_>) -> Result<(), stm32f4xx_hal::flash::Error>,
    ) -> Result<(), NorFlashErrorKind> {
        let Self { flash, watchdog } = self;
        watchdog.lock(|watchdog| {
            watchdog.during(|| {
                // Errors of an earlier access: a one clears each.
                flash.sr().write(|w| {
                    w.pgserr().clear_bit_by_one().pgperr().clear_bit_by_one().pgaerr().clear_bit_by_one();
                    w.wrperr().clear_bit_by_one().operr().clear_bit_by_one()
                });
                access(&mut flash.unlocked()).map_err(|_| NorFlashErrorKind::Other)
            })
        })
    }

    /// Discards the lines of the data cache, which may hold what was erased (RM0090, 3.5.2).
    fn reset_data_cache(&mut self) {
        let control = self.flash.acr();
        control.modify(|_, w| w.dcen().clear_bit());
        control.modify(|_, w| w.dcrst().set_bit());
        control.modify(|_, w| w.dcrst().clear_bit());
        control.modify(|_, w| w.dcen().set_bit());
    }
}

impl<W> ErrorType for SettingsFlash<W> {
    type Error = NorFlashErrorKind;
}

impl<W: Mutex<T = Watchdog>> ReadNorFlash for SettingsFlash<W> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        for (byte, at) in bytes.iter_mut().zip(ADDRESS + offset as usize..) {
            // SAFETY: within the flash, as checked; volatile, because its content is not that of a variable.
            *byte = unsafe { core::ptr::with_exposed_provenance::<u8>(at).read_volatile() };
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl<W: Mutex<T = Watchdog>> NorFlash for SettingsFlash<W> {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SLOTS.length as usize;

    /// Erases one sector.
    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        if !SLOTS.starts.contains(&from) || to != from + SLOTS.length {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        // Sectors of 128 KiB from the address 0x2_0000 on, the first of which has the number 5 (RM0090, table 5).
        let sector = (from / SLOTS.length + 4).to_le_bytes()[0];
        let result = self.change(|flash| flash.erase(sector));
        self.reset_data_cache();
        result
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        self.change(|flash| flash.program(offset as usize, bytes.iter()))
    }
}
