//! Uploads of settings and compensation.

use embedded_storage::nor_flash::NorFlash;
use serde::Serialize;
use shared::compensate::CompensationSettings;
use shared::config::{Rates, VelocitySource};
use shared::link::message::{BoardSettings, LONGEST_UPLOAD, PART, Reply, Request, UploadKind};
use shared::link::packet;
use shared::link::refusal::{SettingProblem, UploadError};
use shared::link::{Refusal, Status};
use shared::safety::Fault;

use super::jog_by;
use super::rig::{Rig, settings};

pub fn bytes_of(contents: &impl Serialize) -> Vec<u8> {
    let mut buffer = [0; LONGEST_UPLOAD];
    postcard::to_slice(contents, &mut buffer).unwrap().to_vec()
}

/// Sends all parts. Returns the request that applies them.
fn stage<F: NorFlash>(rig: &mut Rig<F>, kind: UploadKind, bytes: &[u8]) -> Request {
    for (part, offset) in bytes.chunks(PART).zip((0u16..).step_by(PART)) {
        let bytes = heapless::Vec::from_slice(part).unwrap();
        assert_eq!(rig.request(&Request::Upload { offset, bytes }), Reply::Done);
    }
    let length = u16::try_from(bytes.len()).unwrap();
    Request::Apply { kind, length, checksum: packet::checksum(bytes) }
}

pub fn upload<F: NorFlash>(rig: &mut Rig<F>, kind: UploadKind, contents: &impl Serialize) -> Reply {
    let apply = stage(rig, kind, &bytes_of(contents));
    rig.request(&apply)
}

fn changed(change: impl Fn(&mut BoardSettings<2>)) -> BoardSettings<2> {
    let mut settings = settings();
    change(&mut settings);
    settings
}

/// What the status says about the machine, without its clock and counters.
fn state(rig: &mut Rig) -> Status {
    Status { tick: 0, link: Default::default(), ..rig.status() }
}

/// New settings act: with a travel of ±10 mm a jog of 20 mm is refused.
#[test]
fn settings_are_applied() {
    let mut rig = Rig::new();
    let narrow = changed(|settings| settings.axes[0].travel_m = Some([-0.01, 0.01]));
    assert_eq!(upload(&mut rig, UploadKind::Settings, &narrow), Reply::Done);
    rig.close_switch();
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
    rig.run(2);
    assert!(matches!(rig.refusal(&jog_by(0.02)), Refusal::Path { .. }));
    assert_eq!(rig.request(&jog_by(0.009)), Reply::Done);
}

/// A wrong setting is refused by axis and name, and the settings from before still act.
#[test]
fn a_wrong_setting_is_refused_by_name_and_changes_nothing() {
    let mut rig = Rig::new();
    let before = state(&mut rig);
    let wrong = changed(|settings| {
        settings.axes[0].travel_m = Some([-0.01, 0.01]);
        settings.axes[1].position_gain_per_s = -1.0;
    });
    let Reply::Refused(Refusal::Setting { axis, name, problem }) =
        upload(&mut rig, UploadKind::Settings, &wrong)
    else {
        panic!("not refused")
    };
    assert_eq!((axis, name.as_str(), problem), (1, "position_gain_per_s", SettingProblem::NotPositive));
    let nan = changed(|settings| settings.axes[0].velocity_gain_n_s_per_m = f64::NAN);
    let refused = upload(&mut rig, UploadKind::Settings, &nan);
    assert!(
        matches!(&refused, Reply::Refused(Refusal::Setting { axis: 0, name, .. })
        if name == "velocity_gain_n_s_per_m"),
        "{refused:?}"
    );
    let slow = changed(|settings| settings.rates = Rates { velocity_loop_hz: 10_000.0, ..settings.rates });
    let tick_rate = Reply::Refused(Refusal::TickRate { board_hz: 20_000.0 });
    assert_eq!(upload(&mut rig, UploadKind::Settings, &slow), tick_rate);
    assert_eq!(state(&mut rig), before);
    rig.close_switch();
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
    rig.run(2);
    assert_eq!(rig.request(&jog_by(0.02)), Reply::Done);
}

/// An observer of the velocity is applied with its bandwidth; one beyond its range is refused with it, and changes nothing.
#[test]
fn an_observer_of_the_velocity_is_applied_or_refused_by_name() {
    let with = |bandwidth_hz| {
        changed(|settings| settings.axes[1].velocity_source = VelocitySource::Observer { bandwidth_hz })
    };
    let mut rig = Rig::new();
    let before = state(&mut rig);
    for bandwidth_hz in [19.0, 5001.0] {
        let Reply::Refused(Refusal::Setting { axis, name, problem }) =
            upload(&mut rig, UploadKind::Settings, &with(bandwidth_hz))
        else {
            panic!("not refused")
        };
        let range = SettingProblem::OutOfRange { min: 20.0, max: 5000.0 };
        assert_eq!((axis, name.as_str(), problem), (1, "velocity_observer_hz", range));
        assert_eq!(state(&mut rig), before);
    }
    assert_eq!(upload(&mut rig, UploadKind::Settings, &with(300.0)), Reply::Done);
}

#[test]
fn nothing_is_applied_while_the_drives_are_on() {
    let mut rig = Rig::enabled();
    assert_eq!(upload(&mut rig, UploadKind::Settings, &settings()), Reply::Refused(Refusal::DrivesOn));
    let kind = UploadKind::Compensation { axis: 0 };
    let none = CompensationSettings::default();
    assert_eq!(upload(&mut rig, kind, &none), Reply::Refused(Refusal::DrivesOn));
}

