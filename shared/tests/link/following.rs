//! An axis that follows a counter, by a host: what starts it, what it does, and what ends it.

use shared::interpolate::PathError;
use shared::interpolate::following::{FollowError, FollowSettings};
use shared::link::Refusal;
use shared::link::halt::Halt;
use shared::link::message::{Reply, Request};
use shared::link::packet::Header;
use shared::link::report::{Activity, AxisStatus};
use shared::safety::{Fault, FaultKind, Power};
use shared::units::{PER_NM, Position};

use super::jog_by;
use super::rig::{Rig, TICK_HZ, settings};

/// 5 mm for 4000 counts.
pub const FOLLOWING: FollowSettings = FollowSettings {
    input: 0,
    distance_m: 5e-3,
    counts: 4000,
    speed_m_per_s: 0.05,
    acceleration_m_per_s2: 2.0,
    lag_m: 3e-3,
};

fn follow(axis: u8, settings: FollowSettings) -> Request {
    Request::Follow { axis, settings }
}

/// With the drives on and a counter at the input of x, which wraps soon.
fn rig() -> Rig {
    let mut rig = Rig::enabled();
    rig.plant.counters = [Some(u32::MAX - 99), None];
    rig.run(1);
    rig
}

/// The counter goes on by a number of counts at 4000 a second, 5 mm/s, with a host that is there or silent.
fn turn(rig: &mut Rig, counts: i32, host_is_there: bool) {
    for _ in 0..counts.abs() {
        rig.plant.counters[0] = rig.plant.counters[0].map(|count| count.wrapping_add_signed(counts.signum()));
        rig.run(5);
        if host_is_there {
            rig.drive.heard();
        }
    }
}

fn axis(rig: &Rig, axis: usize) -> AxisStatus {
    rig.drive.status(Default::default(), Default::default()).axes[axis]
}

/// After a turn of the counter and a second the command is 5 mm further, to 8 units, and the axis within a count of its sensor and its following error
/// by friction, 20 N at 3000 N·s/m and 25/s without an integral: 0.27 mm. Two axes follow one counter, y against it and by half.
#[test]
fn it_follows_by_its_ratio_until_it_is_stopped() {
    let mut rig = rig();
    let start = [0, 1].map(|index| axis(&rig, index).command);
    assert_eq!(rig.request(&follow(0, FOLLOWING)), Reply::Done);
    assert_eq!(rig.request(&follow(1, FollowSettings { distance_m: -2.5e-3, ..FOLLOWING })), Reply::Done);
    turn(&mut rig, 4000, true);
    turn(&mut rig, 2, true);
    turn(&mut rig, -2, true);
    rig.drive.heard();
    for _ in 0..20 {
        rig.run(TICK_HZ / 20);
        rig.drive.heard();
    }
    let exact = [5_000_000 * PER_NM, -2_500_000 * PER_NM];
    for (index, exact) in exact.into_iter().enumerate() {
        let AxisStatus { command, motor, lag, .. } = axis(&rig, index);
        assert!((command - start[index] - exact).abs() <= 8, "{index}: {}", command - start[index] - exact);
        assert!(lag.unwrap().abs() <= 8, "{lag:?}");
        let error_um = (motor - command) as f64 / (1e3 * PER_NM as f64);
        assert!(error_um.abs() < 300.0, "{error_um} µm");
    }
    let status = rig.status();
    assert!(status.activity == Activity::Following && !status.at_rest);
    assert_eq!(status.axes[0].counter, Some(3900));
    // Nothing else moves the axes meanwhile, and there is nothing to override or to resume.
    assert_eq!(rig.refusal(&jog_by(0.001)), Refusal::Moving);
    assert_eq!(rig.refusal(&Request::NewMotion), Refusal::Moving);
    assert_eq!(rig.refusal(&Request::Override { percent: 50 }), Refusal::NothingMoves);
    assert_eq!(rig.refusal(&Request::Resume), Refusal::NotHeld);
    assert_eq!(rig.refusal(&follow(0, FOLLOWING)), Refusal::Follow(FollowError::Engaged));
    assert_eq!(rig.request(&Request::Stop), Reply::Done);
    rig.run(10);
    assert_eq!(rig.status().activity, Activity::Idle);
    let stands = axis(&rig, 0).command;
    turn(&mut rig, 400, true);
    assert_eq!(axis(&rig, 0).command, stands);
    // A jog works again, and a fresh engagement begins where the axis is, whatever the counter has done.
    assert_eq!(rig.request(&jog_by(0.001)), Reply::Done);
    turn(&mut rig, 1000, true);
    let from = axis(&rig, 0).command;
    assert_eq!(rig.request(&follow(0, FOLLOWING)), Reply::Done);
    rig.run(100);
    assert_eq!(axis(&rig, 0).command, from);
}

