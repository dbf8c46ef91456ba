//! A homing by a host.

use shared::homing::{AtLimit, Direction, HomingSettings, Mark};
use shared::interpolate::block::Shape;
use shared::link::message::{Reply, Request};
use shared::link::report::{Activity, HomingFailure, HomingReport};
use shared::link::{Identity, Refusal};
use shared::safety::{Fault, FaultKind, Power};

use super::rig::{IDENTITY, Rig, settings};

pub const HOMING: HomingSettings = HomingSettings {
    direction: Direction::Negative,
    mark: Mark::SwitchEdge,
    mark_position_m: 0.001,
    search_speed_m_per_s: 0.03,
    approach_speed_m_per_s: 0.002,
    acceleration_m_per_s2: 0.5,
    search_distance_m: 0.1,
    back_off_distance_m: 0.01,
    at_limit: AtLimit::TurnRound,
    timeout_s: 30.0,
};

/// X has a home switch at −20 to −15 mm; y has none.
fn rig() -> Rig {
    let mut rig = Rig::of(&Identity { homing: [Some(HOMING), None], ..IDENTITY }, settings());
    rig.plant.home_switch_m = Some([-0.020, -0.015]);
    rig
}

/// The search, the way back and the approach are planned one after the other while the host asks for the status. The edge is the
/// mark, found within a tick of the approach (0.1 µm) and a count (50 nm) of the reading.
#[test]
fn an_axis_is_homed_by_a_request() {
    let mut rig = rig();
    assert_eq!(rig.status().homing, HomingReport::None);
    rig.enable();
    assert_eq!(rig.request(&Request::Home { axis: 0 }), Reply::Done);
    let mut seconds = 0;
    loop {
        let status = rig.status();
        if status.homing != HomingReport::Running {
            break;
        }
        assert_eq!((status.activity, status.axes[0].homed), (Activity::Homing, false));
        // Also between two legs, where the axis stands.
        assert_eq!(rig.refusal(&Request::NewMotion), Refusal::Moving);
        rig.run(2000);
        seconds += 1;
        assert!(seconds < 200, "the homing does not end");
    }
    rig.run(2000);
    let status = rig.status();
    assert_eq!((status.homing, status.power), (HomingReport::Homed, Power::On));
    assert_eq!((status.activity, status.axes[0].homed), (Activity::Idle, true));
    let true_m = rig.plant.position_m[0] + 0.015 + HOMING.mark_position_m;
    let read_m = status.axes[0].motor.to_m();
    assert!((read_m - true_m).abs() < 0.16e-6, "{read_m} m, {true_m} m");
}

#[test]
fn a_homing_is_refused_where_there_is_none() {
    let mut rig = rig();
    assert_eq!(rig.refusal(&Request::Home { axis: 0 }), Refusal::DrivesOff);
    rig.enable();
    assert_eq!(rig.refusal(&Request::Home { axis: 1 }), Refusal::NotAvailable);
    assert_eq!(rig.refusal(&Request::Home { axis: 2 }), Refusal::NoSuchAxis);
    assert_eq!(rig.status().homing, HomingReport::None);
}

/// A fault that the board has found itself stops the drives as any other.
#[test]
fn a_fault_of_the_board_switches_the_drives_off() {
    let mut rig = rig();
    rig.enable();
    rig.drive.fault(Fault::Overrun);
    rig.run(1);
    assert!(!rig.plant.enabled);
    assert_eq!(rig.status().power, Power::Faulted(Fault::Overrun));
}

/// Without the stop the axis would go on for 0.5 s to its switch at 15 mm. From 30 mm/s it stands after 15 ms and 0.225 mm, and no further
/// leg follows.
#[test]
fn a_stop_ends_a_homing() {
    let mut rig = rig();
    rig.enable();
    assert_eq!(rig.request(&Request::Home { axis: 0 }), Reply::Done);
    rig.run(4000);
    let before_m = rig.drive.machine().command()[0].to_m();
    assert!((-0.006..-0.004).contains(&before_m), "{before_m}");
    assert_eq!(rig.request(&Request::Stop), Reply::Done);
    rig.run(400);
    let status = rig.status();
    assert_eq!(status.homing, HomingReport::Failed(HomingFailure::Stopped));
    assert_eq!((status.activity, status.at_rest, status.power), (Activity::Idle, true, Power::On));
    let stopped_m = status.axes[0].command.to_m();
    assert!((0.15e-3..0.4e-3).contains(&(before_m - stopped_m)), "{before_m} {stopped_m}");
    rig.run(20_000);
    let after = rig.status();
    assert_eq!(after.axes[0].command, status.axes[0].command);
    assert!(!after.axes[0].homed);
}

/// A homing reacts to the limit switches of its own axis. Another axis that moves onto one meanwhile stops the path.
#[test]
fn a_limit_switch_of_another_axis_stops_a_homing() {
    for (other_limits, expected) in [
        ([false, false], Power::On),
        ([true, false], Power::On),
        ([false, true], Power::Faulted(Fault::Axis { axis: 1, kind: FaultKind::LimitSwitch })),
    ] {
        let mut rig = rig();
        rig.enable();
        rig.drive.home(0, &HOMING).unwrap();
        rig.drive.tick(&mut rig.plant);
        // The first leg, in which y moves in the positive direction, too.
        let mut leg = rig.drive.leg().unwrap();
        let Shape::Line { to_m: [_, y_m] } = &mut leg.shape else { panic!("{leg:?}") };
        *y_m += 5e-3;
        let planned = rig.drive.machine_mut().jog(&leg);
        assert_eq!(planned, Ok(()));
        rig.drive.leg_planned(planned);
        rig.run(2000);
        assert_eq!(rig.status().homing, HomingReport::Running);
        rig.plant.limits[1] = other_limits;
        rig.run(1000);
        assert_eq!(rig.status().power, expected, "{other_limits:?}");
    }
}
