//! Each input reaches its axis and end, and each output is that of its axis: on the model, with the drives on.

use firmware::setup::{CAN_TO_BOARD, MotorSensor, TABLE};
use shared::link::can_frames::CanFrame;
use shared::link::{Reply, Request};
use shared::safety::{Fault, FaultKind, Power};
use shared::units::Position;

use super::board::{Board, CONTACTS, Port, SWITCH};
use super::model::{CAN, COUNTERS, GPIOA, GPIOC, GPIOD, TIM1, set_can_flags};
use shared::drive::Board as _;

/// Of the motor encoders of X and Y and of the scales, the flag of the index, and the offset of the captured count.
const INDEXES: [(u32, u32); 4] = [(1 << 3, 0x3c), (1 << 4, 0x40), (1 << 3, 0x3c), (1 << 3, 0x3c)];

fn status(board: &mut Board) -> Power {
    let Reply::Status(status) = board.ask(&Request::Status) else { panic!("no status") };
    status.power
}

/// Limit switches, drive faults, home switches, the signals of the scales, the probe and the stop: each contact alone.
#[test]
fn each_contact_is_its_own_input() {
    let mut board = Board::start(Port::Serial);
    let inputs = |board: &mut Board| {
        board.tick();
        board.parts.hardware.inputs()
    };
    let normal = inputs(&mut board);
    assert!(!normal.emergency_stop && !normal.probe_touched);
    assert!(normal.axes.iter().all(|axis| axis.limits == [false; 2] && !axis.drive_fault && !axis.home));
    for (bit, axis, end) in [(1, 0, 0), (5, 0, 1), (4, 1, 0), (13, 1, 1)] {
        board.set_contacts(CONTACTS & !(1 << bit));
        let mut expected = normal;
        expected.axes[axis].limits[end] = true;
        assert_eq!(format!("{:?}", inputs(&mut board)), format!("{expected:?}"), "PB{bit}");
    }
    for (bit, axis) in [(2, 0), (3, 1)] {
        board.set_contacts(CONTACTS & !(1 << bit));
        assert!(inputs(&mut board).axes[axis].drive_fault && !inputs(&mut board).axes[1 - axis].drive_fault);
    }
    board.set_contacts(CONTACTS & !(1 << 12));
    assert!(inputs(&mut board).emergency_stop);
    board.set_contacts(CONTACTS);
    for (bit, axis) in [(9, 0), (12, 1)] {
        board.set_homes(1 << bit);
        let axes = inputs(&mut board).axes;
        assert!(axes[axis].home && !axes[1 - axis].home, "PC{bit}");
    }
    board.model.set(GPIOA + 0x10, 1 << 3 | 1 << 10);
    assert!(inputs(&mut board).probe_touched);
    for (present, axis) in [(1 << 10, 0), (1 << 3, 1)] {
        board.model.set(GPIOA + 0x10, present | 1 << 15);
        let _ = inputs(&mut board);
        let readings = board.parts.hardware.readings();
        assert!(readings[axis].table.is_none() && readings[1 - axis].table.is_some(), "axis {axis}");
        board = Board::start(Port::Serial);
    }
}

/// Travel of a count of the motor's encoder and of the scale of an axis, m.
fn metres_per_count(axis: usize) -> [f64; 2] {
    let MotorSensor::Encoder { metres_per_count } = TABLE[axis].motor else { panic!("an encoder") };
    [metres_per_count, TABLE[axis].scale_m_per_count.unwrap()]
}

/// Each counter is the reading of its sensor, as it was when the tick was due although the program reads it later, and each index latches it: TIM4 on
/// its fourth channel.
#[test]
fn each_counter_is_its_own_sensor() {
    let mut board = Board::start(Port::Serial);
    board.tick();
    let positions = |board: &mut Board| {
        board.parts.hardware.readings().map(|reading| [reading.motor.0, reading.table.unwrap().0])
    };
    for (number, (timer, (flag, captured))) in COUNTERS.into_iter().zip(INDEXES).enumerate() {
        let (axis, sensor) = (number % 2, number / 2);
        let before = positions(&mut board);
        board.model.set(timer + 0x24, 100);
        board.model.begin_tick();
        board.model.set(timer + 0x24, 107);
        board.model.set(timer + captured, 60);
        board.model.set(timer + 0x10, flag);
        board.parts.hardware.begin_tick();
        let mut travelled = positions(&mut board);
        for (to, from) in travelled.as_flattened_mut().iter_mut().zip(before.as_flattened()) {
            *to -= from;
        }
        // A count is a whole number of units, or is rounded to one.
        let is_after = |units: i64, counts: f64| {
            (units - Position::from_m(counts * metres_per_count(axis)[sensor]).unwrap().0).abs() <= 100
        };
        assert!(is_after(std::mem::take(&mut travelled[axis][sensor]), 100.0), "{timer:#x}");
        assert_eq!(travelled, [[0; 2]; 2], "{timer:#x}");
        let indexes = board.parts.hardware.inputs().axes.map(|axis| [axis.motor_index, axis.scale_index]);
        let mut others = indexes;
        let index = others[axis][sensor].take().unwrap();
        assert!(is_after(index.0 - before[axis][sensor], 60.0) && others == [[None; 2]; 2], "{timer:#x}");
        board.model.set(timer + 0x10, 0);
        board.model.set(timer + 0x24, 100);
    }
}

