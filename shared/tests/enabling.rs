//! The drives coming on and going off: nothing jumps, nothing is left over from the time before, and an enable that was
//! withdrawn is none.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use shared::config::{AxisSettings, Law, Rates, Sensors};
use shared::interpolate::Block;
use shared::machine::{Machine, Output, Reading};
use shared::safety::Power;
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

const DIVIDER: u32 = 5;

fn place(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

/// One axis at zero, off.
fn machine<S: Scalar>(settings: &AxisSettings) -> Machine<S, 1> {
    let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: DIVIDER };
    Machine::new(rates, &[*settings], [Position(0)]).unwrap()
}

fn tick<S: Scalar>(machine: &mut Machine<S, 1>, motor_m: f64, table_m: Option<f64>) -> Output<S, 1> {
    machine.tick(&[Reading { motor: place(motor_m), table: table_m.map(place) }])
}

#[test]
fn disable_withdraws_an_enable_that_no_tick_has_seen() {
    let mut machine = machine::<Fixed>(&AxisSettings::default());
    machine.enable();
    machine.disable();
    for _ in 0..3 {
        assert!(!tick(&mut machine, 0.0, None).enabled);
        assert_eq!(machine.power(), Power::Off);
    }
    machine.enable();
    assert!(tick(&mut machine, 0.0, None).enabled);
}

/// Off, the axis is pushed; the motor and the scale show it at different places, by what the coupling gives. On again,
/// the command is what the position loop reads, so that the error is zero and with it every force, to the bit.
fn starts_on_the_scale<S: Scalar>(sensors: Sensors, law: Law) {
    for [motor_m, table_m] in [[2e-3, 1.2e-3], [-2e-3, -2.7e-3]] {
        let settings = AxisSettings { sensors, law, feedforward_percent: 100.0, ..AxisSettings::default() };
        let mut machine = machine::<S>(&settings);
        machine.enable();
        assert!(tick(&mut machine, 0.0, Some(0.0)).enabled);
        machine.disable();
        for _ in 0..3 {
            assert_eq!(tick(&mut machine, motor_m, Some(table_m)).commands, [place(table_m)], "{}", S::NAME);
        }
        machine.enable();
        for _ in 0..100 {
            let output = tick(&mut machine, motor_m, Some(table_m));
            assert!(output.enabled);
            assert_eq!(output.commands, [place(table_m)], "{} {sensors:?}", S::NAME);
            assert!(output.forces[0] == S::default(), "{} {sensors:?}: {:?}", S::NAME, output.forces);
        }
    }
}

#[test]
fn with_a_scale_the_drives_come_on_where_the_scale_is() {
    for sensors in [Sensors::Table, Sensors::Dual { time_constant_s: 0.05 }] {
        for law in [Law::P, Law::Hpc] {
            starts_on_the_scale::<Fixed>(sensors, law);
            starts_on_the_scale::<f32>(sensors, law);
            starts_on_the_scale::<f64>(sensors, law);
        }
    }
}

/// Without a reading of the scale the motor is all there is.
#[test]
fn with_a_scale_that_is_lost_the_drives_come_on_where_the_motor_is() {
    let settings =
        AxisSettings { sensors: Sensors::Dual { time_constant_s: 0.05 }, ..AxisSettings::default() };
    let mut machine = machine::<Fixed>(&settings);
    machine.enable();
    tick(&mut machine, 0.0, Some(0.0));
    machine.disable();
    assert_eq!(tick(&mut machine, 2e-3, None).commands, [place(2e-3)]);
    machine.enable();
    assert!(tick(&mut machine, 2e-3, None).forces == [Fixed::ZERO]);
}

/// At the first enable the motor stands a millimetre from where the scale, and the command with it, has the axis. The
/// command does not move, so feed-forward has nothing to add: no force, from the first tick on. A difference taken from
/// the motor would ask for 1 mm in a tick of the position loop, 4 m/s.
fn does_not_kick<S: Scalar>() {
    for motor_m in [1e-3, -1e-3] {
        let settings =
            AxisSettings { sensors: Sensors::Table, feedforward_percent: 100.0, ..AxisSettings::default() };
        let mut machine = machine::<S>(&settings);
        machine.enable();
        for _ in 0..20 {
            let output = tick(&mut machine, motor_m, Some(0.0));
            assert!(output.enabled && output.forces == [S::default()], "{}: {:?}", S::NAME, output.forces);
        }
    }
}

