//! Homing on a simulated machine: origin, bumpless shift, and what is held off until an axis is homed.

mod origin;
pub mod test_board;

use shared::homing::{AtLimit, Direction, HomingError, HomingStatus, Mark};
use shared::interpolate::{Block, PathError};
use shared::machine::Reference;
use shared::safety::{Fault, FaultKind, Power};
use test_board::{SETTINGS, TestBoard, homing, run_homing};

/// From four places, on a machine with mass, friction and encoders: afterwards the reading of motor and scale is the place of the
/// axis in the coordinates of the mark, within a count (0.25 µm) and its quantisation.
#[test]
fn an_axis_is_homed_with_motor_and_scale_together() {
    for start_m in [0.02, 0.05, 0.10, 0.012] {
        let mut board = TestBoard::at(start_m);
        let mut system = TestBoard::system();
        board.enable(&mut system);
        assert_eq!(system.machine().reference(0), Some(Reference::Relative));
        assert_eq!(run_homing(&mut board, &mut system, &homing()), HomingStatus::Homed);
        assert_eq!(system.machine().reference(0), Some(Reference::Homed));
        let true_m = board.at_m - board.index_m + homing().mark_position_m;
        let [reading] = *system.readings();
        for read in [reading.motor, reading.table.unwrap()] {
            assert!((read.to_m() - true_m).abs() < 0.51e-6, "{} m, {true_m} m", read.to_m());
        }
        // The command is where the axis is: nothing has jumped, and the drives are on.
        assert!((system.machine().command()[0].to_m() - true_m).abs() < 20e-6);
        assert_eq!(system.machine().power(), Power::On);
    }
}

/// The readings at a pulse are latched from power-up on. Homed again, when the origin is no longer there, the axis reads the same place,
/// by the index of the motor and by that of the scale, each from a mark of its own.
#[test]
fn an_axis_is_homed_again_to_the_same_place() {
    for (mark, index) in [
        (homing().mark, (|board| board.index_m) as fn(&TestBoard) -> f64),
        (Mark::ScaleIndex { within_m: 0.01 }, |board| board.scale_index_m),
    ] {
        let mut board = TestBoard::at(0.05);
        let mut system = TestBoard::system();
        board.enable(&mut system);
        let settings = shared::homing::HomingSettings { mark, ..homing() };
        for time in 1..=3 {
            assert_eq!(run_homing(&mut board, &mut system, &settings), HomingStatus::Homed);
            let true_m = board.at_m - index(&board) + settings.mark_position_m;
            let [reading] = *system.readings();
            // A count of 0.25 µm for the reading and one for the latched pulse.
            for read in [reading.motor, reading.table.unwrap()] {
                assert!((read.to_m() - true_m).abs() < 0.51e-6, "{time}: {} m, {true_m} m", read.to_m());
            }
        }
    }
}

/// An axis with soft limits takes no block of a program before it is homed, and none beyond its travel afterwards.
#[test]
fn programs_are_refused_until_the_axis_is_homed() {
    let mut board = TestBoard::at(0.06);
    let mut system = TestBoard::system();
    board.enable(&mut system);
    let block = Block::line([0.01], 0.01, 1.0);
    assert_eq!(system.machine_mut().push(&block), Err(PathError::NotHomed { axis: 0 }));
    assert!(system.machine().is_at_rest());
    // A jog is allowed, further than the soft limits that do not apply yet.
    system.machine_mut().jog(&Block::line([0.001], 0.01, 1.0)).unwrap();
    board.run(&mut system, 8000);
    assert_eq!(run_homing(&mut board, &mut system, &homing()), HomingStatus::Homed);
    system.machine_mut().push(&block).unwrap();
    board.run(&mut system, 40_000);
    assert!((board.at_m - board.index_m + homing().mark_position_m - 0.01).abs() < 50e-6);
    let [_, max_m] = SETTINGS.travel_m.unwrap();
    let beyond = Block::line([max_m + 1e-6], 0.01, 1.0);
    assert_eq!(system.machine_mut().push(&beyond), Err(PathError::BeyondTravel { axis: 0 }));
    // A homing takes the reference away until it has ended.
    system.home(0, &homing()).unwrap();
    let block = Block::line([0.02], 0.01, 1.0);
    assert_eq!(system.machine_mut().push(&block), Err(PathError::NotHomed { axis: 0 }));
}

#[test]
fn homing_is_refused_while_something_moves_or_the_drives_are_off() {
    let mut board = TestBoard::at(0.06);
    let mut system = TestBoard::system();
    assert_eq!(system.home(0, &homing()), Err(HomingError::NotReady));
    board.enable(&mut system);
    assert_eq!(system.home(1, &homing()), Err(HomingError::NotReady));
    system.machine_mut().jog(&Block::line([0.01], 0.01, 1.0)).unwrap();
    assert_eq!(system.home(0, &homing()), Err(HomingError::NotReady));
    board.run(&mut system, 40_000);
    system.home(0, &homing()).unwrap();
    assert_eq!(system.home(0, &homing()), Err(HomingError::NotReady));
}

