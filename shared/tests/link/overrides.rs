//! The feed override by a host, or by somebody beside it: how far it goes, and when it ends.

use shared::interpolate::Block;
use shared::interpolate::feed_hold::FeedState;
use shared::link::feed_override::FeedOverride;
use shared::link::message::{Jog, Reply, Request};
use shared::link::packet::Header;
use shared::link::report::{Activity, HomingReport};
use shared::link::{Identity, Refusal};
use shared::safety::Fault;
use shared::units::Position;

use super::home::HOMING;
use super::rig::{IDENTITY, Rig, settings};
use super::start;

/// Ticks in which the override changes by 100 %: 120 mm/s at 2 m/s² are 60 ms, with a margin.
const CHANGE_TICKS: u32 = 1300;

const fn to(percent: u8) -> Request {
    Request::Override { percent }
}

/// A jog of x by 80 mm.
fn jog(velocity_m_per_s: f64, acceleration_m_per_s2: f64) -> Request {
    Request::Jog(Jog { axis: 0, distance_m: Some(0.08), velocity_m_per_s, acceleration_m_per_s2 })
}

/// Runs for a time of at most 0.4 s. Returns the greatest speed of the commands of either axis, m/s.
fn speed_in(rig: &mut Rig, ticks: u32) -> f64 {
    let at = |rig: &Rig| rig.drive.machine().command().map(Position::to_m);
    let mut most = 0f64;
    for _ in 0..ticks / 5 {
        let before = at(rig);
        rig.run(5);
        let moved = at(rig).into_iter().zip(before).map(|(after, before)| (after - before).abs());
        most = moved.fold(most, |most, moved| most.max(moved * 4000.0));
    }
    most
}

/// Sends a request without a session.
fn guest(rig: &mut Rig, request: &Request) -> Reply {
    rig.send(Header::without_session(41), request)
}

fn is_close(found: f64, expected: f64) -> bool {
    // Commands have steps of 1/1024 nm: 4 nm/s.
    (found - expected).abs() < 1e-5 * expected + 1e-8
}

/// The host, and a guest without a session, change the speed of a jog; the status tells what was asked for and what there is.
#[test]
fn an_override_changes_the_speed_of_what_runs() {
    for by_guest in [false, true] {
        let mut rig = Rig::enabled();
        assert_eq!(rig.request(&jog(0.04, 0.5)), Reply::Done);
        speed_in(&mut rig, 2000);
        assert!(is_close(speed_in(&mut rig, 500), 0.04));
        for percent in [150, 30, 200, 100, 0] {
            let reply = if by_guest { guest(&mut rig, &to(percent)) } else { rig.request(&to(percent)) };
            assert_eq!(reply, Reply::Done);
            speed_in(&mut rig, CHANGE_TICKS);
            let status = rig.status();
            let expected = FeedOverride { percent, most_percent: 200 };
            assert_eq!((status.feed_override, status.rate_percent), (expected, percent));
            assert_eq!((status.activity, status.feed), (Activity::Jog, FeedState::Running));
            assert!(is_close(speed_in(&mut rig, 500), 0.04 * f64::from(percent) / 100.0), "{percent}");
        }
    }
}

/// Of an axis that may do 0.9·150 mm/s and stops with 2 m/s², the override is limited: to 135/v, and to √(2/a); never below 100 %. It may
/// be asked for nevertheless.
#[test]
fn an_override_is_limited_by_the_speed_and_the_acceleration_of_the_axes() {
    for (speed, acceleration, limit, expected) in [
        (0.04, 0.5, 200, 0.08),
        (0.1, 0.5, 135, 0.135),
        (0.135, 0.5, 100, 0.135),
        (0.04, 1.0, 141, 0.0564),
        (0.04, 2.0, 100, 0.04),
        (0.04, 4.0, 100, 0.04),
    ] {
        let mut rig = Rig::enabled();
        assert_eq!(rig.request(&jog(speed, acceleration)), Reply::Done);
        rig.run(100);
        assert_eq!(rig.request(&to(200)), Reply::Done);
        let most = speed_in(&mut rig, 7000);
        assert_eq!(rig.status().feed_override, FeedOverride { percent: 200, most_percent: limit });
        assert!(is_close(most, expected), "{speed} {acceleration}: {most}");
    }
}

/// The slowest permitted block of a motion limits all of it; a dwell limits nothing, and the next motion has its own limit, with the
/// override of the session.
#[test]
fn a_motion_is_limited_by_its_strictest_block_and_the_override_remains_for_the_next_one() {
    let mut rig = Rig::enabled();
    let slow = Block::line([0.004, 0.0], 0.05, 0.5);
    let fast = Block::line([0.014, 0.0], 0.09, 0.5);
    start(&mut rig, &[slow, Block::dwell(0.01), fast]);
    rig.run(10);
    assert_eq!(rig.request(&to(180)), Reply::Done);
    rig.run(1);
    // 135/90.
    assert_eq!(rig.status().feed_override, FeedOverride { percent: 180, most_percent: 150 });
    let most = speed_in(&mut rig, 8000);
    assert!(most > 0.05 && most < 0.135 * (1.0 + 1e-5), "{most}");
    for _ in 0..10 {
        rig.status();
        rig.run(2000);
    }
    assert_eq!(rig.status().activity, Activity::Idle);
    start(&mut rig, &[Block::line([0.0, 0.0], 0.02, 0.5)]);
    assert!(is_close(speed_in(&mut rig, 4000), 0.036));
    assert_eq!(rig.status().feed_override, FeedOverride { percent: 180, most_percent: 200 });
}

