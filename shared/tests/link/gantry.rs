//! A gantry by a host: x and y are its motors.

use shared::config::{ConfigError, GantrySettings};
use shared::drive::direction_check::DirectionCheckSettings;
use shared::homing::HardStopSettings;
use shared::interpolate::{Block, PathError};
use shared::link::message::{BoardSettings, Jog, Reply, Request};
use shared::link::refusal::DirectionProblem;
use shared::link::report::{HomingFailure, HomingReport};
use shared::link::{Envelope, Identity, Refusal};
use shared::machine::MachineError;
use shared::probing::ProbeSettings;
use shared::safety::{Fault, FaultKind, Power};
use shared::units::{PER_NM, Position};

use super::following::FOLLOWING;
use super::home::HOMING;
use super::rig::{ENVELOPE, IDENTITY, Rig, settings};
use super::{jog_by, start};

const GANTRY: GantrySettings = GantrySettings { first: 0, skew_limit_m: 0.2e-3, reference_offset_m: 0.0 };

fn pair() -> BoardSettings<2> {
    let mut settings = settings();
    settings.axes[1].gantry = Some(GANTRY);
    settings
}

fn rig() -> Rig {
    let mut rig = Rig::of(&Identity { homing: [Some(HOMING); 2], ..IDENTITY }, pair());
    rig.enable();
    rig
}

fn jog(axis: u8, distance_m: Option<f64>) -> Request {
    Request::Jog(Jog { axis, distance_m, velocity_m_per_s: 0.03, acceleration_m_per_s2: 0.5 })
}

/// Each request that would command y by itself is refused by its name, with the drives on and the axes at rest: nothing moves, nothing
/// starts, and x is moved afterwards as ever, with y.
#[test]
fn the_second_motor_takes_no_command_of_its_own() {
    let mut rig = rig();
    let before = rig.axes();
    let stop = HardStopSettings {
        force_n: -60.0,
        speed_m_per_s: 0.002,
        acceleration_m_per_s2: 0.5,
        standstill_s: 0.05,
        search_distance_m: 0.05,
        back_off_distance_m: 0.001,
        stop_position_m: 0.0,
    };
    let probe = ProbeSettings {
        distance_m: -0.01,
        speed_m_per_s: 0.002,
        acceleration_m_per_s2: 0.5,
        retracts: false,
    };
    for request in [
        jog(1, Some(0.001)),
        jog(1, None),
        Request::Home { axis: 1 },
        Request::HomeToStop { axis: 1, settings: stop },
        Request::Probe { axis: 1, settings: probe },
        Request::Follow { axis: 1, settings: FOLLOWING },
    ] {
        assert_eq!(rig.refusal(&request), Refusal::SecondMotor { axis: 1, first: 0 }, "{request:?}");
    }
    // x has a command of its own, but not for a hard stop.
    let refusal = rig.refusal(&Request::HomeToStop { axis: 0, settings: stop });
    assert_eq!(refusal, Refusal::Homing(HomingFailure::Gantry));
    assert_eq!(rig.request(&Request::NewMotion), Reply::Done);
    let refusal = rig.refusal(&Request::add_block(Block::line([0.001, 0.001], 0.03, 0.5)));
    assert_eq!(refusal, Refusal::Path { block: 0, error: PathError::SecondMotor { axis: 1 } });
    let after = rig.axes();
    assert_eq!(after.map(|axis| axis.command), before.map(|axis| axis.command));
    assert!(rig.status().at_rest && rig.status().homing == HomingReport::None);
    start(&mut rig, &[Block::line([0.001, 0.0], 0.03, 0.5)]);
    rig.run(10_000);
    let mm = |axis: usize, rig: &Rig| 1e3 * rig.axes()[axis].command.to_m();
    assert!((mm(0, &rig) - 1.0).abs() < 1e-9 && rig.axes()[0].command == rig.axes()[1].command);
    assert_eq!(rig.request(&jog_by(0.002)), Reply::Done);
    rig.run(10_000);
    assert!((mm(0, &rig) - 3.0).abs() < 1e-6 && rig.axes()[0].command == rig.axes()[1].command);
    assert!((1e3 * rig.plant.position_m[1] - 3.0).abs() < 0.3, "{} m", rig.plant.position_m[1]);
}

/// With the drives off the direction of neither motor is checked, as the other one stands.
#[test]
fn the_direction_of_a_motor_of_a_gantry_is_not_checked() {
    let mut rig = rig();
    assert_eq!(rig.request(&Request::Disable), Reply::Done);
    rig.run(10);
    let settings = DirectionCheckSettings { force_n: 30.0, time_s: 0.2, detect_m: 1e-4 };
    for axis in [0, 1] {
        let refusal = rig.refusal(&Request::CheckDirection { axis, settings });
        assert_eq!(refusal, Refusal::Direction(DirectionProblem::Gantry));
    }
    assert!(!rig.drive.is_checking());
}

