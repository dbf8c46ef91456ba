//! Settings in flash: saved by a host, and applied at the next start.

use embedded_storage::nor_flash::NorFlash;
use shared::compensate::CompensationSettings;
use shared::compensate::settings::{Cycle, Pitch, PitchSource, Points};
use shared::drive::NotArmed;
use shared::drive::direction_check::DirectionCheckSettings;
use shared::feedback::OriginShift;
use shared::link::Refusal;
use shared::link::history::HistoryEvent;
use shared::link::message::{BoardSettings, Reply, Request, UploadKind};
use shared::link::report::{SettingsReport, SettingsSource, StoredRecord};
use shared::safety::{Fault, Power};
use shared::storage::{SlotError, Store};

use super::jog_by;
use super::rig::{BOARD, Memory, Rig, SLOT, SLOTS, settings};
use super::uploads::{bytes_of, upload};

/// Settings that differ from those of the program: the axes lag behind the command.
pub fn slower(position_gain_per_s: f64) -> BoardSettings<2> {
    let mut settings = settings();
    settings.axes = settings.axes.map(|mut axis| {
        (axis.position_gain_per_s, axis.travel_m) = (position_gain_per_s, Some([-0.02, 0.02]));
        axis
    });
    settings
}

/// A compensation with tables, different for each axis.
fn compensation(axis: u8) -> CompensationSettings {
    let values = (0..9).map(|k| 1e-6 * f64::from(k * (3 + i32::from(axis)) % 7)).collect();
    let forward = Points { start_m: -0.02, spacing_m: 0.005, values };
    CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Screw, forward, backward: None }),
        backlash_width_m: Some(20e-6),
        ripple: [Cycle::harmonic(3.0, 5e-3, f64::from(axis))].into_iter().collect(),
        ..CompensationSettings::default()
    }
}

fn upload_all<F: NorFlash>(rig: &mut Rig<F>, settings: &BoardSettings<2>) {
    assert_eq!(upload(rig, UploadKind::Settings, settings), Reply::Done);
    for axis in [0, 1] {
        assert_eq!(upload(rig, UploadKind::Compensation { axis }, &compensation(axis)), Reply::Done);
    }
}

pub fn save_all<F: NorFlash>(rig: &mut Rig<F>, settings: &BoardSettings<2>) {
    assert_eq!(rig.request(&Request::BeginSave), Reply::Done);
    upload_all(rig, settings);
    assert_eq!(rig.request(&Request::Save), Reply::Done);
}

/// The flash after a number of saves.
pub fn saved(gains_per_s: &[f64]) -> Memory {
    let mut flash = Memory::erased();
    for gain in gains_per_s {
        save_all(&mut Rig::with_flash(&mut flash), &slower(*gain));
    }
    flash
}

pub fn report<F: NorFlash>(rig: &mut Rig<F>) -> SettingsReport {
    rig.status().settings
}

pub const fn from_record(number: u32) -> SettingsReport {
    SettingsReport { source: SettingsSource::Record, stored: StoredRecord::Valid(number) }
}

/// Commands, readings and forces of both axes in a tick, and the exact positions of the plant.
type Sample = ([i64; 4], [u32; 2], [u64; 2]);

/// A jog there and back in every tick, with both axes homed, so that compensations over the position are applied.
fn trace_of_a_jog<F: NorFlash>(rig: &mut Rig<F>) -> Vec<Sample> {
    let machine = rig.drive.machine_mut();
    (0..2).for_each(|axis| machine.lose_reference(axis));
    (0..2).for_each(|axis| machine.set_origin(axis, OriginShift { motor: 0, table: 0 }).unwrap());
    rig.close_switch();
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
    rig.run(2);
    let mut trace = Vec::new();
    for distance_m in [0.004, -0.003] {
        assert_eq!(rig.request(&jog_by(distance_m)), Reply::Done);
        for _ in 0..5000 {
            rig.run(1);
            let status = rig.status();
            let [x, y] = status.axes.into_array().unwrap();
            trace.push((
                [x.command, x.motor, y.command, y.motor].map(|position| position.0),
                [x.force_n, y.force_n].map(f32::to_bits),
                rig.plant.position_m.map(f64::to_bits),
            ));
        }
    }
    assert_eq!(rig.status().power, Power::On);
    trace
}

/// The first tick in which two runs differ.
fn difference(left: &[Sample], right: &[Sample]) -> Option<usize> {
    assert_eq!(left.len(), right.len());
    (0..left.len()).find(|tick| left[*tick] != right[*tick])
}

