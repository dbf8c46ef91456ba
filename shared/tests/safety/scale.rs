//! A scale in the loop that stands, or a motor encoder that stands beside it, at rest and in motion.

use super::*;

/// Motion of the first motor until the drives go off, m, and the fault. At most 5 s.
fn motion_until_off<S: Scalar>(plant: &mut TestPlant<S>) -> (f64, Power) {
    let start_m = plant.motor_m[0];
    plant.until_off(|_, _| ());
    ((plant.motor_m[0] - start_m).abs(), plant.machine.power())
}

/// The first axis moves at 89 mm/s when its scale stands. With the loop on the scale alone the velocity command grows with the
/// command, with dual feedback the motor is led to where a scale that stands is not: neither ends by itself. By the description of
/// `shared::monitor::standing` the fault is there when the motor has moved by the limit since, and not before 46/64 of it, less the
/// standstill of 1/64. In addition, two ticks at 100 mm/s: that of the reading and the one in which the plant moves on, 50 µm.
fn is_noticed_in_motion<S: Scalar>(sensors: Sensors) {
    let mut plant = TestPlant::<S>::new(&AxisSettings { sensors, ..axis() });
    plant.run(1600);
    assert_eq!(plant.machine.power(), Power::On);
    plant.scale_frozen_m = Some(plant.motor_m[0]);
    let (moved_m, power) = motion_until_off(&mut plant);
    assert_eq!(power, Power::Faulted(on(0, FaultKind::ScaleFrozen)), "{sensors:?} {}", S::NAME);
    let limit_m = LIMITS.frozen_m;
    assert!((limit_m * 45.0 / 64.0..limit_m + 50e-6).contains(&moved_m), "{moved_m} m, {sensors:?}");
    assert!(moved_m < 0.5e-3);
}

#[test]
fn a_scale_that_stands_in_motion_switches_the_drives_off() {
    // The readings may differ by more than what the motor moves here: the standstill alone is noticed.
    for sensors in [Sensors::Table(WIDE), Sensors::Dual { time_constant_s: 0.05, limits: WIDE }] {
        is_noticed_in_motion::<Fixed>(sensors);
        is_noticed_in_motion::<f32>(sensors);
        is_noticed_in_motion::<f64>(sensors);
    }
}

/// An axis at rest whose scale stands 0.2 mm from its command: Kp·0.2 mm = 10 mm/s without end. The scale has moved, so that the motor
/// counts as alone when it has moved by more than the standstill of 6.25 µm; 46/64 of 400 µm follow, and a tick of 2.5 µm.
#[test]
fn a_scale_that_stands_beside_its_command_switches_the_drives_off() {
    for sensors in [Sensors::Table(WIDE), Sensors::Dual { time_constant_s: 0.05, limits: WIDE }] {
        let mut plant = TestPlant::<Fixed>::new(&AxisSettings { sensors, ..axis() });
        plant.run(16_000);
        plant.scale_frozen_m = Some(plant.motor_m[0] - 0.2e-3);
        let (moved_m, power) = motion_until_off(&mut plant);
        assert_eq!(power, Power::Faulted(on(0, FaultKind::ScaleFrozen)), "{sensors:?}");
        assert!((0.28e-3..0.31e-3).contains(&moved_m), "{moved_m} m, {sensors:?}");
    }
}

/// The reverse: the motor reading stands, the scale moves. Without limits for command and velocity, which would notice it as well:
/// the axis is pushed while its command rests.
#[test]
fn a_motor_reading_that_stands_while_the_scale_moves_switches_the_drives_off() {
    for sign in [1.0, -1.0] {
        let settings = AxisSettings { sensors: Sensors::Table(WIDE), ..axis() };
        let mut machine = Machine::<Fixed, 1>::new(RATES, &[settings], [Position(0)]).unwrap();
        machine.enable();
        let mut last_um = 0.0;
        for um in 0..1000 {
            last_um = f64::from(um);
            let table = Position::from_m(sign * 1e-6 * last_um);
            machine.tick(&[Reading { motor: Position(0), table }]);
            if !machine.power().is_on() {
                break;
            }
        }
        assert_eq!(machine.power(), Power::Faulted(on(0, FaultKind::EncoderFrozen)));
        // 46/64 of 400 µm: 287.5 µm; the first whole micrometre beyond it.
        assert!((287.9..288.1).contains(&last_um), "{last_um}");
    }
}

