//! What both chips share, with the alternatives that the table of the board does not have: resolvers, axes without a scale, analogue and step
//! drives; and the queues of the serial port. The registers are those of this test.

mod registers;
mod serial;

use firmware::setup::{AXES, AxisTable, MotorSensor, TABLE};
use firmware::two_drives::switches::Levels;
use firmware::two_drives::{Conversions, Hardware};
use shared::drive::analog::AnalogSettings;
use shared::drive::step::Steps;
use shared::drive::{Board as _, DriveSettings, DriveSignal, Duty};
use shared::feedback::resolver::ResolverSettings;
use shared::units::Position;

use registers::{Chip, FULL_COUNTS, WIRING, timers};

/// All contacts closed, both scales with a signal, no home switch.
const NORMAL: Levels = Levels { a: 0b111, b: 0xff, c: 0 };

fn hardware(table: [AxisTable; AXES]) -> (Chip, Hardware<Chip>) {
    let chip = Chip::new();
    chip.with(|state| state.levels = NORMAL);
    let hardware = Hardware::new(Box::leak(Box::new(table)), chip, timers(chip), FULL_COUNTS).unwrap();
    (chip, hardware)
}

fn with_resolvers() -> [AxisTable; AXES] {
    TABLE.map(|axis| AxisTable {
        motor: MotorSensor::Resolver(ResolverSettings::TWELVE_BIT),
        scale_m_per_count: None,
        ..axis
    })
}

/// An amplitude of 1500 counts at a quarter of a cycle and at zero: 5 mm / 4 and 0. Signals of 300 counts, less than 1050, are bad, and the position
/// holds. There is no signal before the first tick, and no index.
#[test]
fn a_resolver_is_read_and_tells_whether_its_signals_are_good() {
    let (chip, mut hardware) = hardware(with_resolvers());
    let inputs = hardware.inputs().axes;
    assert!(inputs.iter().all(|axis| axis.bad_encoder_signal && axis.signals.is_none()));
    let (at_quarter, at_zero, weak) = ([3548, 2048], [2048, 3548], [2348, 2048]);
    for (resolvers, are_bad) in [
        ([at_quarter, at_zero], [false, false]),
        ([weak, at_zero], [true, false]),
        ([at_quarter, weak], [false, true]),
    ] {
        chip.with(|state| {
            state.conversions = Conversions { resolvers, ..Conversions::default() };
            state.indexes = [Some(5); 4];
        });
        hardware.begin_tick();
        let motors = hardware.readings().map(|reading| reading.motor);
        assert_eq!(motors, [Position::from_m(5e-3 / 4.0).unwrap(), Position(0)]);
        for (axis, [sine, cosine]) in hardware.inputs().axes.iter().zip(resolvers) {
            let signals = axis.signals.unwrap();
            assert_eq!([signals.sine, signals.cosine], [sine, cosine].map(|counts| i32::from(counts) - 2048));
            assert!(axis.motor_index.is_none() && axis.scale_index.is_none());
        }
        assert_eq!(hardware.inputs().axes.map(|axis| axis.bad_encoder_signal), are_bad);
    }
}

/// Without a scale the counter at its input is an input of the axis: that of X has 32 bits, that of Y is counted on from its 16, from zero at the
/// start. With scales there is none.
#[test]
fn without_a_scale_its_counter_is_an_input() {
    let (chip, mut hardware) = hardware(with_resolvers());
    let counters = |y: u16| {
        chip.with(|state| state.counts = [0, 0, 70_000, u32::from(y)]);
        hardware.begin_tick();
        assert!(hardware.readings().iter().all(|reading| reading.table.is_none()));
        hardware.inputs().axes.map(|axis| axis.counter)
    };
    let read = [30_000, 60_000, 24_464].map(counters);
    // 24,464 is 60,000 + 30,000 − 65,536.
    assert_eq!(read, [30_000, 60_000, 90_000].map(|y| [Some(70_000), Some(y)]));
    let (_, mut hardware) = self::hardware(TABLE);
    hardware.begin_tick();
    assert_eq!(hardware.inputs().axes.map(|axis| axis.counter), [None; AXES]);
}

/// An analogue output changes at once, without a pulse. A step is a pulse with its direction, which the pin has from the next period on, and the
/// reading of the motor is the sum of the steps.
#[test]
fn analogue_outputs_and_steps_reach_their_axis() {
    let [x, y] = TABLE;
    let analog = AnalogSettings { full_scale_n: 100.0, zero: 2048, span: 2000, max: 4095 };
    let table = [
        AxisTable { drive: DriveSettings::Analog(analog), ..x },
        AxisTable { drive: DriveSettings::Steps { step_m: 1e-5 }, ..y },
    ];
    let (chip, mut hardware) = hardware(table);
    let pulse = Duty { reverse: true, counts: 4000 };
    let mut position = 0;
    for (reverse, count, moved) in [(false, 1, 1), (false, 1, 1), (true, 1, -1), (false, 0, 0)] {
        let steps = Steps { reverse, count };
        hardware.set_signals([DriveSignal::Analog(3000), DriveSignal::Steps { steps, pulse }]);
        hardware.begin_tick();
        position += moved * Position::from_m(1e-5).unwrap().0;
        let motors = hardware.readings().map(|reading| reading.motor);
        assert_eq!(motors, [Position(0), Position(position)]);
        chip.with(|state| {
            assert_eq!(
                (state.analog, state.compares),
                ([Some(3000), None], [FULL_COUNTS, FULL_COUNTS - 4000])
            );
            assert_eq!(state.directions, [false, true]);
        });
    }
}

#[test]
fn the_brakes_follow_the_controller() {
    let (chip, mut hardware) = hardware(TABLE);
    for open in [true, false] {
        hardware.set_brakes_open(open);
        chip.with(|state| assert_eq!(state.are_brakes_open, open));
    }
}

/// The stages are switched when that changes, not in each tick: a write would clear what the hardware has switched off in between.
#[test]
fn the_stages_are_switched_once() {
    let (chip, mut hardware) = hardware(TABLE);
    for enabled in [false, true, true, false, false] {
        hardware.set_enabled(enabled);
    }
    chip.with(|state| assert_eq!(state.outputs, [true, false]));
}

/// Contacts that are not connected are not read: of the pins of [`WIRING`] all are low.
#[test]
fn what_is_not_connected_is_not_active() {
    let bare = |axis| AxisTable { limit_switches: false, drive_fault: false, scale_signal: false, ..axis };
    for (table, is_active) in [(TABLE, true), (TABLE.map(bare), false)] {
        let (chip, mut hardware) = hardware(table);
        hardware.begin_tick();
        chip.with(|state| state.levels = Levels { c: WIRING.homes[1], ..Levels::default() });
        hardware.begin_tick();
        for (number, axis) in hardware.inputs().axes.iter().enumerate() {
            assert_eq!((axis.limits, axis.drive_fault), ([is_active; 2], is_active));
            assert_eq!((axis.home, hardware.readings()[number].table.is_none()), (number == 1, is_active));
        }
        assert!(hardware.inputs().emergency_stop && hardware.inputs().probe_touched);
        assert!(!hardware.enable_switch_closed());
    }
}