#[test]
#[cfg_attr(miri, ignore = "a motion too long for it")]
fn after_a_restart_a_motion_with_the_saved_settings_is_the_same_to_the_bit() {
    let mut flash = Memory::erased();
    let mut first = Rig::with_flash(&mut flash);
    assert_eq!(report(&mut first), SettingsReport::PROGRAM);
    save_all(&mut first, &slower(20.0));
    assert_eq!(report(&mut first), from_record(1));
    let before = trace_of_a_jog(&mut first);
    let mut restarted = Rig::with_flash(flash);
    assert_eq!(report(&mut restarted), from_record(1));
    assert_eq!(
        (restarted.status().power, restarted.status().not_armed),
        (Power::Off, Some(NotArmed::Switch))
    );
    assert_eq!(difference(&trace_of_a_jog(&mut restarted), &before), None);
    // The travel of the record.
    assert!(matches!(restarted.refusal(&jog_by(0.02)), Refusal::Path { .. }));
    // The comparison would notice other settings, and a missing compensation.
    assert!(difference(&trace_of_a_jog(&mut Rig::new()), &before).is_some());
    let mut without = Rig::new();
    assert_eq!(upload(&mut without, UploadKind::Settings, &slower(20.0)), Reply::Done);
    assert_eq!(report(&mut without).source, SettingsSource::Upload);
    assert!(difference(&trace_of_a_jog(&mut without), &before).is_some());
}

/// An upload without a save does not reach the flash; each save replaces the older of two records.
#[test]
fn the_newest_save_counts_and_an_upload_alone_is_not_kept() {
    let mut flash = saved(&[20.0, 21.0, 22.0]);
    let mut rig = Rig::with_flash(&mut flash);
    assert_eq!(report(&mut rig), from_record(3));
    upload_all(&mut rig, &slower(23.0));
    let unsaved = SettingsReport { source: SettingsSource::Upload, ..from_record(3) };
    assert_eq!(report(&mut rig), unsaved);
    assert_eq!(report(&mut Rig::with_flash(flash)), from_record(3));
}

#[test]
fn a_save_is_refused_while_the_drives_are_on() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.refusal(&Request::BeginSave), Refusal::DrivesOn);
    assert_eq!(rig.refusal(&Request::Save), Refusal::DrivesOn);
    // Begun before: the record is not completed either, until the drives are off.
    assert_eq!(rig.request(&Request::Disable), Reply::Done);
    rig.run(2);
    assert_eq!(rig.request(&Request::BeginSave), Reply::Done);
    upload_all(&mut rig, &slower(20.0));
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
    rig.run(2);
    assert_eq!(rig.refusal(&Request::Save), Refusal::DrivesOn);
    assert_eq!(rig.request(&Request::Disable), Reply::Done);
    rig.run(2);
    assert_eq!(rig.request(&Request::Save), Reply::Done);
}

/// Without a tick in between the power stages are still enabled with the last duty: they would stay so while the flash is erased.
/// An enable that waits for the next tick is withdrawn, and does not come true after the access.
#[test]
fn the_flash_waits_for_the_tick_that_switches_the_power_stages_off() {
    let mut rig = Rig::enabled();
    rig.drive.disable();
    assert!(rig.plant.enabled);
    assert_eq!(rig.drive.begin_flash_access(), Err(Refusal::DrivesOn));
    rig.run(1);
    assert!(!rig.plant.enabled);
    rig.drive.enable().unwrap();
    assert_eq!(rig.drive.begin_flash_access(), Ok(()));
    rig.drive.end_flash_access();
    rig.run(5);
    assert_eq!((rig.status().power, rig.plant.enabled), (Power::Off, false));
}

/// A direction check pushes an axis with the loops open: also one that only waits for the switch excludes a save.
#[test]
fn a_save_is_refused_during_a_direction_check() {
    let mut rig = Rig::new();
    let check = DirectionCheckSettings { force_n: 40.0, time_s: 0.2, detect_m: 1e-4 };
    assert_eq!(rig.request(&Request::CheckDirection { axis: 0, settings: check }), Reply::Done);
    rig.run(10);
    assert_eq!(rig.refusal(&Request::BeginSave), Refusal::Moving);
    assert_eq!(rig.request(&Request::Stop), Reply::Done);
    rig.run(2);
    assert_eq!(rig.request(&Request::BeginSave), Reply::Done);
}