#[test]
fn an_override_is_refused_by_name_and_changes_nothing() {
    let mut rig = Rig::new();
    assert_eq!(rig.refusal(&to(50)), Refusal::NothingMoves);
    rig.enable();
    assert_eq!(rig.refusal(&to(50)), Refusal::NothingMoves);
    assert_eq!(guest(&mut rig, &to(50)), Reply::Refused(Refusal::NothingMoves));
    assert_eq!(rig.request(&jog(0.04, 0.5)), Reply::Done);
    rig.run(2000);
    assert_eq!(rig.refusal(&to(201)), Refusal::Override { max: 200 });
    assert_eq!(guest(&mut rig, &to(255)), Reply::Refused(Refusal::Override { max: 200 }));
    // Of an earlier session.
    let stale = Header { session: rig.session ^ 1, sequence: 9 };
    assert_eq!(rig.send(stale, &to(50)), Reply::Refused(Refusal::Session));
    assert!(is_close(speed_in(&mut rig, 1000), 0.04));
    assert_eq!(rig.status().feed_override, FeedOverride::NONE);
}

/// A hold and a resume keep the override; an override that is set meanwhile takes effect with the resume.
#[test]
fn a_held_path_continues_at_its_override() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&jog(0.04, 0.5)), Reply::Done);
    rig.run(2000);
    assert_eq!(rig.request(&to(150)), Reply::Done);
    rig.run(CHANGE_TICKS);
    assert_eq!(rig.request(&Request::Hold), Reply::Done);
    rig.run(CHANGE_TICKS);
    let status = rig.status();
    assert_eq!((status.feed, status.rate_percent, status.feed_override.percent), (FeedState::Held, 0, 150));
    assert_eq!(rig.request(&Request::Resume), Reply::Done);
    speed_in(&mut rig, CHANGE_TICKS);
    assert!(is_close(speed_in(&mut rig, 500), 0.06));
    assert_eq!(rig.request(&Request::Hold), Reply::Done);
    rig.run(CHANGE_TICKS);
    assert_eq!(guest(&mut rig, &to(20)), Reply::Done);
    assert!(speed_in(&mut rig, 500) < 1e-12);
    assert_eq!(rig.request(&Request::Resume), Reply::Done);
    speed_in(&mut rig, CHANGE_TICKS);
    assert!(is_close(speed_in(&mut rig, 500), 0.008));
}

/// What ends an override: a stop, a disable, an open switch, a fault, another session. The next jog runs as planned.
#[test]
fn an_override_ends_with_the_motion_that_is_stopped_with_the_drives_and_with_the_session() {
    let ends: [fn(&mut Rig); 5] = [
        |rig| assert_eq!(rig.request(&Request::Stop), Reply::Done),
        |rig| assert_eq!(rig.request(&Request::Disable), Reply::Done),
        |rig| rig.plant.switch_closed = false,
        |rig| rig.drive.fault(Fault::BusOvervoltage),
        |rig| rig.hello(2),
    ];
    for (number, end) in ends.into_iter().enumerate() {
        let mut rig = Rig::enabled();
        assert_eq!(rig.request(&jog(0.04, 0.5)), Reply::Done);
        rig.run(2000);
        assert_eq!(rig.request(&to(30)), Reply::Done);
        rig.run(CHANGE_TICKS);
        assert_eq!(rig.status().feed_override.percent, 30);
        end(&mut rig);
        rig.run(CHANGE_TICKS);
        assert_eq!(rig.status().feed_override.percent, 100, "{number}");
        if number == 4 {
            // The motion of the previous session goes on as planned.
            assert!(is_close(speed_in(&mut rig, 500), 0.04));
            assert_eq!(rig.request(&Request::Stop), Reply::Done);
            rig.run(CHANGE_TICKS);
        }
        rig.request(&Request::Clear);
        if !rig.status().power.is_on() {
            rig.enable();
        }
        assert_eq!(rig.request(&jog(0.04, 0.5)), Reply::Done, "{number}");
        speed_in(&mut rig, 2000);
        assert!(is_close(speed_in(&mut rig, 500), 0.04), "{number}");
    }
}

/// An override by a guest is no sign of life of the host: the path is held 0.5 s after the last request of the session.
#[test]
fn an_override_by_a_guest_is_no_sign_of_life() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&jog(0.02, 0.5)), Reply::Done);
    for _ in 0..11 {
        rig.run(1000);
        assert_eq!(guest(&mut rig, &to(90)), Reply::Done);
    }
    assert!(matches!(rig.drive.machine().feed_state(), FeedState::Holding | FeedState::Held));
}

/// A homing may be slowed down, and not accelerated: its speeds are those at which it finds its mark.
#[test]
fn a_homing_is_not_faster_than_declared() {
    let mut rig = Rig::of(&Identity { homing: [Some(HOMING), None], ..IDENTITY }, settings());
    rig.plant.home_switch_m = Some([-0.080, -0.070]);
    rig.enable();
    assert_eq!(rig.request(&Request::Home { axis: 0 }), Reply::Done);
    rig.run(2000);
    assert_eq!(rig.request(&to(200)), Reply::Done);
    assert!(is_close(speed_in(&mut rig, 4000), 0.03));
    assert_eq!(rig.request(&to(50)), Reply::Done);
    rig.run(CHANGE_TICKS);
    assert!(is_close(speed_in(&mut rig, 1000), 0.015));
    assert_eq!(rig.status().homing, HomingReport::Running);
}
