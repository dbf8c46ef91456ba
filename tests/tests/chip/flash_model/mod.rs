//! The code that erases and programs the flash of the chip, on a model of its registers ([`interface`]), with a loss of power at every
//! write of a save.

mod interface;

use embedded_storage::nor_flash::{NorFlash, NorFlashErrorKind, ReadNorFlash};
use firmware::flash::{BOARD, SLOTS, SettingsFlash};
use shared::storage::Store;

use super::stored_records::{messages, save, stored};
use interface::{ACR_AT_START, Interface, Watched};

/// Without a loss of power.
const NEVER: usize = usize::MAX;

/// `FLASH_CR` after a reset (RM0090, 3.9.7).
const LOCKED: u32 = 1 << 31;

type Settings<'a> = Store<SettingsFlash<Watched<'a>>>;

fn store(interface: &mut Interface) -> Settings<'_> {
    Store::new(SettingsFlash::new(Watched(interface)), SLOTS, BOARD).unwrap()
}

/// The content of the flash after a number of saves.
fn after_saves(saves: u8) -> Vec<u8> {
    let mut interface = Interface::new(Interface::erased(), NEVER, 0);
    for number in 1..=saves {
        assert_eq!(save(&mut store(&mut interface), number), Ok(u32::from(number)));
    }
    interface.into_memory()
}

/// After three saves the third is read, and the flash is locked, with its caches and wait states as before.
#[test]
fn saves_alternate_between_the_sectors_and_leave_the_flash_locked() {
    let mut interface = Interface::new(after_saves(2), NEVER, 0);
    assert_eq!(save(&mut store(&mut interface), 3), Ok(3));
    assert_eq!(stored(&mut store(&mut interface)), Some(messages(3)));
    assert_eq!(interface.registers(), [ACR_AT_START, LOCKED]);
    assert!(!interface.watchdog_is_slow);
    // The first record was in the first sector, the second in the second one, where it still is.
    let memory = interface.into_memory();
    let second = after_saves(2);
    assert_eq!(memory[SLOTS.length as usize..], second[SLOTS.length as usize..]);
    assert_ne!(memory[..SLOTS.length as usize], second[..SLOTS.length as usize]);
}

/// With 0 to 3 records before, the supply fails at each write of the next save, by what remains of the byte or of the sector at that moment in three random
/// ways. The old or the new record is read afterwards, and a save succeeds. Only the last byte of the header, of which no bit may be missing,
/// makes the new one valid; and the lock follows after it.
#[test]
fn after_a_loss_of_power_at_any_write_the_old_or_the_new_record_is_read() {
    for before in 0..=3 {
        let memory = after_saves(before);
        let old = (before > 0).then(|| messages(before));
        let new = messages(before + 1);
        let mut complete = Interface::new(memory.clone(), NEVER, 0);
        save(&mut store(&mut complete), before + 1).unwrap();
        let writes = complete.writes;
        // 65 bytes with a length of two each, a header of 32, and an unlock, a lock and more for each 32 of them.
        assert!((120..200).contains(&writes), "{writes} writes");
        let mut seen = [0; 2];
        for (fails_at, seed) in (0..writes).flat_map(|at| (0..3).map(move |seed| (at, seed))) {
            let mut failing = Interface::new(memory.clone(), fails_at, seed);
            let _ = save(&mut store(&mut failing), before + 1);
            let mut restarted = Interface::new(failing.into_memory(), NEVER, 0);
            let found = stored(&mut store(&mut restarted));
            assert!(
                found == old || found.as_ref() == Some(&new),
                "{before} records, write {fails_at}: {found:?}"
            );
            seen[usize::from(found.as_ref() == Some(&new))] += 1;
            save(&mut store(&mut restarted), before + 2).unwrap();
            assert_eq!(stored(&mut store(&mut restarted)), Some(messages(before + 2)), "write {fails_at}");
        }
        let [olds, news] = seen;
        assert!(olds > 3 * (writes - 5) && news > 0, "{seen:?} of {writes} writes");
    }
}