/// Two masses that nothing couples: y is held in motion, and x goes on until the skew is 0.2 mm. Both are off, with the fault of y, and a jog is refused
/// until it is acknowledged.
#[test]
fn skew_is_a_fault_of_the_second_motor_and_told_in_the_status() {
    let mut rig = rig();
    let gantry = |rig: &Rig| rig.axes().map(|axis| axis.gantry);
    assert_eq!(gantry(&rig)[0], None);
    assert_eq!(gantry(&rig)[1].map(|gantry| gantry.first), Some(0));
    assert_eq!(rig.request(&jog_by(0.01)), Reply::Done);
    rig.run(4000);
    let held_m = rig.plant.position_m[1];
    while rig.drive.machine().power().is_on() {
        rig.run(1);
        rig.drive.heard();
        rig.plant.position_m[1] = held_m;
    }
    // As it was read in that tick: within a position tick at 30 mm/s and the speed at which y is pushed, and two counts.
    let read_m = Position(gantry(&rig)[1].unwrap().skew).to_m();
    assert!((-0.2e-3 - 10e-6..-0.2e-3).contains(&read_m), "{read_m} m");
    let apart_m = rig.plant.position_m[0] - held_m;
    assert!((0.2e-3..0.2e-3 + 30e-6).contains(&apart_m), "{apart_m} m");
    let skew = Fault::Axis { axis: 1, kind: FaultKind::GantrySkew };
    assert_eq!(rig.status().power, Power::Faulted(skew));
    assert!([0, 1].iter().all(|axis| rig.plant.force_n(*axis).abs() == 0.0));
    assert_eq!(rig.refusal(&jog_by(0.001)), Refusal::Faulted(skew));
}

/// Settings with a gantry are refused beyond the envelope and for a first motor that is none; the previous ones remain.
#[test]
fn a_gantry_is_within_the_envelope() {
    let with = |gantry| {
        let mut settings = settings();
        settings.axes[1].gantry = Some(gantry);
        settings
    };
    let ceiling = ENVELOPE.axes[1].gantry_skew_limit_m.unwrap();
    assert!(ENVELOPE.admit(with(GantrySettings { skew_limit_m: ceiling, ..GANTRY })).is_ok());
    let value = ceiling + 1e-6;
    let name = "gantry.skew_limit_m";
    let error = ENVELOPE.admit(with(GantrySettings { skew_limit_m: value, ..GANTRY })).unwrap_err();
    assert_eq!(
        error,
        MachineError::Config { axis: 1, error: ConfigError::AboveCeiling { name, value, ceiling } }
    );
    let mut axes = ENVELOPE.axes;
    axes[1].gantry_skew_limit_m = None;
    let error = Envelope { axes, ..ENVELOPE }.admit(with(GANTRY)).unwrap_err();
    assert_eq!(error, MachineError::Config { axis: 1, error: ConfigError::NoGantry("gantry") });
}

/// Both motors of a beam are homed by a request for x; while one is not, neither is. The two switches are 0.1 mm apart.
#[test]
fn both_motors_are_homed_by_one_request() {
    let mut rig = rig();
    rig.plant.home_switch_m = Some([-0.020, -0.015]);
    rig.plant.second_switch_m = Some([-0.0201, -0.0151]);
    let homed = |rig: &Rig| rig.axes().map(|axis| axis.homed);
    rig.drive.machine_mut().lose_reference(1);
    assert_eq!(homed(&rig), [false; 2]);
    assert_eq!(rig.request(&Request::Home { axis: 0 }), Reply::Done);
    while rig.status().homing == HomingReport::Running {
        assert_eq!(homed(&rig), [false; 2]);
        rig.run(1000);
    }
    assert_eq!((rig.status().homing, homed(&rig)), (HomingReport::Homed, [true; 2]));
    rig.run(20_000);
    let [x, y] = rig.axes();
    assert_eq!(x.command, y.command);
    // y is 0.1 mm behind x where the readings are equal, within two ticks of the approach, two counts and what friction leaves.
    let apart_m = rig.plant.position_m[0] - rig.plant.position_m[1];
    assert!((apart_m - 0.1e-3).abs() < 2e-6, "{apart_m} m");
    assert!((y.motor - x.motor).abs() < 2000 * PER_NM && x.motor != Position(0));
}
