//! Enabling and disabling the drives: no jump, no state from before the enable, and no effect of an enable that was
//! withdrawn.

use shared::compensate::CompensationSettings;
use shared::compensate::settings::{Pitch, PitchSource, Points};
use shared::config::{AxisSettings, Law, Rates, ScaleLimits, Sensors};
use shared::interpolate::Block;
use shared::machine::{Machine, Output, Reading};
use shared::safety::Power;
use shared::scalar::{Fixed, Scalar};
use shared::units::{PER_NM, Position};

const DIVIDER: u32 = 5;

/// For readings of motor and scale that differ by some millimetres.
const WIDE: ScaleLimits = ScaleLimits { disagreement_m: 0.02, ..ScaleLimits::DEFAULT };

fn position(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

/// One axis at zero, drives off.
fn machine<S: Scalar>(settings: &AxisSettings) -> Machine<S, 1> {
    let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: DIVIDER };
    Machine::new(rates, &[*settings], [Position(0)]).unwrap()
}

fn tick<S: Scalar>(machine: &mut Machine<S, 1>, motor_m: f64, table_m: Option<f64>) -> Output<S, 1> {
    machine.tick(&[Reading { motor: position(motor_m), table: table_m.map(position) }])
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

/// While the drives are off, the axis is pushed by hand; the readings of motor and scale differ by the compliance of the
/// coupling. At the next enable the command is the feedback of the position loop, so the following error and the force
/// are exactly zero.
fn starts_at_the_scale_reading<S: Scalar>(sensors: Sensors, law: Law) {
    for [motor_m, table_m] in [[2e-3, 1.2e-3], [-2e-3, -2.7e-3]] {
        let settings = AxisSettings { sensors, law, feedforward_percent: 100.0, ..AxisSettings::default() };
        let mut machine = machine::<S>(&settings);
        machine.enable();
        assert!(tick(&mut machine, 0.0, Some(0.0)).enabled);
        machine.disable();
        for _ in 0..3 {
            assert_eq!(
                tick(&mut machine, motor_m, Some(table_m)).commands,
                [position(table_m)],
                "{}",
                S::NAME
            );
        }
        machine.enable();
        for _ in 0..100 {
            let output = tick(&mut machine, motor_m, Some(table_m));
            assert!(output.enabled);
            assert_eq!(output.commands, [position(table_m)], "{} {sensors:?}", S::NAME);
            assert!(output.forces[0] == S::default(), "{} {sensors:?}: {:?}", S::NAME, output.forces);
        }
    }
}

#[test]
fn with_a_scale_the_drives_come_on_where_the_scale_is() {
    for sensors in [Sensors::Table(WIDE), Sensors::Dual { time_constant_s: 0.05, limits: WIDE }] {
        for law in [Law::P, Law::Hpc] {
            starts_at_the_scale_reading::<Fixed>(sensors, law);
            starts_at_the_scale_reading::<f32>(sensors, law);
            starts_at_the_scale_reading::<f64>(sensors, law);
        }
    }
}

#[test]
fn without_a_scale_reading_the_drives_come_on_at_the_motor_reading() {
    let settings = AxisSettings {
        sensors: Sensors::Dual { time_constant_s: 0.05, limits: WIDE },
        ..AxisSettings::default()
    };
    let mut machine = machine::<Fixed>(&settings);
    machine.enable();
    tick(&mut machine, 0.0, Some(0.0));
    machine.disable();
    assert_eq!(tick(&mut machine, 2e-3, None).commands, [position(2e-3)]);
    machine.enable();
    assert!(tick(&mut machine, 2e-3, None).forces == [Fixed::ZERO]);
}

/// At the first enable the motor reading differs by 1 mm from the scale reading, which is the command. The command does not
/// move, so feed-forward and force are zero from the first tick on. A feed-forward that started from the motor reading
/// would see 1 mm per position tick, 4 m/s.
fn force_stays_zero<S: Scalar>() {
    for motor_m in [1e-3, -1e-3] {
        let settings = AxisSettings {
            sensors: Sensors::Table(WIDE),
            feedforward_percent: 100.0,
            ..AxisSettings::default()
        };
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
    force_stays_zero::<Fixed>();
    force_stays_zero::<f32>();
    force_stays_zero::<f64>();
}

/// Outputs after an enable with a line to travel. Before, the drives were on for `ticks` ticks.
fn outputs_after(ticks: u32) -> Vec<Output<Fixed, 1>> {
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

/// The position loop runs in the first tick after an enable and then in every `DIVIDER`th, in whichever tick of this cycle
/// the drives were switched off before. So the command moves in the ticks 0, 5, 10 …, and there is a force in each tick.
#[test]
fn the_position_loop_runs_in_the_first_tick_after_an_enable() {
    let first = outputs_after(0);
    let mut last = Position(0);
    for (tick, output) in (0..).zip(&first) {
        let [command] = output.commands;
        assert_eq!(command > last, tick % DIVIDER == 0, "tick {tick}");
        assert!(output.forces[0] > Fixed::ZERO, "tick {tick}");
        last = command;
    }
    for ticks in 1..=2 * DIVIDER {
        assert_eq!(outputs_after(ticks), first, "on for {ticks} ticks before");
    }
}

/// With the axis locked 0.1 mm away from its command the integral part builds up. After a disable and an enable at that
/// position the force is zero.
#[test]
fn the_integral_is_reset_between_disable_and_enable() {
    let mut machine = machine::<f64>(&AxisSettings::default());
    machine.enable();
    tick(&mut machine, 0.0, None);
    let [pushed] = (0..1000).map(|_| tick(&mut machine, 1e-4, None)).last().unwrap().forces;
    // Kv·Kp·x·(1 + n·T/Ti) = 165 N·(1 + n/400). n = 996: the next position tick is the fifth, and the jump of the reading,
    // Kv·0.1 mm/50 µs = 100 kN, exceeds the force limit and is not integrated.
    assert!((pushed + 165.0 * (1.0 + 996.0 / 400.0)).abs() < 1e-6, "{pushed} N");
    machine.disable();
    assert!(tick(&mut machine, 1e-4, None).forces == [0.0]);
    machine.enable();
    for _ in 0..20 {
        assert!(tick(&mut machine, 1e-4, None).forces == [0.0]);
    }
}

/// A constant correction is added to the command when the drives are disabled and enabled again. Neither the command nor
/// the correction changes, so the feed-forward is zero.
fn force_stays_zero_with_a_correction<S: Scalar>() {
    let pitch = Points { start_m: -0.1, spacing_m: 0.1, values: [1e-4; 3].into_iter().collect() };
    let settings = CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Screw, forward: pitch, backward: None }),
        ..CompensationSettings::default()
    };
    let mut machine = machine::<S>(&AxisSettings { feedforward_percent: 100.0, ..AxisSettings::default() });
    machine.compensate(0, &settings).unwrap();
    machine.enable();
    // The screw moves the table 0.1 mm too far, so the correction is −0.1 mm, and the motor has followed it.
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
fn feed_forward_does_not_kick_with_a_constant_correction() {
    force_stays_zero_with_a_correction::<Fixed>();
    force_stays_zero_with_a_correction::<f32>();
    force_stays_zero_with_a_correction::<f64>();
}

/// A pitch error of the screw is corrected in the command and in the reading of the scale alike, because a loop on the scale
/// does not see it. The drives therefore come on where the scale is, as without the correction.
fn comes_on_at_the_scale_with_a_correction<S: Scalar>(sensors: Sensors) {
    let pitch = Points { start_m: -0.1, spacing_m: 0.1, values: [1e-4; 3].into_iter().collect() };
    let settings = CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Screw, forward: pitch, backward: None }),
        ..CompensationSettings::default()
    };
    let mut machine = machine::<S>(&AxisSettings { sensors, ..AxisSettings::default() });
    machine.compensate(0, &settings).unwrap();
    machine.enable();
    // 0.1 mm at 10 mm/s take 10 ms, 200 ticks.
    for _ in 0..2000 {
        tick(&mut machine, 0.0, Some(0.0));
    }
    let corrected_m = machine.corrected_command()[0].to_m() - machine.command()[0].to_m();
    assert!((corrected_m.abs() - 1e-4).abs() < 1e-8, "{}: {corrected_m} m", S::NAME);
    machine.disable();
    for [motor_m, table_m] in [[2e-3, 1.2e-3], [-2e-3, -2.7e-3]] {
        for _ in 0..3 {
            let [command] = tick(&mut machine, motor_m, Some(table_m)).commands;
            // Both corrections are the same number: the sum is exact but for the steps of f32, 10⁻⁷ of 0.1 mm.
            assert!((command.to_m() - table_m).abs() < 1e-10, "{} {sensors:?}: {command:?}", S::NAME);
        }
        machine.enable();
        for _ in 0..20 {
            let output = tick(&mut machine, motor_m, Some(table_m));
            assert_eq!(output.warning, None, "{} {sensors:?}", S::NAME);
            // A following error of the correction, 0.1 mm, would be Kp·Kv·0.1 mm, above 100 N.
            assert!(output.forces[0].value().abs() < 0.1, "{} {sensors:?}: {:?}", S::NAME, output.forces);
        }
        machine.disable();
    }
}

#[test]
fn with_a_correction_of_the_screw_the_drives_come_on_where_the_scale_is() {
    for sensors in [Sensors::Table(WIDE), Sensors::Dual { time_constant_s: 0.05, limits: WIDE }] {
        comes_on_at_the_scale_with_a_correction::<Fixed>(sensors);
        comes_on_at_the_scale_with_a_correction::<f32>(sensors);
        comes_on_at_the_scale_with_a_correction::<f64>(sensors);
    }
}

/// An axis may be 0.1 mm away from the start of its path in either direction, and no position unit more.
#[test]
fn a_path_starts_at_a_distance_of_a_tenth_of_a_millimetre_and_not_beyond() {
    let limit = 100_000 * PER_NM;
    for (distance, starts) in [(limit, true), (limit + 1, false), (-limit, true), (-limit - 1, false)] {
        let mut machine = machine::<Fixed>(&AxisSettings::default());
        machine.push(&Block::line([0.1], 0.1, 1.0)).unwrap();
        machine.enable();
        let output = machine.tick(&[Reading { motor: Position(distance), table: None }]);
        assert_eq!((output.warning.is_none(), output.done), (starts, !starts), "{distance}");
    }
}
