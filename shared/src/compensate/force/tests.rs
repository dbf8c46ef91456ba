use super::*;
use crate::compensate::force_settings::Stribeck;

const NOTHING: Surroundings = Surroundings { load: Fixed::ZERO, friction: Fixed::ZERO };

const BOUND_N: f64 = 50_000.0;

fn position(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

fn force(model: &ForceModel, rate_hz: f64) -> Force {
    Force::new(model, [rate_hz, 20_000.0], BOUND_N).unwrap()
}

/// The forces to apply and on the table, N, after ten ticks at a constant velocity.
fn at_velocity(model: &ForceModel, m_per_s: f64) -> [f64; 2] {
    let (model, mut state) = (force(model, 4000.0), State::NEW);
    for k in 1..=10 {
        model.update(&mut state, position(m_per_s * f64::from(k) / 4000.0), NOTHING);
    }
    [state.applied.value(), state.on_table.value()]
}

fn error(model: &ForceModel) -> ConfigError {
    Force::new(model, [4000.0, 20_000.0], BOUND_N).unwrap_err()
}

/// F = m·a up to 190 m/s², at commands from 500 Hz to 20 kHz. The second difference of a·T²·k(k + 1)/2 is a·T² from the first command on; it
/// is rounded to 2⁻²⁰ nm, and to a signal of at most 200/131 072 m/s²: 1.6 N of a ton. A gain of 24 fraction bits has an error of 1e-5.
#[test]
fn a_mass_has_its_force_at_every_rate() {
    let model = ForceModel { table_mass_kg: 200.0, motor_mass_kg: 50.0, share: 0.5, ..ForceModel::default() };
    for rate_hz in [500.0, 1000.0, 4000.0, 8000.0, 20_000.0] {
        for a in [190.0, -190.0, 0.5] {
            let (force, mut state) = (force(&model, rate_hz), State::NEW);
            for k in 1..=2 {
                force.update(
                    &mut state,
                    position(a / rate_hz / rate_hz * f64::from(k * (k + 1) / 2)),
                    NOTHING,
                );
                let [applied, on_table] = [state.applied, state.on_table].map(Fixed::value);
                let bound = 1e-5 * 200.0 * f64::abs(a) + 0.35;
                assert!((on_table - 200.0 * a).abs() < bound, "{rate_hz} Hz, {a}: {on_table} N");
                assert!((applied - 125.0 * a).abs() < bound, "{rate_hz} Hz, {a}: {applied} N");
            }
        }
    }
}

/// Four times the greater width of both is on the curves: at three widths e⁻⁹ of the excess is left, and none at 20.
#[test]
fn a_wide_rise_of_the_friction_is_on_the_curves() {
    let stribeck = Some(Stribeck { excess_n: 400.0, velocity_m_per_s: 0.05 });
    let of_table = ForceModel {
        friction: TableFriction { coulomb_n: 100.0, stribeck, ..TableFriction::default() },
        ..ForceModel::default()
    };
    let of_motor = ForceModel { motor_coulomb_n: 100.0, motor_stribeck: stribeck, ..ForceModel::default() };
    for (model, which) in [(of_table, 1), (of_motor, 0)] {
        for (m_per_s, expected) in [(0.15, 100.0 + 400.0 * (-9.0f64).exp()), (1.0, 100.0), (-1.0, -100.0)] {
            let newton = at_velocity(&model, m_per_s)[which];
            // 0.48 % of the excess is the error of the curve where it is steep; here the tail is straight between two points.
            assert!((newton - expected).abs() < 0.1, "{m_per_s} m/s: {newton} N, {expected} N");
        }
    }
}

/// A gain is below 128, and half of that here. A unit of acceleration at 4 kHz is 16 nm·rate²/2⁷, 2 mm/s², and one of velocity 64 µm/s.
#[test]
fn gains_beyond_half_their_range_are_refused() {
    let mass =
        |motor_mass_kg, table_mass_kg| ForceModel { motor_mass_kg, table_mass_kg, ..ForceModel::default() };
    assert!(Force::new(&mass(31_990.0, 31_990.0), [4000.0, 20_000.0], BOUND_N).is_ok());
    for (model, name) in
        [(mass(32_010.0, 0.0), "force.motor_mass_kg"), (mass(0.0, 32_010.0), "force.table_mass_kg")]
    {
        let ConfigError::OutOfRange { name: found, min, max } = error(&model) else { panic!("{name}") };
        assert!(found == name && min == 0.0 && (max - 32_000.0).abs() < 1e-6, "{found}: {min} to {max}");
    }
    let viscous = |viscous_n_s_per_m, half_difference_n_s_per_m| ForceModel {
        friction: TableFriction { viscous_n_s_per_m, half_difference_n_s_per_m, ..TableFriction::default() },
        ..ForceModel::default()
    };
    for half in [0.399e6, -0.399e6] {
        assert!(Force::new(&viscous(0.6e6, half), [4000.0, 20_000.0], BOUND_N).is_ok());
    }
    for (model, name) in [
        (viscous(1.001e6, 0.0), "force.friction.viscous_n_s_per_m"),
        (viscous(0.6e6, 0.401e6), "force.friction.half_difference_n_s_per_m"),
        (viscous(0.6e6, -0.401e6), "force.friction.half_difference_n_s_per_m"),
    ] {
        let ConfigError::OutOfRange { name: found, min, max } = error(&model) else { panic!("{name}") };
        assert!(found == name && min == 0.0 && (max - 1e6).abs() < 1e-3, "{found}: {min} to {max}");
    }
}

/// The friction of a cold machine is at most the bound in either direction.
#[test]
fn the_friction_of_a_cold_machine_has_its_range() {
    let of = |force_n| {
        let warm_up = Some(FrictionWarmUp { force_n, time_constant_s: 10.0 });
        let friction = TableFriction { warm_up, ..TableFriction::default() };
        Force::new(&ForceModel { friction, ..ForceModel::default() }, [4000.0, 20_000.0], 100.0).err()
    };
    assert_eq!((of(100.0), of(-100.0)), (None, None));
    let name = "force.friction.warm_up.force_n";
    let error = ConfigError::OutOfRange { name, min: -100.0, max: 100.0 };
    assert_eq!((of(100.1), of(-100.1)), (Some(error), Some(error)));
}

/// 100 N within 2 µm.
fn bristles() -> TableFriction {
    TableFriction { coulomb_n: 100.0, presliding_stiffness_n_per_m: Some(50e6), ..TableFriction::default() }
}

/// Bristles that are bent, here by half, stay so.
#[test]
fn a_start_keeps_the_bristles() {
    let friction = bristles();
    let model = force(&ForceModel { friction, ..ForceModel::default() }, 4000.0);
    let mut motion = CommandMotion::<Fixed>::at(position(0.2));
    motion.step(position(0.2 + 25e-6));
    let mut state = State { bristles: -(1 << 59), ..State::NEW };
    model.start(&mut state, &motion);
    assert_eq!((state.bristles, state.position), (-(1 << 59), motion.position));
}

/// A ramp lags by T·v: set in motion at 0.1 m/s with T = 10 ms, the filtered position is 1 mm behind the command, in either direction, and
/// the bristles are bent that way.
#[test]
fn a_start_in_motion_is_that_of_a_steady_motion() {
    let friction = bristles();
    let model = ForceModel { friction, lag_s: 0.01, ..ForceModel::default() };
    for sign in [1.0, -1.0] {
        let mut motion = CommandMotion::<Fixed>::at(position(0.2));
        motion.step(position(0.2 + sign * 25e-6));
        let (model, mut state) = (force(&model, 4000.0), State::NEW);
        model.start(&mut state, &motion);
        let behind_m = (motion.position - state.position) as f64 / PER_M;
        // An increment is rounded to 1 pm, which are 40 pm in 40 ticks.
        assert!((behind_m - sign * 1e-3).abs() < 1e-10, "{behind_m} m");
        for k in 2..20 {
            model.update(&mut state, position(0.2 + sign * 25e-6 * f64::from(k)), NOTHING);
            assert!((state.applied.value() - sign * 100.0).abs() < 0.01, "{k}: {} N", state.applied.value());
        }
    }
}
