//! The settings in the second bank of the flash, on a model of its registers, with a loss of power at every write of a save.

use embedded_storage::nor_flash::{NorFlash, NorFlashErrorKind, ReadNorFlash};
use firmware::g474::flash::{BOARD, SLOTS, SettingsFlash};
use shared::link::report::{SettingsSource, StoredRecord};
use shared::link::{Reply, Request};
use shared::storage::Store;

use super::board::{Board, Port, model};
use super::flash_model::{Defect, FlashModel, LOCKED, Remains};
use super::model::{Model, RCC};
use crate::stored_records::{messages, save, stored};

/// Without a loss of power.
const NEVER: usize = usize::MAX;

/// `FLASH_ACR`, as the start leaves it: four wait states, prefetch, both caches, access of a debugger.
const ACR: u32 = 0x4002_2000;
const ACR_AT_START: u32 = 0x0004_0704;

/// `PWR_SR2`: the supply is below the level of the detector.
const SR2: u32 = 0x4000_7014;
const PVDO: u32 = 1 << 11;

fn chip(remains: Remains, fails_at: usize, seed: u64) -> &'static Model {
    let model = Model::new(FlashModel::new(remains, fails_at, seed));
    model.set(RCC + 0x58, 1 << 28);
    model.set(ACR, ACR_AT_START);
    model
}

fn flash(model: &'static Model) -> SettingsFlash<&'static Model> {
    SettingsFlash::new(model)
}

type Settings = Store<SettingsFlash<&'static Model>>;

fn store(model: &'static Model) -> Settings {
    Store::new(flash(model), SLOTS, BOARD).unwrap()
}

fn after_saves(saves: u8) -> Remains {
    let model = chip(Remains::erased(), NEVER, 0);
    for number in 1..=saves {
        assert_eq!(save(&mut store(model), number), Ok(u32::from(number)));
    }
    model.with(|state| state.flash.remains())
}

/// The slots are the second half of the second bank, a save erases the 32 pages of the older one and leaves the flash locked, its caches and wait
/// states as before.
#[test]
fn saves_alternate_between_the_slots_and_leave_the_flash_locked() {
    let model = chip(after_saves(2), NEVER, 0);
    assert_eq!(save(&mut store(model), 3), Ok(3));
    assert_eq!(stored(&mut store(model)), Some(messages(3)));
    model.with(|state| {
        let pages: Vec<u32> = (0..32).map(|page| 0x6_0000 + 0x800 * page).collect();
        assert_eq!(state.flash.erased_pages, pages);
        assert_eq!(state.flash.control(), LOCKED);
    });
    assert_eq!(model.word(ACR), ACR_AT_START);
    assert_eq!((SLOTS.starts, SLOTS.length), ([0x6_0000, 0x7_0000], 0x1_0000));
}

/// With 0 to 2 records before, the supply fails at each write of the next save, by what remains of the double word or of the page in three random ways, with
/// check bits that do not fit. The old or the new record is read afterwards, and a save succeeds.
#[test]
fn after_a_loss_of_power_at_any_write_the_old_or_the_new_record_is_read() {
    for before in 0..=2 {
        let memory = after_saves(before);
        let old = (before > 0).then(|| messages(before));
        let new = messages(before + 1);
        let complete = chip(memory.clone(), NEVER, 0);
        save(&mut store(complete), before + 1).unwrap();
        let writes = complete.with(|state| state.flash.writes);
        // 32 pages with two writes each, 13 double words of two, and an unlock and a lock.
        assert!((80..200).contains(&writes), "{writes} writes");
        let mut seen = [0; 2];
        for (fails_at, seed) in (0..writes).flat_map(|at| (0..3).map(move |seed| (at, seed))) {
            let failing = chip(memory.clone(), fails_at, seed);
            let _ = save(&mut store(failing), before + 1);
            let restarted = chip(failing.with(|state| state.flash.remains()), NEVER, 0);
            let found = stored(&mut store(restarted));
            assert!(found == old || found.as_ref() == Some(&new), "{before}, write {fails_at}: {found:?}");
            seen[usize::from(found.as_ref() == Some(&new))] += 1;
            save(&mut store(restarted), before + 2).unwrap();
            assert_eq!(stored(&mut store(restarted)), Some(messages(before + 2)), "write {fails_at}");
        }
        let [olds, news] = seen;
        assert!(olds > 3 * (writes - 5) && news > 0, "{seen:?} of {writes} writes");
    }
}

/// A double word that was read before the erase is in the data cache. The reset of the cache lets the erased bytes be read.
#[test]
fn an_erased_byte_is_not_read_from_the_data_cache() {
    let model = chip(Remains::filled(0x5a), NEVER, 0);
    let mut flash = flash(model);
    for start in SLOTS.starts {
        let mut read = [0; 40];
        flash.read(start, &mut read).unwrap();
        assert_eq!(read, [0x5a; 40]);
        flash.erase(start, start + 0x1000).unwrap();
        flash.read(start, &mut read).unwrap();
        assert_eq!(read, [0xff; 40]);
        flash.write(start + 8, &[1, 2, 3, 4, 5, 6, 7, 8]).unwrap();
        flash.read(start + 9, &mut read[..8]).unwrap();
        assert_eq!(read[..8], [2, 3, 4, 5, 6, 7, 8, 0xff]);
    }
}

/// The errors of chapter 3 are each reported by the access that has it, end it, and are cleared before the next one; a double word that is programmed twice is
/// one of them.
#[test]
fn each_error_of_an_operation_is_reported_and_does_not_stay() {
    for bit in [1, 3, 4, 5, 6, 7, 8, 9] {
        let model = chip(Remains::erased(), NEVER, 0);
        let mut flash = flash(model);
        let fail = || model.with(|state| state.flash.next_error = 1 << bit);
        let start = SLOTS.starts[0];
        fail();
        assert_eq!(flash.write(start, &[1; 16]), Err(NorFlashErrorKind::Other), "bit {bit}");
        let mut read = [0; 16];
        flash.read(start, &mut read).unwrap();
        assert_eq!(read[8..], [0xff; 8], "bit {bit}: no double word follows");
        flash.write(start + 8, &[3; 8]).unwrap();
        fail();
        assert_eq!(flash.erase(start, start + 0x1000), Err(NorFlashErrorKind::Other), "bit {bit}");
        assert_eq!(model.with(|state| state.flash.erased_pages.len()), 1, "no page follows");
        flash.erase(start, start + 0x1000).unwrap();
    }
    let model = chip(Remains::erased(), NEVER, 0);
    flash(model).write(SLOTS.starts[1], &[1; 8]).unwrap();
    assert_eq!(flash(model).write(SLOTS.starts[1], &[1; 8]), Err(NorFlashErrorKind::Other));
}

/// A flash that stays locked, one whose operation does not end, and one whose supply is low are not changed, or not further.
#[test]
fn a_flash_that_cannot_be_changed_is_an_error() {
    let changed = |model: &'static Model| {
        let results = [
            flash(model).write(SLOTS.starts[0], &[1; 8]),
            flash(model).erase(SLOTS.starts[1], SLOTS.starts[1] + 0x800),
        ];
        assert_eq!(results, [Err(NorFlashErrorKind::Other); 2]);
        model.with(|state| state.flash.remains().memory).iter().any(|byte| *byte != 0xff)
    };
    let jammed = chip(Remains::erased(), NEVER, 0);
    jammed.with(|state| state.flash.defect = Defect::Jammed);
    assert!(!changed(jammed));
    let low = chip(Remains::erased(), NEVER, 0);
    low.set(SR2, PVDO);
    assert!(!changed(low));
    assert_eq!(low.with(|state| state.flash.writes), 0);
    let stuck = chip(Remains::erased(), NEVER, 0);
    stuck.with(|state| state.flash.defect = Defect::NeverEnds);
    assert_eq!(flash(stuck).write(SLOTS.starts[0], &[1; 16]), Err(NorFlashErrorKind::Other));
}

