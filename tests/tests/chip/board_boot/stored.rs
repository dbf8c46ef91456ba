//! Settings in the flash of the emulated chip. QEMU has no flash controller: what is loaded is tested here, saving is tested on the
//! host (`shared/tests/link/saving.rs`) and on the emulated servo board (`servo_board`).

use firmware::setup::{AXES, LINK_SETTINGS};
use shared::config::{AxisSettings, Rates};
use shared::link::message::{BoardSettings, UploadKind};
use shared::link::report::{SettingsReport, SettingsSource, StoredRecord};
use shared::link::{Reply, Request};
use shared::safety::{Fault, Power};
use shared::storage::memory::MemoryFlash;
use shared::storage::{SlotError, Slots, Store};
use tests::board::inputs::Inputs;
use tests::board::log::{Access, watchdog_periods_ms};
use tests::board::{Chip, End};
use tests::firmware::{SETTINGS_SLOTS, built};

use super::host::Host;

/// Identity of the board in a record (`firmware/src/board/flash.rs`).
const BOARD: u32 = 0x4051_0002;

/// QEMU's name of the registers of the flash.
const FLASH_INTERFACE: &str = "Flash Int";

/// Length of the slots here: the settings of two axes.
const SLOT: usize = 2048;

/// Ticks per position command in the record; the program has 5.
const DIVIDER: u32 = 4;

/// A slot with a record of other ticks per position command.
fn record() -> Vec<u8> {
    slot_with(Rates { position_loop_divider: DIVIDER, ..LINK_SETTINGS.rates }, &LINK_SETTINGS.axes)
}

/// A slot with a record of the settings of the program, changed for each axis.
pub fn record_of(change: impl Fn(&mut AxisSettings)) -> Vec<u8> {
    let mut axes = LINK_SETTINGS.axes;
    axes.iter_mut().for_each(change);
    slot_with(LINK_SETTINGS.rates, &axes)
}

fn slot_with(rates: Rates, axes: &[AxisSettings; AXES]) -> Vec<u8> {
    let mut flash = MemoryFlash::<{ 2 * SLOT }, SLOT, 1>::erased();
    let length = u32::try_from(SLOT).unwrap();
    let mut store = Store::new(&mut flash, Slots { starts: [0, length], length }, BOARD).unwrap();
    let mut writer = store.writer().unwrap();
    writer.message(&mut store, &UploadKind::Settings).unwrap();
    writer.message(&mut store, &BoardSettings { rates, axes: *axes }).unwrap();
    assert_eq!(writer.commit(&mut store), Ok(1));
    flash.bytes_mut()[..SLOT].to_vec()
}

/// Starts the board with a content of its second slot; returns the ticks per position command, power and settings.
fn started_with(slot: &[u8]) -> (u32, Power, SettingsReport) {
    let mut chip = Chip::start(&built("board"), None);
    chip.target.set_memory(SETTINGS_SLOTS[1], slot).unwrap();
    let mut host = Host::connect(&chip);
    assert_eq!(chip.run(40), Ok(End::Ticked), "{}", chip.diagnostics());
    host.send(&Request::Hello { nonce: 78 });
    assert_eq!(chip.run(120), Ok(End::Ticked), "{}", chip.diagnostics());
    let Some(Reply::Welcome(welcome)) = host.reply() else { panic!("no welcome; {}", chip.diagnostics()) };
    host.send(&Request::Status);
    let ticks = chip.ticks();
    assert_eq!(chip.run(ticks + 100), Ok(End::Ticked), "{}", chip.diagnostics());
    let Some(Reply::Status(status)) = host.reply() else { panic!("no status; {}", chip.diagnostics()) };
    assert!(!chip.log.text().contains("Invalid"), "{}", chip.diagnostics());
    (welcome.rates.position_loop_divider, status.power, status.settings)
}

#[test]
fn the_program_that_is_flashed_loads_the_record_in_its_flash() {
    let (divider, power, settings) = started_with(&record());
    let expected = SettingsReport { source: SettingsSource::Record, stored: StoredRecord::Valid(1) };
    assert_eq!((divider, power, settings), (DIVIDER, Power::Off, expected));
}

#[test]
fn a_damaged_record_in_the_flash_is_a_fault_and_the_settings_are_those_of_the_program() {
    let mut damaged = record();
    damaged[100] ^= 8;
    let (divider, power, settings) = started_with(&damaged);
    let stored = StoredRecord::Invalid([SlotError::Empty, SlotError::Checksum]);
    let expected = SettingsReport { source: SettingsSource::Program, stored };
    assert_eq!(divider, LINK_SETTINGS.rates.position_loop_divider);
    assert_eq!((power, settings), (Power::Faulted(Fault::StoredSettings), expected));
}

/// Bits of `FLASH_CR` (RM0090, 3.9.8): erase a sector, start, and the number of the sector from bit 3.
const SER: u32 = 1 << 1;
const STRT: u32 = 1 << 16;

/// A save erases the slot that does not hold the newest record, and no other sector: the slots at `0x080C_0000` and `0x080E_0000` are the
/// sectors 10 and 11 (table 5). Meanwhile the watchdog has its longest period: at 47 kHz, the fastest that its clock may have, 32.76 s are
/// 22 s, which is more than the 4 s of an erase; before and after it 10 ms.
#[test]
fn a_save_erases_the_sector_of_the_older_slot_with_a_slow_watchdog() {
    for (newest, sector) in [(1, 10), (0, 11)] {
        let mut chip = Chip::start(&built("board"), Some(Inputs::default()));
        chip.target.set_memory(SETTINGS_SLOTS[newest], &record()).unwrap();
        let mut host = Host::connect(&chip);
        assert_eq!(chip.run(40), Ok(End::Ticked), "{}", chip.diagnostics());
        host.send(&Request::Hello { nonce: 79 });
        assert_eq!(chip.run(120), Ok(End::Ticked), "{}", chip.diagnostics());
        assert!(matches!(host.reply(), Some(Reply::Welcome(_))));
        host.send(&Request::BeginSave);
        assert_eq!(chip.run(200), Ok(End::Ticked), "{}", chip.diagnostics());
        let accesses = chip.log.accesses();
        let controls: Vec<u32> = accesses
            .iter()
            .filter(|access| access.device == FLASH_INTERFACE && access.offset == 0x10)
            .filter_map(|access| access.written)
            .filter(|bits| bits & STRT != 0)
            .collect();
        let erased: Vec<u32> = controls.iter().map(|bits| bits >> 3 & 0xf).collect();
        assert_eq!(erased, [sector], "{controls:x?}");
        assert!(controls.iter().all(|bits| bits & SER != 0), "{controls:x?}");
        watchdog_periods_ms(&accesses, &[10.0, 32_760.0, 10.0]);
        // The end of the erase is read in FLASH_SR, and the lock in FLASH_CR; the wait states are those before it.
        for offset in [0x0c, 0x10] {
            let reads = |access: &&Access| {
                access.device == FLASH_INTERFACE && access.offset == offset && access.written.is_none()
            };
            assert!(accesses.iter().any(|access| reads(&access)), "{offset:#x} is not read");
        }
        assert_eq!(chip.clocks.flash_access(), (5, true));
    }
}
