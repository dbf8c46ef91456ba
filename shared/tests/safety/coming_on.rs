//! Drives that come on: where the axes stand, with nothing left over, and not without what the loops need.

use super::*;

/// A reversal's pulse is one of a reversal: given to an axis that stands far from where the machine was made, or moves
/// in − direction all the while, it adds nothing.
#[test]
fn a_compensation_that_is_given_late_sees_no_reversal() {
    use shared::compensate::CompensationSettings;
    use shared::compensate::settings::Reversal;
    let reversal = Reversal { force_n: 300.0, decay_s: 0.02, fade_m_per_s: 0.02 };
    let settings = CompensationSettings { reversal: Some(reversal), ..CompensationSettings::default() };
    for moves in [false, true] {
        let mut bench = Bench::<f64>::new(&AxisSettings { sensors: Sensors::Motor, ..axis() });
        bench.run(16_000);
        if moves {
            bench.machine.push(&Block::line([0.1, 0.1], 5e-3, 2.0)).unwrap();
        }
        bench.run(4000);
        bench.machine.compensate(0, &settings).unwrap();
        // At rest and at constant speed, a mass without friction needs no force.
        for _ in 0..4000 {
            let force = bench.tick().forces[0];
            assert!(force.abs() < 1.0, "{moves}: {force} N");
        }
    }
}

/// Under power the loop keeps its sensors: the axis would go by all that the two differ.
#[test]
fn sensors_are_changed_with_the_drives_off_alone() {
    let mut bench = Bench::<Fixed>::new(&AxisSettings { sensors: Sensors::Motor, ..axis() });
    bench.run(16_000);
    bench.scale_off_m = 0.4e-3;
    bench.run(1);
    let other = AxisSettings { sensors: Sensors::Table, ..axis() };
    let refused = bench.machine.change(0, &other).unwrap_err();
    assert_eq!(refused, MachineError::Config { axis: 0, error: ConfigError::NotWhileRunning("sensors") });
    let place = bench.motor_m[0];
    bench.run(4000);
    assert!((bench.motor_m[0] - place).abs() < 1e-6);
    bench.machine.disable();
    bench.machine.change(0, &other).unwrap();
    bench.run(1);
    bench.machine.enable();
    bench.run(4000);
    assert_eq!(bench.machine.power(), Power::On);
    assert!((bench.motor_m[0] - place).abs() < 1e-6, "{} m", bench.motor_m[0] - place);
}

/// A loop that needs a scale does not come on without it: when the scale came back, the axis would go to where that sees
/// it.
#[test]
fn without_its_scale_a_loop_does_not_come_on() {
    for sensors in [Sensors::Table, Sensors::Dual { time_constant_s: 0.05 }] {
        let mut bench =
            Bench::<Fixed>::new(&AxisSettings { sensors, scale_disagreement_limit_m: None, ..axis() });
        bench.scale = false;
        let output = bench.run(10);
        assert_eq!(bench.machine.power(), Power::Faulted(on(0, FaultKind::ScaleLost)), "{sensors:?}");
        assert!(!output.enabled && output.forces == [Fixed::ZERO; 2]);
        (bench.scale, bench.scale_off_m) = (true, 5e-3);
        bench.machine.enable();
        bench.run(10);
        assert!(!bench.machine.power().is_on());
        bench.machine.disable();
        bench.run(1);
        bench.machine.enable();
        bench.run(4000);
        // Where it stands, 5 mm of scale included.
        assert_eq!(bench.machine.power(), Power::On);
        assert!(bench.motor_m[0].abs() < 1e-6, "{} m", bench.motor_m[0]);
    }
}

