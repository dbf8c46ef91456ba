//! The direction check over the link: it needs the enable switch, and leaves the drives off.

use shared::drive::NotArmed;
use shared::drive::direction_check::{DirectionCheckSettings, DirectionResult};
use shared::link::Refusal;
use shared::link::message::{Reply, Request};
use shared::link::refusal::DirectionProblem;
use shared::link::report::DirectionReport;
use shared::safety::Power;

use super::rig::{Rig, TICK_HZ, TIMES};

const SETTINGS: DirectionCheckSettings =
    DirectionCheckSettings { force_n: 40.0, time_s: 0.2, detect_m: 1e-4 };

fn check(axis: u8, settings: DirectionCheckSettings) -> Request {
    Request::CheckDirection { axis, settings }
}

fn stands(rig: &Rig) -> bool {
    rig.plant.position_m.iter().all(|m| m.abs() < 1e-12)
}

/// 40 N against 20 N of friction accelerate 15 kg by 1.33 m/s² over 0.1 mm; friction decelerates them as much over another 0.1 mm.
/// The check moves nothing before the switch is closed, and the closing does not permit an enable.
#[test]
fn the_axis_is_pushed_when_the_switch_closes() {
    let mut rig = Rig::new();
    assert_eq!(rig.request(&check(0, SETTINGS)), Reply::Done);
    rig.run(2000);
    assert_eq!(rig.status().direction, DirectionReport::Running { axis: 0 });
    assert!(stands(&rig));
    rig.close_switch();
    rig.run(5000);
    let status = rig.status();
    assert_eq!(status.direction, DirectionReport::Ended { axis: 0, result: DirectionResult::Ok });
    let [x_m, y_m] = rig.plant.position_m;
    assert!((1.9e-4..2.2e-4).contains(&x_m) && y_m.abs() < 1e-12, "{x_m} {y_m}");
    assert_eq!((status.power, status.not_armed), (Power::Off, Some(NotArmed::Switch)));
    assert_eq!(rig.refusal(&Request::Enable), Refusal::NotArmed(NotArmed::Switch));
    rig.close_switch();
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
}

/// A check that waits ends when its host has been silent for the time after which drives go off. The switch is closed 1000 ticks after the
/// silence and settles in 400: a push that ends before that time is done, one that would begin 10 ticks after it is not, nor one after ten
/// minutes.
#[test]
fn a_check_that_waits_expires_with_the_silence_of_its_host() {
    let ticks = u32::from(TIMES.off_ms) * TICK_HZ / 1000;
    for (silent, pushed) in
        [(ticks / 2, true), (ticks - 2000, true), (ticks - 1390, false), (600 * TICK_HZ, false)]
    {
        let mut rig = Rig::new();
        assert_eq!(rig.request(&check(0, SETTINGS)), Reply::Done);
        rig.run(silent);
        rig.close_switch();
        rig.run(5000);
        assert_eq!(stands(&rig), !pushed, "after {silent} ticks");
        let result = if pushed { DirectionResult::Ok } else { DirectionResult::Expired };
        assert_eq!(rig.status().direction, DirectionReport::Ended { axis: 0, result });
    }
}

/// A host that asks keeps the check; another session ends it.
#[test]
fn a_check_that_waits_lives_as_long_as_its_session() {
    let mut rig = Rig::new();
    assert_eq!(rig.request(&check(0, SETTINGS)), Reply::Done);
    for _ in 0..30 {
        rig.run(u32::from(TIMES.off_ms) * TICK_HZ / 2000);
        assert_eq!(rig.status().direction, DirectionReport::Running { axis: 0 });
    }
    rig.hello(4711);
    let ended = DirectionReport::Ended { axis: 0, result: DirectionResult::Expired };
    assert_eq!(rig.status().direction, ended);
    rig.close_switch();
    rig.run(5000);
    assert!(stands(&rig));
    assert_eq!(rig.status().direction, ended);
}

/// 10 N do not overcome 20 N of friction.
#[test]
fn a_force_below_the_friction_moves_nothing() {
    let mut rig = Rig::new();
    assert_eq!(rig.request(&check(1, DirectionCheckSettings { force_n: 10.0, ..SETTINGS })), Reply::Done);
    rig.close_switch();
    rig.run(5000);
    assert_eq!(rig.status().direction, DirectionReport::Ended { axis: 1, result: DirectionResult::NoMotion });
    assert!(stands(&rig));
}

#[test]
fn a_stop_ends_a_check_that_waits() {
    let mut rig = Rig::new();
    assert_eq!(rig.request(&check(0, SETTINGS)), Reply::Done);
    assert_eq!(rig.request(&Request::Stop), Reply::Done);
    rig.close_switch();
    rig.run(5000);
    assert_eq!(rig.status().direction, DirectionReport::Ended { axis: 0, result: DirectionResult::Aborted });
    assert!(stands(&rig));
}

#[test]
fn what_cannot_be_checked_is_refused_by_name() {
    let mut rig = Rig::new();
    let refused = |problem| Refusal::Direction(problem);
    let force = |force_n| DirectionCheckSettings { force_n, ..SETTINGS };
    for force_n in [0.0, -40.0, 200.1, f64::NAN] {
        assert_eq!(rig.refusal(&check(0, force(force_n))), refused(DirectionProblem::Force), "{force_n}");
    }
    let long = DirectionCheckSettings { time_s: 1.1, ..SETTINGS };
    assert_eq!(rig.refusal(&check(0, long)), refused(DirectionProblem::Setting));
    assert_eq!(rig.refusal(&check(2, SETTINGS)), Refusal::NoSuchAxis);
    assert_eq!(rig.status().direction, DirectionReport::None);
    let mut on = Rig::enabled();
    assert_eq!(on.refusal(&check(0, SETTINGS)), refused(DirectionProblem::NotReady));
    assert_eq!(on.status().power, Power::On);
}