/// Stopped while it searches, the axis comes to rest with the drives on and stays relative; a second homing succeeds.
#[test]
fn a_stopped_homing_leaves_the_axis_at_rest_and_relative() {
    let mut board = TestBoard::at(0.09);
    let mut system = TestBoard::system();
    board.enable(&mut system);
    system.home(0, &homing()).unwrap();
    for _ in 0..4000 {
        board.run(&mut system, 1);
        system.plan_leg();
    }
    assert!(board.velocity.abs() > 0.01, "{}", board.velocity);
    system.stop_sequence();
    // 20 mm/s at 1 m/s²: 20 ms; the loop settles within 50 ms more. At rest an encoder count is 15 N in one tick: 50 µm/s.
    board.run(&mut system, 4000);
    assert!(board.velocity.abs() < 0.5e-3 && system.machine().is_at_rest(), "{}", board.velocity);
    assert_eq!(system.homing_status(), Some((0, HomingStatus::Failed(HomingError::Stopped))));
    assert_eq!(
        (system.machine().power(), system.machine().reference(0)),
        (Power::On, Some(Reference::Relative))
    );
    assert_eq!(run_homing(&mut board, &mut system, &homing()), HomingStatus::Homed);
}

/// Opening the enable switch ends a homing; nothing moves until it is started anew.
#[test]
fn drives_that_go_off_end_the_homing() {
    let mut board = TestBoard::at(0.09);
    let mut system = TestBoard::system();
    board.enable(&mut system);
    system.home(0, &homing()).unwrap();
    for _ in 0..4000 {
        board.run(&mut system, 1);
        system.plan_leg();
    }
    board.closed = false;
    board.run(&mut system, 2000);
    assert_eq!(system.homing_status(), Some((0, HomingStatus::Failed(HomingError::DrivesOff))));
    board.velocity = 0.0;
    board.enable(&mut system);
    let at_m = board.at_m;
    for _ in 0..4000 {
        board.run(&mut system, 1);
        system.plan_leg();
    }
    assert!((board.at_m - at_m).abs() < 1e-6, "{}", board.at_m - at_m);
}

/// During a homing a limit switch is a turning point; before and after it, motion onto it stops the path.
#[test]
fn a_limit_switch_is_a_fault_outside_of_a_homing_alone() {
    let mut board = TestBoard::at(0.012);
    let mut system = TestBoard::system();
    board.enable(&mut system);
    // Starts below the home switch, and turns round at the negative limit.
    let settings = shared::homing::HomingSettings { mark: Mark::SwitchEdge, ..homing() };
    assert_eq!((settings.direction, settings.at_limit), (Direction::Negative, AtLimit::TurnRound));
    assert_eq!(run_homing(&mut board, &mut system, &settings), HomingStatus::Homed);

    let mut board = TestBoard::at(0.012);
    let mut system = TestBoard::system();
    board.enable(&mut system);
    system.machine_mut().jog(&Block::line([-0.02], 0.01, 1.0)).unwrap();
    let fault = Fault::Axis { axis: 0, kind: FaultKind::LimitSwitch };
    let mut ticks = 0;
    while system.machine().power() == Power::On {
        board.run(&mut system, 1);
        ticks += 1;
        assert!(ticks < 20_000);
    }
    assert_eq!(system.machine().power(), Power::Stopping(fault));
    // At 10 mm/s with 1 m/s²: 50 µm to rest, and some for the lag of the axis.
    let at_switch_m = board.at_m;
    board.run(&mut system, 4000);
    assert_eq!(system.machine().power(), Power::Faulted(fault));
    assert!(at_switch_m - board.at_m < 0.5e-3, "{}", at_switch_m - board.at_m);
    // Further onto the switch is refused before it starts; the way back is open.
    board.velocity = 0.0;
    board.enable(&mut system);
    let [here] = system.machine().command();
    let further = Block::line([here.to_m() - 1e-3], 0.01, 1.0);
    assert_eq!(system.machine_mut().jog(&further), Err(PathError::LimitSwitch { axis: 0 }));
    system.machine_mut().jog(&Block::line([here.to_m() + 5e-3], 0.01, 1.0)).unwrap();
    board.run(&mut system, 20_000);
    assert_eq!(system.machine().power(), Power::On);
    assert!(board.at_m > at_switch_m + 4e-3);
}

/// The edge of the switch is the mark, in an approach of 1 µm in a tick: its place is that of the first sample on the switch, so that the reading r of
/// an axis at x is mark + x − edge + 0 … 1 µm, less or more by a count of 0.25 µm of each of both readings, and a twentieth for the ripple of
/// the speed; the same with a spike at the switch every 15 ms, on it and beside it.
#[test]
fn the_edge_of_the_switch_is_its_first_sample_and_no_spike() {
    const EDGE_M: f64 = 0.026;
    for spike_every in [0, 307] {
        for start_m in [0.05, 0.0503, 0.0507, 0.0601, 0.0702, 0.022] {
            let mut board = TestBoard::at(start_m);
            board.spike_every = spike_every;
            let mut system = TestBoard::system();
            board.enable(&mut system);
            let settings = shared::homing::HomingSettings {
                mark: Mark::SwitchEdge,
                approach_speed_m_per_s: 0.02,
                ..homing()
            };
            let ended = run_homing(&mut board, &mut system, &settings);
            assert_eq!(ended, HomingStatus::Homed, "from {start_m} m, spikes every {spike_every} samples");
            let true_m = board.at_m - EDGE_M + settings.mark_position_m;
            let [reading] = *system.readings();
            for read in [reading.motor, reading.table.unwrap()] {
                let beyond_um = 1e6 * (read.to_m() - true_m);
                assert!(
                    (-0.26..1.05 + 0.26).contains(&beyond_um),
                    "{start_m} m, {spike_every}: {beyond_um} µm"
                );
            }
        }
    }
}
