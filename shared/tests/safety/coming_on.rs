//! Enabling the drives: at the position of the axes, without state from before, and only with the sensors that the loops
//! use.

use super::*;

/// A reversal compensation adds no force when it is set after the axis has moved away from the start, be it at rest or in
/// steady motion in − direction: the axis has not reversed since.
#[test]
fn a_reversal_compensation_that_is_set_later_starts_without_a_pulse() {
    use shared::compensate::CompensationSettings;
    use shared::compensate::settings::Reversal;
    let reversal = Reversal { force_n: 300.0, decay_s: 0.02, fade_m_per_s: 0.02 };
    let settings = CompensationSettings { reversal: Some(reversal), ..CompensationSettings::default() };
    for moves in [false, true] {
        let mut plant = TestPlant::<f64>::new(&AxisSettings { sensors: Sensors::MOTOR, ..axis() });
        plant.run(16_000);
        if moves {
            plant.machine.push(&Block::line([0.1, 0.1], 5e-3, 2.0)).unwrap();
        }
        plant.run(4000);
        plant.machine.compensate(0, &settings).unwrap();
        // At rest and at constant speed, a mass without friction needs no force.
        for _ in 0..4000 {
            let force = plant.tick().forces[0];
            assert!(force.abs() < 1.0, "{moves}: {force} N");
        }
    }
}

/// With the drives on, the axis would jump by the difference of the two readings.
#[test]
fn sensors_can_be_changed_only_while_the_drives_are_off() {
    let mut plant = TestPlant::<Fixed>::new(&AxisSettings { sensors: Sensors::MOTOR, ..axis() });
    plant.run(16_000);
    plant.scale_off_m = 0.4e-3;
    plant.run(1);
    let other = AxisSettings { sensors: Sensors::Table(LIMITS), ..axis() };
    let error = plant.machine.change(0, &other).unwrap_err();
    assert_eq!(error, MachineError::Config { axis: 0, error: ConfigError::NotWhileRunning("sensors") });
    let position = plant.motor_m[0];
    plant.run(4000);
    assert!((plant.motor_m[0] - position).abs() < 1e-6);
    plant.machine.disable();
    plant.machine.change(0, &other).unwrap();
    plant.run(1);
    plant.machine.enable();
    plant.run(4000);
    assert_eq!(plant.machine.power(), Power::On);
    assert!((plant.motor_m[0] - position).abs() < 1e-6, "{} m", plant.motor_m[0] - position);
}

/// Without this fault the axis would jump to the scale reading when the scale returns.
#[test]
fn a_loop_without_a_reading_of_its_scale_is_not_enabled() {
    for sensors in [Sensors::Table(WIDE), Sensors::Dual { time_constant_s: 0.05, limits: WIDE }] {
        let mut plant = TestPlant::<Fixed>::new(&AxisSettings { sensors, ..axis() });
        plant.scale = false;
        let output = plant.run(10);
        assert_eq!(plant.machine.power(), Power::Faulted(on(0, FaultKind::ScaleLost)), "{sensors:?}");
        assert!(!output.enabled && output.forces == [Fixed::ZERO; 2]);
        (plant.scale, plant.scale_off_m) = (true, 5e-3);
        plant.machine.enable();
        plant.run(10);
        assert!(!plant.machine.power().is_on());
        plant.machine.disable();
        plant.run(1);
        plant.machine.enable();
        plant.run(4000);
        // The axis holds its position although the scale has an offset of 5 mm.
        assert_eq!(plant.machine.power(), Power::On);
        assert!(plant.motor_m[0].abs() < 1e-6, "{} m", plant.motor_m[0]);
    }
}

/// An axis that was moved by less than 0.1 mm after its path was pushed starts the path. One that was moved further holds
/// its position, warns, and discards the path.
#[test]
fn a_path_is_discarded_if_the_axis_has_been_moved_away_from_its_start() {
    for (moved_m, holds) in [(0.05e-3, false), (0.2e-3, true), (-5e-3, true)] {
        let mut machine = Machine::<Fixed, 1>::new(RATES, &[axis()], [Position(0)]).unwrap();
        let at = |m: f64| {
            let position = Position::from_m(m).unwrap();
            [Reading { motor: position, table: Some(position) }]
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
            // Without a position error the force is zero, so the axis is still at standstill 4000 ticks later.
            assert!((0..4000).all(|_| machine.tick(&at(moved_m)).forces == [Fixed::ZERO]));
        } else {
            assert_eq!(output.warning, None);
        }
    }
}

/// A path that is pushed while the drives are off starts at the position to which the axis was moved before.
#[test]
fn before_the_first_enable_the_command_follows_the_axis() {
    let mut machine = Machine::<f64, 1>::new(RATES, &[axis()], [Position(0)]).unwrap();
    let position = Position::from_m(0.02).unwrap();
    let reading = [Reading { motor: position, table: Some(position) }];
    machine.tick(&reading);
    machine.push(&Block::line([0.03], 0.1, 2.0)).unwrap();
    machine.enable();
    let output = machine.tick(&reading);
    assert_eq!((output.warning, output.done), (None, false));
    // The first tick of a ramp at 2 m/s² is at most 2/4000² m = 0.125 µm long: Kp·Kv·0.125 µm = 0.125 N.
    assert!((output.commands[0] - position).unsigned_abs() <= 131_072 * 1000);
    assert!(output.forces[0].abs() < 1.0, "{}", output.forces[0]);
}

#[test]
fn after_a_watchdog_reset_an_enable_needs_an_acknowledgement() {
    let mut plant = TestPlant::<Fixed>::new(&axis());
    plant.machine.inhibit_enable(Fault::Watchdog);
    plant.run(10);
    assert_eq!(plant.machine.power(), Power::Faulted(Fault::Watchdog));
    plant.machine.enable();
    assert!(!plant.tick().enabled);
    plant.machine.disable();
    plant.machine.enable();
    assert!(plant.tick().enabled);
}

/// The correction stays added to the command while the drives are off.
#[test]
fn disabling_and_enabling_repeatedly_does_not_move_a_compensated_axis() {
    use shared::compensate::CompensationSettings;
    use shared::compensate::settings::{Pitch, PitchSource, Points};
    let pitch = Points { start_m: -0.1, spacing_m: 0.1, values: [1e-4; 3].into_iter().collect() };
    let settings = CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Screw, forward: pitch, backward: None }),
        ..CompensationSettings::default()
    };
    let mut plant = TestPlant::<f64>::new(&AxisSettings { sensors: Sensors::MOTOR, ..axis() });
    plant.machine.compensate(0, &settings).unwrap();
    plant.run(24_000);
    let position = plant.motor_m[0];
    assert!(((position - 0.2).abs() - 1e-4).abs() < 2e-6, "{position} m");
    for _ in 0..5 {
        plant.machine.disable();
        assert_eq!(plant.machine.push(&Block::line([0.01, 0.0], 0.1, 1.0)), Err(PathError::Interrupted));
        plant.run(10);
        plant.machine.enable();
        for _ in 0..2000 {
            let output = plant.tick();
            assert!(output.forces[0].abs() < 5.0, "{} N", output.forces[0]);
        }
        assert!((plant.motor_m[0] - position).abs() < 1e-6, "{} m", plant.motor_m[0]);
    }
}
