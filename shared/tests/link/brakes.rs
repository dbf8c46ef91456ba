//! A machine with a brake under the control of a host.

use shared::config::{AxisSettings, Brake};
use shared::drive::direction_check::DirectionCheckSettings;
use shared::link::history::HistoryEvent;
use shared::link::message::{Reply, Request};
use shared::link::refusal::DirectionProblem;
use shared::link::report::{Activity, DirectionReport};
use shared::link::{Refusal, message::BoardSettings};
use shared::safety::{Fault, Power};

use super::jog_by;
use super::rig::{IDENTITY, Rig, TICK_HZ, TIMES, settings};

/// 50 ms and 30 ms, ticks.
const RELEASE: u32 = 1000;
const ENGAGE: u32 = 600;

/// y has a brake.
fn braked() -> BoardSettings<2> {
    let mut settings = settings();
    let brake = Some(Brake { release_s: 0.05, engage_s: 0.03 });
    settings.axes[1] = AxisSettings { brake, preload_n: Some(30.0), ..settings.axes[1] };
    settings
}

fn enabled() -> Rig {
    let mut rig = Rig::of(&IDENTITY, braked());
    rig.close_switch();
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
    rig
}

/// Runs until the stages are off. Returns the ticks.
fn ticks_until_off(rig: &mut Rig) -> u32 {
    (0..100_000)
        .find(|_| {
            rig.run(1);
            !rig.plant.enabled
        })
        .unwrap()
}

/// A motion is refused until the brakes are open, and after a disable until the drives are on again.
#[test]
fn a_motion_is_refused_while_the_brakes_move() {
    let mut rig = enabled();
    rig.run(RELEASE - 100);
    assert_eq!(rig.status().power, Power::Enabling);
    assert_eq!(rig.refusal(&jog_by(0.01)), Refusal::BrakesMove);
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
    rig.run(100);
    assert_eq!(rig.status().power, Power::On);
    assert_eq!(rig.request(&jog_by(0.001)), Reply::Done);
    rig.run(10_000);
    assert_eq!(rig.request(&Request::Disable), Reply::Done);
    assert_eq!(rig.status().power, Power::Disabling(None));
    for request in [&Request::Enable, &jog_by(0.01)] {
        assert_eq!(rig.refusal(request), Refusal::BrakesMove);
    }
    assert_eq!(rig.refusal(&Request::Clear), Refusal::DrivesOn);
    rig.run(ENGAGE);
    assert_eq!((rig.status().power, rig.plant.enabled), (Power::Off, false));
}

/// A jog of 30 mm/s decelerates at 2 m/s² for 15 ms, 300 ticks; then the brakes need their time. The rest of the jog is gone.
#[test]
fn a_disable_during_a_jog_stops_it_before_the_brakes_close() {
    let mut rig = enabled();
    rig.run(RELEASE + 10);
    assert_eq!(rig.request(&jog_by(0.09)), Reply::Done);
    rig.run(8000);
    let moving = rig.drive.machine().command()[0];
    assert_eq!(rig.request(&Request::Disable), Reply::Done);
    while rig.drive.machine().are_brakes_open() {
        rig.run(1);
    }
    let way_m = (rig.drive.machine().command()[0] - moving).unsigned_abs() as f64 / shared::units::PER_M;
    // v²/(2a) = 0.225 mm, and up to two position ticks of 7.5 µm until the request is executed.
    assert!((0.22e-3..0.241e-3).contains(&way_m), "{way_m} m");
    assert_eq!(ticks_until_off(&mut rig) + 1, ENGAGE);
    assert_eq!((rig.status().power, rig.status().activity), (Power::Off, Activity::Idle));
}

/// The silence of the host closes the brakes of axes that stand, too, and is no fault.
#[test]
fn a_silent_host_leaves_closed_brakes() {
    let mut rig = enabled();
    rig.run(RELEASE + 10);
    assert_eq!(rig.status().power, Power::On);
    rig.run(u32::from(TIMES.off_ms) * TICK_HZ / 1000 - 10);
    assert_eq!(rig.drive.machine().power(), Power::On);
    rig.run(20);
    assert_eq!(rig.drive.machine().power(), Power::Disabling(None));
    assert!((ENGAGE - 20..ENGAGE).contains(&ticks_until_off(&mut rig)));
    let Reply::FaultHistory(history) = rig.request(&Request::FaultHistory) else { panic!("no history") };
    assert!(history.iter().map(|entry| entry.event).eq([HistoryEvent::HostSilentOff]), "{history:?}");
    assert_eq!(rig.status().power, Power::Off);
}

/// A path that was held when the host fell silent is a fault: it is told when the brakes have closed, and recorded once.
#[test]
fn a_silent_host_with_a_held_path_is_a_fault_behind_the_brakes() {
    let mut rig = enabled();
    rig.run(RELEASE + 10);
    assert_eq!(rig.request(&jog_by(0.09)), Reply::Done);
    rig.run(u32::from(TIMES.off_ms) * TICK_HZ / 1000 + 50);
    assert_eq!(rig.drive.machine().power(), Power::Disabling(Some(Fault::HostSilent)));
    assert!(rig.plant.enabled);
    rig.run(ENGAGE);
    assert_eq!(rig.drive.machine().power(), Power::Faulted(Fault::HostSilent));
    let Reply::FaultHistory(history) = rig.request(&Request::FaultHistory) else { panic!("no history") };
    let faults = history.iter().filter(|entry| entry.event == HistoryEvent::Fault(Fault::HostSilent));
    assert_eq!(faults.count(), 1);
}

/// With open loops the axis would fall as soon as its brake opens. The other axis can be checked, and the brake stays closed.
#[test]
fn the_direction_of_an_axis_with_a_brake_is_not_checked() {
    let mut rig = Rig::of(&IDENTITY, braked());
    let settings = DirectionCheckSettings { force_n: 40.0, time_s: 0.2, detect_m: 1e-4 };
    let check = |axis| Request::CheckDirection { axis, settings };
    assert_eq!(rig.refusal(&check(1)), Refusal::Direction(DirectionProblem::Brake));
    assert_eq!(rig.status().direction, DirectionReport::None);
    assert_eq!(rig.request(&check(0)), Reply::Done);
    rig.close_switch();
    rig.run(5000);
    assert!(!rig.drive.machine().are_brakes_open());
    assert!(matches!(rig.status().direction, DirectionReport::Ended { axis: 0, .. }));
}
