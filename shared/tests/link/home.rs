//! A homing by a host.

use shared::homing::{AtLimit, Direction, HomingSettings, Mark};
use shared::link::message::{Reply, Request};
use shared::link::report::{Activity, HomingReport};
use shared::link::{Identity, Refusal};
use shared::safety::{Fault, Power};

use super::rig::{IDENTITY, Rig, settings};

const HOMING: HomingSettings = HomingSettings {
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
    let mut rig = Rig::of(Identity { homing: [Some(HOMING), None], ..IDENTITY }, settings());
    rig.bench.home_switch_m = Some([-0.020, -0.015]);
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
    let true_m = rig.bench.position_m[0] + 0.015 + HOMING.mark_position_m;
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
    assert!(!rig.bench.enabled);
    assert_eq!(rig.status().power, Power::Faulted(Fault::Overrun));
}