/// Whatever is no slot is neither erased nor written nor, beyond the end, read; and nothing is written to a register of it.
#[test]
fn nothing_outside_of_the_slots_is_changed() {
    let model = chip(Remains::erased(), NEVER, 0);
    let mut flash = flash(model);
    let [first, second] = SLOTS.starts;
    let end = second + SLOTS.length;
    for (from, to) in [(0, 0x800), (first - 0x800, first), (first - 0x800, first + 0x800), (end, end + 0x800)]
    {
        assert_eq!(flash.erase(from, to), Err(NorFlashErrorKind::OutOfBounds), "{from:#x} to {to:#x}");
    }
    assert_eq!(flash.erase(first + 8, second), Err(NorFlashErrorKind::NotAligned));
    assert_eq!(flash.write(first - 8, &[0; 8]), Err(NorFlashErrorKind::OutOfBounds));
    assert_eq!(flash.write(end - 8, &[0; 16]), Err(NorFlashErrorKind::OutOfBounds));
    for (at, bytes) in [(first + 4, 8), (first, 4)] {
        assert_eq!(flash.write(at, &[0; 16][..bytes]), Err(NorFlashErrorKind::NotAligned));
    }
    assert_eq!(flash.read(end - 1, &mut [0; 2]), Err(NorFlashErrorKind::OutOfBounds));
    assert_eq!(flash.capacity(), 512 * 1024);
    assert_eq!(model.with(|state| state.flash.writes), 0);
}

/// A save of a host holds off no tick (the model refuses it), is refused with the drives on, and is read at the next start.
#[test]
fn a_host_saves_settings_while_the_ticks_continue() {
    let mut board = Board::enabled(Port::Can);
    assert!(matches!(board.ask(&Request::BeginSave), Reply::Refused(_)));
    assert_eq!(board.model.with(|state| state.flash.erased_pages.len()), 0);
    assert_eq!(board.ask(&Request::Disable), Reply::Done);
    board.ticks(2);
    assert_eq!(board.ask(&Request::BeginSave), Reply::Done);
    assert_eq!(board.model.with(|state| state.flash.erased_pages.len()), 32);
    let settings = firmware::setup::LINK_SETTINGS;
    let upload = shared::link::message::BoardSettings { rates: settings.rates, axes: settings.axes };
    let mut bytes = [0; 1024];
    let contents = postcard::to_slice(&upload, &mut bytes).unwrap().to_vec();
    for (part, offset) in contents.chunks(200).zip((0..).step_by(200)) {
        let bytes = part.iter().copied().collect();
        assert_eq!(board.ask(&Request::Upload { offset, bytes }), Reply::Done);
    }
    let apply = Request::Apply {
        kind: shared::link::message::UploadKind::Settings,
        length: u16::try_from(contents.len()).unwrap(),
        checksum: shared::link::packet::checksum(&contents),
    };
    assert_eq!(board.ask(&apply), Reply::Done);
    assert_eq!(board.ask(&Request::Save), Reply::Done);
    let remains = board.model.with(|state| state.flash.remains());
    let mut restarted = Board::with(model(remains), Port::Serial);
    assert!(matches!(restarted.ask(&Request::Hello { nonce: 8 }), Reply::Welcome(_)));
    let Reply::Status(status) = restarted.ask(&Request::Status) else { panic!("no status") };
    assert_eq!(
        (status.settings.source, status.settings.stored),
        (SettingsSource::Record, StoredRecord::Valid(1))
    );
}
