//! The registers of the flash interface for [`crate::flash`], with the watchdog.

use rtic::Mutex;
use shared::link::SettingsMemory;
use shared::storage::Store;
use stm32f4xx_hal::pac::FLASH;

use super::watchdog::Watchdog;
use crate::flash::{BOARD, FlashAccess, FlashRegisters, Register, SLOTS, SettingsFlash};

/// Address of the flash.
const ADDRESS: usize = 0x0800_0000;

/// The flash interface of the chip.
pub struct ChipFlash(FLASH);

/// The flash of the chip, with the watchdog that its accesses have to extend.
pub struct WatchedFlash<W> {
    flash: ChipFlash,
    watchdog: W,
}

/// The settings in the flash of the chip.
pub type Settings<W> = SettingsMemory<SettingsFlash<WatchedFlash<W>>>;

/// The settings in the flash.
///
/// # Panics
/// Never: the slots are constants that fit the flash.
pub fn settings_memory<W: Mutex<T = Watchdog>>(flash: FLASH, watchdog: W) -> Settings<W> {
    let access = WatchedFlash { flash: ChipFlash(flash), watchdog };
    let store = Store::new(SettingsFlash::new(access), SLOTS, BOARD);
    SettingsMemory::new(store.expect("the slots are constants that fit the flash"))
}

/// Place of a byte in the address space.
const fn place(offset: u32) -> *mut u8 {
    core::ptr::with_exposed_provenance_mut(ADDRESS + offset as usize)
}

impl FlashRegisters for ChipFlash {
    fn get(&self, register: Register) -> u32 {
        match register {
            Register::AccessControl => self.0.acr().read().bits(),
            Register::Status => self.0.sr().read().bits(),
            Register::Control => self.0.cr().read().bits(),
            // It can only be written.
            Register::Key => 0,
        }
    }

    fn set(&mut self, register: Register, value: u32) {
        // SAFETY: no register of the flash interface makes the memory of the program invalid: only the slots are erased and programmed.
        unsafe {
            match register {
                Register::AccessControl => self.0.acr().write(|w| w.bits(value)),
                Register::Key => self.0.keyr().write(|w| w.bits(value)),
                Register::Status => self.0.sr().write(|w| w.bits(value)),
                Register::Control => self.0.cr().write(|w| w.bits(value)),
            };
        }
    }

    fn byte(&self, offset: u32) -> u8 {
        // SAFETY: within the flash, as the caller checks; volatile, because its content is not that of a variable.
        unsafe { place(offset).read_volatile() }
    }

    fn set_byte(&mut self, offset: u32, byte: u8) {
        // SAFETY: within the slots, as the caller checks, which contain no variable.
        unsafe { place(offset).write_volatile(byte) }
    }
}

impl<W: Mutex<T = Watchdog>> FlashAccess for WatchedFlash<W> {
    type Registers = ChipFlash;

    fn registers(&mut self) -> &mut ChipFlash {
        &mut self.flash
    }

    fn with_slow_watchdog<R>(&mut self, change: impl FnOnce(&mut ChipFlash) -> R) -> R {
        let Self { flash, watchdog } = self;
        watchdog.lock(|watchdog| watchdog.during(|| change(flash)))
    }
}
