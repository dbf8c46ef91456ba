//! The two slots for settings: the last two sectors of the flash, 128 KiB each, behind the program (`memory/board.x`).
//!
//! While a sector is erased, for one to two seconds, the flash cannot be read, so that the program stands still. Therefore a save
//! is allowed with the drives off only; the watchdog gets its longest period meanwhile.

use embedded_storage::nor_flash::NorFlash;
use shared::storage::{Slots, StorageError, Store};
use stm32f4xx_hal::flash::{FlashExt, UnlockedFlash};
use stm32f4xx_hal::pac::FLASH;

/// The slots, bytes from the start of the flash.
pub const SLOTS: Slots = Slots { starts: [0xc_0000, 0xe_0000], length: 0x2_0000 };

/// Identity of this board in a record.
pub const BOARD: u32 = 0x4051_0002;

/// Runs an access to the stored settings. With the flash unlocked; it is locked again afterwards.
///
/// # Errors
/// Those of the access, and [`StorageError::Layout`] if the flash of the chip is smaller.
pub fn with_store<R>(
    flash: &mut FLASH,
    access: impl FnOnce(&mut Store<UnlockedFlash<'_>>) -> Result<R, StorageError>,
) -> Result<R, StorageError> {
    const { assert!(SLOTS.length as usize == <UnlockedFlash<'_> as NorFlash>::ERASE_SIZE) };
    access(&mut Store::new(flash.unlocked(), SLOTS, BOARD)?)
}