#[test]
fn an_incomplete_or_damaged_upload_is_refused_by_name() {
    let mut rig = Rig::new();
    let bytes = bytes_of(&settings());
    let refused = |error| Reply::Refused(Refusal::Upload(error));
    let Request::Apply { kind, length, checksum } = stage(&mut rig, UploadKind::Settings, &bytes) else {
        panic!()
    };
    let wrong = Request::Apply { kind, length, checksum: checksum ^ 1 };
    assert_eq!(rig.request(&wrong), refused(UploadError::Checksum));
    let shorter = Request::Apply { kind, length: length - 1, checksum };
    assert_eq!(rig.request(&shorter), refused(UploadError::Length { found: length }));
    let part = || heapless::Vec::from_slice(&[1, 2, 3]).unwrap();
    let gap = Request::Upload { offset: length + 1, bytes: part() };
    assert_eq!(rig.request(&gap), refused(UploadError::OutOfOrder { expected: length }));
    // None of them has changed what is there.
    assert_eq!(rig.request(&Request::Apply { kind, length, checksum }), Reply::Done);
    let beyond = stage(&mut rig, UploadKind::Settings, &vec![7; LONGEST_UPLOAD]);
    let end = u16::try_from(LONGEST_UPLOAD).unwrap();
    let more = Request::Upload { offset: end, bytes: part() };
    assert_eq!(rig.request(&more), refused(UploadError::TooLong { max: end }));
    assert_eq!(rig.request(&beyond), refused(UploadError::Unreadable));
}

/// A compensation of an axis that is not there, and one whose bound is no number.
#[test]
fn a_wrong_compensation_is_refused_by_name() {
    let mut rig = Rig::new();
    let none = CompensationSettings::default();
    let kind = |axis| UploadKind::Compensation { axis };
    assert_eq!(upload(&mut rig, kind(2), &none), Reply::Refused(Refusal::NoSuchAxis));
    let wrong = CompensationSettings { position_bound_m: f64::NAN, ..none.clone() };
    let refused = upload(&mut rig, kind(1), &wrong);
    assert!(
        matches!(&refused, Reply::Refused(Refusal::Setting { axis: 1, name, .. })
        if name == "position_bound_m"),
        "{refused:?}"
    );
    assert_eq!(upload(&mut rig, kind(1), &none), Reply::Done);
}

/// A compensation acts: with a backlash of 100 µm the motor is ahead by half of it, less what the friction of 20 N holds.
#[test]
fn a_compensation_is_applied() {
    let offset_um = |backlash_width_m| {
        let mut rig = Rig::new();
        let compensation = CompensationSettings { backlash_width_m, ..CompensationSettings::default() };
        let kind = UploadKind::Compensation { axis: 0 };
        assert_eq!(upload(&mut rig, kind, &compensation), Reply::Done);
        rig.close_switch();
        assert_eq!(rig.request(&Request::Enable), Reply::Done);
        rig.run(2);
        assert_eq!(rig.request(&jog_by(0.01)), Reply::Done);
        for _ in 0..20 {
            rig.run(2000);
            assert!(rig.status().power.is_on());
        }
        1e6 * (rig.plant.position_m[0] - 0.01)
    };
    let (without, with) = (offset_um(None), offset_um(Some(100e-6)));
    assert!((with - without - 50.0).abs() < 5.0, "{without} {with}");
}

/// New settings know no more of the positions than there was known before: an axis that is not homed stays so, and its soft limits do not
/// hold; one that is homed stays homed.
#[test]
fn an_upload_leaves_each_axis_as_homed_as_it_was() {
    for not_homed in [0, 1] {
        let mut rig = Rig::new();
        rig.drive.machine_mut().lose_reference(not_homed);
        let expected = [0, 1].map(|axis| axis != not_homed);
        assert_eq!(rig.axes().map(|axis| axis.homed), expected);
        assert_eq!(upload(&mut rig, UploadKind::Settings, &settings()), Reply::Done);
        assert_eq!(rig.axes().map(|axis| axis.homed), expected);
    }
}

/// During a fault that is not acknowledged, settings are refused by its name, and the old ones remain. After `Clear` they are accepted.
#[test]
fn nothing_is_applied_during_a_fault() {
    let mut rig = Rig::enabled();
    rig.drive.fault(Fault::BusOvervoltage);
    rig.run(1);
    let narrow = changed(|settings| settings.axes[0].travel_m = Some([-0.01, 0.01]));
    let faulted = Reply::Refused(Refusal::Faulted(Fault::BusOvervoltage));
    assert_eq!(upload(&mut rig, UploadKind::Settings, &narrow), faulted);
    let compensation = CompensationSettings::default();
    assert_eq!(upload(&mut rig, UploadKind::Compensation { axis: 0 }, &compensation), faulted);
    assert_eq!(rig.request(&Request::Clear), Reply::Done);
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
    rig.run(2);
    assert_eq!(rig.request(&jog_by(0.02)), Reply::Done);
    assert_eq!(rig.request(&Request::Disable), Reply::Done);
    rig.run(2);
    assert_eq!(upload(&mut rig, UploadKind::Settings, &narrow), Reply::Done);
}