/// Not moved by hand, an axis starts its path; moved, it holds where it is, says so, and does not jump back.
#[test]
fn a_path_that_was_pushed_before_the_axis_was_moved_is_forgotten() {
    for (moved_m, holds) in [(0.05e-3, false), (0.2e-3, true), (-5e-3, true)] {
        let mut machine = Machine::<Fixed, 1>::new(RATES, &[axis()], [Position(0)]).unwrap();
        let at = |m: f64| {
            let place = Position::from_m(m).unwrap();
            [Reading { motor: place, table: Some(place) }]
        };
        machine.push(&Block::line([0.1], 0.1, 2.0)).unwrap();
        machine.tick(&at(moved_m));
        machine.enable();
        let output = machine.tick(&at(moved_m));
        assert_eq!(machine.power(), Power::On);
        assert_eq!(output.done, holds, "{moved_m}");
        if holds {
            assert_eq!(output.warning, Some(on(0, FaultKind::Displaced)));
            assert_eq!(output.commands, [at(moved_m)[0].motor]);
            // No error, no force; 4000 ticks on it still stands.
            assert!((0..4000).all(|_| machine.tick(&at(moved_m)).forces == [Fixed::ZERO]));
        } else {
            assert_eq!(output.warning, None);
        }
    }
}

/// What is pushed while the drives are off starts where the axis was moved to before.
#[test]
fn before_the_first_enable_the_command_follows_the_axis() {
    let mut machine = Machine::<f64, 1>::new(RATES, &[axis()], [Position(0)]).unwrap();
    let place = Position::from_m(0.02).unwrap();
    let reading = [Reading { motor: place, table: Some(place) }];
    machine.tick(&reading);
    machine.push(&Block::line([0.03], 0.1, 2.0)).unwrap();
    machine.enable();
    let output = machine.tick(&reading);
    assert_eq!((output.warning, output.done), (None, false));
    // The first tick of a ramp of 2 m/s² is 2/4000² m = 0.125 µm long at most: 250 N·s at Kp = 50, Kv = 20,000 are 0.2 N.
    assert!((output.commands[0] - place).unsigned_abs() <= 131_072 * 1000);
    assert!(output.forces[0].abs() < 1.0, "{}", output.forces[0]);
}

/// What ended the run before is a fault of this one: no enable before it is acknowledged.
#[test]
fn a_watchdog_reset_has_to_be_acknowledged() {
    let mut bench = Bench::<Fixed>::new(&axis());
    bench.machine.inhibit_enable(Fault::Watchdog);
    bench.run(10);
    assert_eq!(bench.machine.power(), Power::Faulted(Fault::Watchdog));
    bench.machine.enable();
    assert!(!bench.tick().enabled);
    bench.machine.disable();
    bench.machine.enable();
    assert!(bench.tick().enabled);
}

/// Off and on again, as often as one likes, a compensated axis stays where it is: what is added to its command stands
/// all the while.
#[test]
fn coming_on_again_does_not_move_a_compensated_axis() {
    use shared::compensate::CompensationSettings;
    use shared::compensate::settings::{Pitch, PitchSource, Points};
    let pitch = Points { start_m: -0.1, spacing_m: 0.1, values: [1e-4; 3].into_iter().collect() };
    let settings = CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Screw, forward: pitch, backward: None }),
        ..CompensationSettings::default()
    };
    let mut bench = Bench::<f64>::new(&AxisSettings { sensors: Sensors::Motor, ..axis() });
    bench.machine.compensate(0, &settings).unwrap();
    bench.run(24_000);
    let place = bench.motor_m[0];
    assert!(((place - 0.2).abs() - 1e-4).abs() < 2e-6, "{place} m");
    for _ in 0..5 {
        bench.machine.disable();
        assert_eq!(bench.machine.push(&Block::line([0.01, 0.0], 0.1, 1.0)), Err(PathError::Interrupted));
        bench.run(10);
        bench.machine.enable();
        for _ in 0..2000 {
            let output = bench.tick();
            assert!(output.forces[0].abs() < 5.0, "{} N", output.forces[0]);
        }
        assert!((bench.motor_m[0] - place).abs() < 1e-6, "{} m", bench.motor_m[0]);
    }
}