/// Motor and scale in slow and fast motion, reversals and a backlash of 0.28 mm between them: no fault.
#[test]
fn readings_that_move_together_are_no_fault() {
    let settings = AxisSettings { sensors: Sensors::Table(WIDE), ..axis() };
    for millimetres_per_tick in [1e-4, 1e-3, 0.1] {
        let config = shared::config::AxisConfig::<Fixed>::new(&settings, RATES).unwrap().monitor;
        let mut state = shared::monitor::State::at(Position(0), Position(0));
        let (mut motor_mm, mut table_mm) = (0.0f64, 0.0f64);
        for tick in 0..400_000 {
            let forwards = tick % 40_000 < 20_000;
            motor_mm += if forwards { millimetres_per_tick } else { -millimetres_per_tick };
            table_mm = table_mm.clamp(motor_mm - 0.14, motor_mm + 0.14);
            let faults = config.position(
                &mut state,
                &shared::monitor::MonitorInput {
                    following_error: Fixed::ZERO,
                    command: position(1e-3 * motor_mm),
                    velocity_command: Fixed::ZERO,
                    motor: position(1e-3 * motor_mm),
                    table: Some(position(1e-3 * table_mm)),
                    uses_scale: true,
                },
            );
            assert!(faults.is_empty(), "{motor_mm} {table_mm}");
        }
    }
}

/// A scale that is lost and returns elsewhere has not moved there, and a loop on the motor alone is not compared.
#[test]
fn a_scale_that_returns_has_not_moved() {
    let mut plant = TestPlant::<Fixed>::new(&AxisSettings { sensors: Sensors::Table(WIDE), ..axis() });
    plant.run(16_000);
    plant.scale = false;
    plant.run(100);
    (plant.scale, plant.scale_off_m) = (true, 5e-3);
    plant.run(4);
    assert_eq!(plant.machine.power(), Power::On);
    let mut plant = TestPlant::<Fixed>::new(&AxisSettings { sensors: Sensors::MOTOR, ..axis() });
    plant.run(1600);
    plant.scale_frozen_m = Some(0.0);
    plant.run(8000);
    assert_eq!(plant.machine.power(), Power::On);
}

/// A loop with a scale has both limits. The greatest distance with one reading standing is 0.5 mm.
#[test]
fn the_limits_of_a_loop_with_a_scale_are_refused_by_name_outside_of_their_range() {
    let error_of = |limits| {
        let settings = AxisSettings { sensors: Sensors::Table(limits), ..axis() };
        Machine::<Fixed, 2>::new(RATES, &[settings; 2], [Position(0); 2]).err()
    };
    let at = |error| Some(MachineError::Config { axis: 0, error });
    for limits in
        [LIMITS, ScaleLimits { frozen_m: ScaleLimits::MOST_FROZEN_M, ..LIMITS }, ScaleLimits::DEFAULT]
    {
        assert_eq!(error_of(limits), None, "{limits:?}");
    }
    let frozen = "frozen_encoder_limit_m";
    for frozen_m in [0.0, -1e-4] {
        assert_eq!(error_of(ScaleLimits { frozen_m, ..LIMITS }), at(ConfigError::NotPositive(frozen)));
    }
    let out_of_range = ConfigError::OutOfRange { name: frozen, min: 0.0, max: 0.5e-3 };
    for frozen_m in [0.5001e-3, 1.0] {
        assert_eq!(error_of(ScaleLimits { frozen_m, ..LIMITS }), at(out_of_range));
    }
    let not_finite = at(ConfigError::NotFinite("scale_disagreement_limit_m"));
    assert_eq!(error_of(ScaleLimits { disagreement_m: f64::NAN, ..LIMITS }), not_finite);
}

/// A frozen limit above the following error's would not be reached.
#[test]
fn a_frozen_limit_is_at_most_the_following_error_limit() {
    for (frozen_m, max) in [(0.2e-3, None), (0.3001e-3, Some(0.3e-3))] {
        for sensors in [
            Sensors::Motor { scale_disagreement_limit_m: None, frozen_encoder_limit_m: Some(frozen_m) },
            Sensors::Table(ScaleLimits { frozen_m, ..LIMITS }),
        ] {
            let settings = AxisSettings { sensors, following_error_limit_m: 0.3e-3, ..axis() };
            let error = Machine::<Fixed, 2>::new(RATES, &[settings; 2], [Position(0); 2]).err();
            let name = "frozen_encoder_limit_m";
            let expected = max.map(|max| ConfigError::OutOfRange { name, min: 0.0, max });
            assert_eq!(error, expected.map(|error| MachineError::Config { axis: 0, error }));
        }
    }
}

/// An origin that shifts one of the readings and not the other is no motion of one of them.
#[test]
fn an_origin_is_no_motion_of_one_sensor() {
    use shared::feedback::OriginShift;
    let millimetre = position(1e-3).0;
    for shift in [OriginShift { motor: millimetre, table: 0 }, OriginShift { motor: 0, table: millimetre }] {
        let settings = AxisSettings { sensors: Sensors::Table(WIDE), ..axis() };
        let mut machine = Machine::<Fixed, 1>::new(RATES, &[settings], [Position(0)]).unwrap();
        let reading = Reading { motor: Position(0), table: Some(Position(0)) };
        machine.enable();
        machine.tick(&[reading]);
        machine.set_origin(0, shift).unwrap();
        for _ in 0..10 {
            assert!(machine.tick(&[reading.shifted(shift)]).enabled, "{shift:?}: {:?}", machine.power());
        }
    }
}