/// Bus voltage and temperature are those of their inputs, 48 V and 25 °C; resolvers are not fitted.
#[test]
fn the_supply_is_that_of_its_inputs() {
    let mut board = Board::start(Port::Serial);
    board.tick();
    let supply = board.parts.hardware.inputs().supply;
    assert!(supply.bus_mv.unwrap().abs_diff(48_000) < 20, "{supply:?}");
    assert!(supply.temperature_mc.unwrap().abs_diff(25_000) < 100, "{supply:?}");
}

/// A host at either port enables the drives; an axis that is displaced is pushed back by its own duty and direction; the host disables them.
#[test]
fn a_host_at_either_port_enables_the_drives_which_push_back() {
    for port in [Port::Serial, Port::Can] {
        for (axis, timer) in [(0, 0x4000_0424), (1, 0x4000_0824)] {
            let mut board = Board::enabled(port);
            assert_eq!(status(&mut board), Power::On);
            for counts in 1..=20 {
                board.model.set(timer, counts);
                board.tick();
            }
            let compares = [0, 4].map(|at| board.model.word(TIM1 + 0x34 + at));
            // At 8500 there is no pulse.
            assert!(compares[axis] < 8500, "{compares:?}");
            assert_eq!(compares[1 - axis], 8500);
            board.tick();
            let directions = board.model.word(GPIOC + 0x14) >> 10 & 0b11;
            assert_eq!(directions, 1 << axis, "towards zero, only this axis");
            assert_eq!(board.ask(&Request::Disable), Reply::Done);
            board.ticks(2);
            assert_eq!(board.outputs(), [false; 2]);
            assert_eq!([0, 4].map(|at| board.model.word(TIM1 + 0x34 + at)), [8500; 2]);
        }
    }
}

/// Each of these switches the drives off in the next tick, and is named: the stop, by its pin or by the break that was active for a moment, by the pin or
/// by the supply of the chip; drive faults. The light goes on: PC13 low.
#[test]
fn what_fails_switches_the_drives_off() {
    let drive = |axis| Fault::Axis { axis, kind: FaultKind::DriveFault };
    for (contact, flags, fault) in [
        (12, 0, Fault::EmergencyStop),
        (2, 0, drive(0)),
        (3, 0, drive(1)),
        (31, 1 << 7, Fault::HardwareStop),
        (31, 1 << 13, Fault::HardwareStop),
    ] {
        let mut board = Board::enabled(Port::Serial);
        assert_eq!(board.model.word(GPIOC + 0x14) >> 13 & 1, 1);
        board.set_contacts((CONTACTS | SWITCH) & !(1 << contact));
        board.model.set(TIM1 + 0x10, flags | 1);
        board.tick();
        assert_eq!(board.outputs(), [false; 2], "{fault:?}");
        assert_eq!(board.model.word(GPIOC + 0x14) >> 13 & 1, 0);
        // The flag of the break is cleared, the other stays.
        assert_eq!(board.model.word(TIM1 + 0x10), 1);
        assert_eq!(status(&mut board), Power::Faulted(fault));
    }
}

/// A tick that is due before the present one has ended is a fault.
#[test]
fn a_late_tick_is_a_fault() {
    let mut board = Board::enabled(Port::Serial);
    let parts = &mut board.parts;
    parts.hardware.begin_tick();
    board.model.set(0x4000_0010, 1);
    parts.drive.tick(&mut parts.hardware);
    assert_eq!(board.outputs(), [false; 2]);
    // The next one clears the flag.
    board.parts.hardware.begin_tick();
    assert_eq!(board.model.word(0x4000_0010), 0);
}

/// The brakes are closed with the drives off; without an axis that has one they stay closed.
#[test]
fn the_brakes_stay_closed_without_an_axis_that_has_one() {
    let board = Board::enabled(Port::Serial);
    assert_eq!(board.model.word(GPIOD + 0x14) & 1 << 2, 0);
    assert!(board.model.written(GPIOD + 0x18).iter().all(|value| *value == 1 << 18));
}

/// Frames of another identifier and frames that are not of the link change nothing; after an error that switched the device off the bus it joins
/// it again.
#[test]
fn other_frames_and_a_bus_that_fails_do_not_end_the_session() {
    let mut board = Board::enabled(Port::Can);
    let (frame, _) = CanFrame::of_stream(&[1, 2, 3]).unwrap();
    let arrives = |board: &Board, identifier| board.model.with(|state| state.can.receive(identifier, &frame));
    let to_board = u32::from(CAN_TO_BOARD);
    assert!(!arrives(&board, to_board ^ 1) && !arrives(&board, to_board ^ 0x400));
    assert!(arrives(&board, to_board));
    set_can_flags(board.model, 1);
    board.tick();
    // The bytes before the next packet are lost with it, and its repetition is answered.
    let joined = board.model.written(CAN + 0x18).len();
    board.model.with(|state| state.can.is_on_bus = false);
    set_can_flags(board.model, 1 << 19);
    board.tick();
    assert!(board.model.with(|state| state.can.is_on_bus));
    board.host.end_of_packet();
    assert_eq!(status(&mut board), Power::On);
    // Once: the interrupts of frames do not write to the control of the device.
    assert_eq!(board.model.written(CAN + 0x18).len(), joined + 1);
    assert_eq!(board.parts.can.lost(), 0);
}

/// While other nodes keep the bus, the device holds three frames, and the others wait for it: nothing is lost.
#[test]
fn frames_wait_while_the_bus_is_held() {
    let mut board = Board::enabled(Port::Can);
    board.model.with(|state| state.can.is_held = true);
    for _ in 0..3 {
        board.send(&Request::Status);
        board.ticks(20);
    }
    assert!(board.host.replies.is_empty());
    board.model.with(|state| state.can.is_held = false);
    board.ticks(20);
    assert_eq!(board.host.replies.len(), 3);
}