#[test]
fn feed_forward_does_not_kick_where_motor_and_scale_differ() {
    does_not_kick::<Fixed>();
    does_not_kick::<f32>();
    does_not_kick::<f64>();
}

/// What comes of an enable with a line to travel, when the drives were on for some ticks before.
fn after_ticks(ticks: u32) -> Vec<Output<Fixed, 1>> {
    let mut machine = machine::<Fixed>(&AxisSettings::default());
    if ticks > 0 {
        machine.enable();
        for _ in 0..ticks {
            assert!(tick(&mut machine, 0.0, None).enabled);
        }
        machine.disable();
        assert!(!tick(&mut machine, 0.0, None).enabled);
    }
    machine.push(&Block::line([0.1], 0.1, 1.0)).unwrap();
    machine.enable();
    (0..4 * DIVIDER).map(|_| tick(&mut machine, 0.0, None)).collect()
}

/// The position loop is due in the first tick after an enable and then with every `DIVIDER`th, wherever in that
/// cycle the drives went off the last time: the command moves in the ticks 1, 6, 11 … and the force with it.
#[test]
fn the_position_loop_runs_in_the_first_tick_after_an_enable() {
    let first = after_ticks(0);
    let mut last = Position(0);
    for (tick, output) in (0..).zip(&first) {
        let [command] = output.commands;
        assert_eq!(command > last, tick % DIVIDER == 0, "tick {tick}");
        assert!(output.forces[0] > Fixed::ZERO, "tick {tick}");
        last = command;
    }
    for ticks in 1..=2 * DIVIDER {
        assert_eq!(after_ticks(ticks), first, "on for {ticks} ticks before");
    }
}

/// What the loops had integrated is gone: with the axis held 0.1 mm off the force grows by an integral; off and on again
/// there, it is zero.
#[test]
fn nothing_integrated_is_left_over() {
    let mut machine = machine::<f64>(&AxisSettings::default());
    machine.enable();
    tick(&mut machine, 0.0, None);
    let [pushed] = (0..1000).map(|_| tick(&mut machine, 1e-4, None)).last().unwrap().forces;
    // Kv·Kp·x·(1 + n·T/Ti) = 165 N·(1 + n/400). The position loop sees x after four ticks more, and the jump itself
    // asks for 100 kN, which is beyond the limit and not integrated: n = 996.
    assert!((pushed + 165.0 * (1.0 + 996.0 / 400.0)).abs() < 1e-6, "{pushed} N");
    machine.disable();
    assert!(tick(&mut machine, 1e-4, None).forces == [0.0]);
    machine.enable();
    for _ in 0..20 {
        assert!(tick(&mut machine, 1e-4, None).forces == [0.0]);
    }
}

/// With a correction standing on the command, off and on again: neither moves, so that feed-forward has nothing to add.
fn does_not_kick_with_a_correction<S: Scalar>() {
    use shared::compensate::CompensationSettings;
    use shared::compensate::settings::{Pitch, PitchSource, Points};
    let pitch = Points { start_m: -0.1, spacing_m: 0.1, values: [1e-4; 3].into_iter().collect() };
    let settings = CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Screw, forward: pitch, backward: None }),
        ..CompensationSettings::default()
    };
    let mut machine = machine::<S>(&AxisSettings { feedforward_percent: 100.0, ..AxisSettings::default() });
    machine.compensate(0, &settings).unwrap();
    machine.enable();
    // A screw that goes 0.1 mm too far is commanded 0.1 mm less, which the motor does.
    for _ in 0..20_000 {
        tick(&mut machine, -1e-4, None);
    }
    machine.disable();
    tick(&mut machine, -1e-4, None);
    machine.enable();
    for _ in 0..20 {
        let [force] = tick(&mut machine, -1e-4, None).forces;
        assert!(force.value().abs() < 1.0, "{}: {force:?} N", S::NAME);
    }
}

#[test]
fn feed_forward_does_not_kick_where_a_correction_stands() {
    does_not_kick_with_a_correction::<Fixed>();
    does_not_kick_with_a_correction::<f32>();
    does_not_kick_with_a_correction::<f64>();
}