/// The line of a byte that was read before the erase is in the data cache. The reset of the cache lets the erased byte be read.
#[test]
fn an_erased_byte_is_not_read_from_the_data_cache() {
    let mut interface = Interface::new(vec![0x5a; 2 * SLOTS.length as usize], NEVER, 0);
    let mut flash = SettingsFlash::new(Watched(&mut interface));
    for start in SLOTS.starts {
        let mut read = [0; 40];
        flash.read(start, &mut read).unwrap();
        assert_eq!(read, [0x5a; 40]);
        flash.erase(start, start + SLOTS.length).unwrap();
        flash.read(start, &mut read).unwrap();
        assert_eq!(read, [0xff; 40]);
        flash.write(start + 1, &[1, 2]).unwrap();
        flash.read(start, &mut read[..4]).unwrap();
        assert_eq!(read[..4], [0xff, 1, 2, 0xff]);
    }
}

/// The errors of 3.9.5: operation, write protection, alignment, parallelism, sequence. Each is reported by the access that has it, ends it,
/// and is cleared before the next one.
#[test]
fn each_error_of_an_operation_is_reported_and_does_not_stay() {
    for bit in [1, 4, 5, 6, 7] {
        let mut interface = Interface::new(Interface::erased(), NEVER, 0);
        interface.next_error = 1 << bit;
        let mut flash = SettingsFlash::new(Watched(&mut interface));
        let [first, second] = SLOTS.starts;
        assert_eq!(flash.write(first, &[1, 2]), Err(NorFlashErrorKind::Other), "bit {bit}");
        let mut read = [0; 2];
        flash.read(first, &mut read).unwrap();
        assert_eq!(read, [1, 0xff], "bit {bit}: no byte follows");
        flash.write(first + 4, &[3]).unwrap();
        flash.access_mut().0.next_error = 1 << bit;
        assert_eq!(flash.erase(first, second), Err(NorFlashErrorKind::Other), "bit {bit}");
        flash.erase(first, second).unwrap();
    }
}

/// A flash that stays locked, as after a wrong key, is not accessed.
#[test]
fn a_flash_that_cannot_be_unlocked_is_an_error() {
    let mut interface = Interface::new(Interface::erased(), NEVER, 0);
    interface.is_jammed = true;
    let mut flash = SettingsFlash::new(Watched(&mut interface));
    let [first, second] = SLOTS.starts;
    assert_eq!(flash.write(first, &[1]), Err(NorFlashErrorKind::Other));
    assert_eq!(flash.erase(first, second), Err(NorFlashErrorKind::Other));
    assert!(interface.into_memory().iter().all(|byte| *byte == 0xff));
}

/// Whatever is no slot is neither erased nor written nor, beyond the end, read; and nothing is written to a register.
#[test]
fn nothing_outside_of_the_slots_is_changed() {
    let mut interface = Interface::new(Interface::erased(), NEVER, 0);
    let mut flash = SettingsFlash::new(Watched(&mut interface));
    let [first, second] = SLOTS.starts;
    for (from, to) in
        [(0, SLOTS.length), (first - SLOTS.length, first), (first, second + SLOTS.length), (first, first)]
    {
        assert_eq!(flash.erase(from, to), Err(NorFlashErrorKind::OutOfBounds), "{from:#x} to {to:#x}");
    }
    assert_eq!(flash.erase(first + 1, second), Err(NorFlashErrorKind::NotAligned));
    assert_eq!(flash.write(first - 1, &[0; 4]), Err(NorFlashErrorKind::OutOfBounds));
    let end = second + SLOTS.length;
    assert_eq!(flash.write(end - 1, &[0; 2]), Err(NorFlashErrorKind::OutOfBounds));
    assert_eq!(flash.read(end - 1, &mut [0; 2]), Err(NorFlashErrorKind::OutOfBounds));
    assert_eq!(flash.capacity(), 1 << 20);
    assert_eq!(flash.access_mut().0.writes, 0);
}