/// The record has all that is applied or it is not made: without settings, after a refused upload, and in another session.
#[test]
fn an_incomplete_record_is_not_saved() {
    let mut flash = saved(&[20.0]);
    let mut rig = Rig::with_flash(&mut flash);
    assert_eq!(rig.refusal(&Request::Save), Refusal::NothingToSave);
    assert_eq!(rig.request(&Request::BeginSave), Reply::Done);
    assert_eq!(upload(&mut rig, UploadKind::Compensation { axis: 0 }, &compensation(0)), Reply::Done);
    assert_eq!(rig.refusal(&Request::Save), Refusal::NothingToSave);
    assert_eq!(rig.request(&Request::BeginSave), Reply::Done);
    upload_all(&mut rig, &slower(25.0));
    let mut wrong = slower(25.0);
    wrong.axes[1].position_gain_per_s = -1.0;
    let refused = upload(&mut rig, UploadKind::Settings, &wrong);
    assert!(matches!(refused, Reply::Refused(Refusal::Setting { axis: 1, .. })), "{refused:?}");
    assert_eq!(rig.refusal(&Request::Save), Refusal::NothingToSave);
    assert_eq!(rig.request(&Request::BeginSave), Reply::Done);
    upload_all(&mut rig, &slower(25.0));
    rig.hello(2);
    assert_eq!(rig.refusal(&Request::Save), Refusal::NothingToSave);
    assert_eq!(report(&mut Rig::with_flash(flash)), from_record(1));
}

/// While the flash is accessed the counters of a board may wrap unseen.
#[test]
fn a_save_loses_the_references() {
    let mut rig = Rig::new();
    assert_eq!(rig.axes().map(|axis| axis.homed), [true; 2]);
    assert_eq!(rig.request(&Request::BeginSave), Reply::Done);
    assert_eq!(rig.axes().map(|axis| axis.homed), [false; 2]);
}

/// Neither record can be read: the settings of the program, and a fault that has to be acknowledged before an enable.
#[test]
fn a_flash_that_cannot_be_used_is_a_fault_by_name() {
    let mut flash = saved(&[20.0, 21.0]);
    for slot in [0, SLOT as usize] {
        // In the content, behind the header of 32 bytes.
        flash.bytes_mut()[slot + 50] ^= 4;
    }
    let mut rig = Rig::started(&mut flash, Some(Fault::Watchdog));
    let reasons = [SlotError::Checksum; 2];
    let invalid = SettingsReport { stored: StoredRecord::Invalid(reasons), ..SettingsReport::PROGRAM };
    assert_eq!(report(&mut rig), invalid);
    rig.close_switch();
    assert_eq!(rig.refusal(&Request::Enable), Refusal::Faulted(Fault::StoredSettings));
    let Reply::FaultHistory(history) = rig.request(&Request::FaultHistory) else { panic!("no history") };
    let events: Vec<_> = history.iter().map(|entry| entry.event).collect();
    // The watchdog is not hidden by it.
    assert!(events.contains(&HistoryEvent::Fault(Fault::Watchdog)), "{events:?}");
    assert!(events.contains(&HistoryEvent::Fault(Fault::StoredSettings)), "{events:?}");
    assert_eq!(rig.request(&Request::Clear), Reply::Done);
    assert_eq!(difference(&trace_of_a_jog(&mut rig), &trace_of_a_jog(&mut Rig::new())), None);
    // A new save heals it.
    assert_eq!(rig.request(&Request::Disable), Reply::Done);
    rig.run(2);
    save_all(&mut rig, &slower(20.0));
    assert_eq!(report(&mut Rig::with_flash(flash)), from_record(1));
}

#[test]
fn a_reset_by_the_watchdog_keeps_the_saved_settings_and_needs_an_acknowledgement() {
    let mut rig = Rig::started(saved(&[20.0]), Some(Fault::Watchdog));
    assert_eq!(report(&mut rig), from_record(1));
    rig.close_switch();
    assert_eq!(rig.refusal(&Request::Enable), Refusal::Faulted(Fault::Watchdog));
}

/// A valid record with an upload that the controller does not accept: nothing of it is applied.
#[test]
fn a_record_that_is_not_accepted_leaves_the_settings_of_the_program() {
    let mut flash = Memory::erased();
    let mut store = Store::new(&mut flash, SLOTS, BOARD).unwrap();
    let mut writer = store.writer().unwrap();
    let mut wrong = compensation(1);
    wrong.position_bound_m = 1.0;
    for (kind, contents) in [
        (UploadKind::Settings, bytes_of(&slower(20.0))),
        (UploadKind::Compensation { axis: 0 }, bytes_of(&compensation(0))),
        (UploadKind::Compensation { axis: 1 }, bytes_of(&wrong)),
    ] {
        writer.message(&mut store, &kind).unwrap();
        writer.bytes(&mut store, &contents).unwrap();
    }
    assert_eq!(writer.commit(&mut store), Ok(1));
    let mut rig = Rig::with_flash(flash);
    let refused = SettingsReport { stored: StoredRecord::Refused(1), ..SettingsReport::PROGRAM };
    assert_eq!(report(&mut rig), refused);
    rig.close_switch();
    assert_eq!(rig.refusal(&Request::Enable), Refusal::Faulted(Fault::StoredSettings));
    assert_eq!(rig.request(&Request::Clear), Reply::Done);
    assert_eq!(difference(&trace_of_a_jog(&mut rig), &trace_of_a_jog(&mut Rig::new())), None);
}