/// Whatever ends a motion ends it: the axis comes to rest, and what the counter does afterwards moves nothing until a fresh engagement.
#[test]
fn whatever_ends_a_motion_ends_it() {
    type End = fn(&mut Rig);
    let ends: [(&str, End); 9] = [
        ("stop", |rig| assert_eq!(rig.request(&Request::Stop), Reply::Done)),
        ("hold", |rig| assert_eq!(rig.request(&Request::Hold), Reply::Done)),
        ("disable", |rig| assert_eq!(rig.request(&Request::Disable), Reply::Done)),
        ("stop by a guest", |rig| {
            assert_eq!(rig.send(Header::without_session(7), &Request::Stop), Reply::Done);
        }),
        ("hold by a guest", |rig| {
            assert_eq!(rig.send(Header::without_session(7), &Request::Hold), Reply::Done);
            // It cannot be resumed, and its host is told so.
            assert_eq!(rig.refusal(&Request::Enable), Refusal::HaltedByOther(Halt::Stop));
        }),
        ("silence", |rig| turn(rig, 2100, false)),
        ("enable switch", |rig| rig.plant.switch_closed = false),
        ("emergency stop", |rig| rig.plant.stopped = true),
        ("limit switch", |rig| rig.plant.limits[0] = [false, true]),
    ];
    for (name, end) in ends {
        let mut rig = rig();
        assert_eq!(rig.request(&follow(0, FOLLOWING)), Reply::Done);
        turn(&mut rig, 1000, true);
        let at_m = axis(&rig, 0).command.to_m();
        // 1000 counts are 1.25 mm.
        assert!((1e-3..1.3e-3).contains(&at_m), "{name}: {at_m} m");
        end(&mut rig);
        // 5 mm/s with 0.5 m/s² or more end within 10 ms.
        turn(&mut rig, 60, true);
        let stands = axis(&rig, 0);
        assert_eq!(stands.lag, None, "{name}");
        turn(&mut rig, 2000, true);
        let moved_um = (axis(&rig, 0).motor - stands.motor) as f64 / (1e3 * PER_NM as f64);
        // Drives that are on pull the axis to its command; those that are off let it coast.
        assert!(moved_um.abs() < 300.0, "{name}: {moved_um} µm");
        let is_on = axis(&rig, 0).command == stands.command;
        assert!(is_on || !rig.status().power.is_on(), "{name}");
    }
}

/// 70 mm/s before an axis of 50 mm/s and 3 mm: a fault with a name, by which the drives go off when the axis stands.
#[test]
fn a_counter_that_is_too_fast_is_a_fault_with_a_name() {
    let mut rig = rig();
    assert_eq!(rig.request(&follow(0, FOLLOWING)), Reply::Done);
    for _ in 0..12_000 {
        rig.plant.counters[0] = rig.plant.counters[0].map(|count| count.wrapping_add(14));
        rig.run(5);
        rig.drive.heard();
    }
    let fault = Fault::Axis { axis: 0, kind: FaultKind::GearLag };
    assert_eq!(rig.status().power, Power::Faulted(fault));
    // It needs an acknowledgement, an enable and a fresh engagement.
    assert_eq!(rig.refusal(&follow(0, FOLLOWING)), Refusal::Faulted(fault));
    assert_eq!(rig.request(&Request::Clear), Reply::Done);
    assert_eq!(rig.refusal(&follow(0, FOLLOWING)), Refusal::DrivesOff);
}

/// Towards the end of the travel at 100 mm the axis stops before it, with the fault of a soft limit.
#[test]
fn it_does_not_leave_the_travel() {
    let mut rig = rig();
    let fast = FollowSettings { distance_m: 50e-3, ..FOLLOWING };
    assert_eq!(rig.request(&follow(0, fast)), Reply::Done);
    let end = Position::from_m(0.1).unwrap();
    for _ in 0..16_000 {
        turn(&mut rig, 1, true);
        assert!(axis(&rig, 0).command <= end);
        if rig.drive.machine().power() != Power::On {
            break;
        }
    }
    rig.run(TICK_HZ / 2);
    let fault = Fault::Axis { axis: 0, kind: FaultKind::SoftLimit };
    assert_eq!(rig.status().power, Power::Faulted(fault));
    let status = axis(&rig, 0);
    // 50 mm/s: 12.5 µm in a position tick; then the command is where the axis stands without force.
    let left_m = 0.1 - status.command.to_m();
    assert!((-0.3e-3..0.6e-3).contains(&left_m), "{left_m} m");
}

#[test]
fn what_cannot_be_followed_is_refused_by_name() {
    let mut rig = Rig::new();
    rig.plant.counters = [Some(0), None];
    rig.run(1);
    assert_eq!(rig.refusal(&follow(0, FOLLOWING)), Refusal::DrivesOff);
    rig.enable();
    assert_eq!(rig.refusal(&follow(2, FOLLOWING)), Refusal::NoSuchAxis);
    // A scale is at the input of y, and there is no third one.
    for input in [1, 2, 255] {
        let refusal = rig.refusal(&follow(0, FollowSettings { input, ..FOLLOWING }));
        assert_eq!(refusal, Refusal::Follow(FollowError::NoCounter), "{input}");
    }
    let limit_m_per_s = 0.9 * settings().axes[0].fastest_m_per_s.unwrap();
    let fast = |speed_m_per_s| follow(1, FollowSettings { speed_m_per_s, ..FOLLOWING });
    let too_fast = Refusal::TooFast { block: 0, axis: 1, limit_m_per_s };
    assert_eq!(rig.refusal(&fast(1.001 * limit_m_per_s)), too_fast);
    let ratio = follow(0, FollowSettings { counts: 0, ..FOLLOWING });
    assert_eq!(rig.refusal(&ratio), Refusal::Follow(FollowError::Ratio));
    assert_eq!(rig.request(&jog_by(0.01)), Reply::Done);
    assert_eq!(rig.refusal(&follow(0, FOLLOWING)), Refusal::Moving);
    rig.run(TICK_HZ);
    rig.drive.machine_mut().lose_reference(0);
    let not_homed = Refusal::Follow(FollowError::Path(PathError::NotHomed { axis: 0 }));
    assert_eq!(rig.refusal(&follow(0, FOLLOWING)), not_homed);
    // Nothing was changed by any of them.
    assert_eq!(rig.request(&fast(limit_m_per_s)), Reply::Done);
}
