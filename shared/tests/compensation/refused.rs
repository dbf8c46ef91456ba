//! Settings that are refused, by name.

use super::*;

#[test]
fn rejected_settings_are_named() {
    let error_of = |settings: CompensationSettings| {
        AxisCompensation::<Fixed>::new(&settings, RATES, FIRST_AXIS).unwrap_err()
    };
    let none = CompensationSettings::default;
    let cases = vec![
        (CompensationSettings { backlash_width_m: Some(-1e-6), ..none() }, "backlash_width_m"),
        (CompensationSettings { backlash_width_m: Some(f64::NAN), ..none() }, "backlash_width_m"),
        (CompensationSettings { backlash_width_m: Some(3e-3), ..none() }, "backlash_width_m"),
        (CompensationSettings { squareness: Some((2, 1e-6)), ..none() }, "squareness[0]"),
        (CompensationSettings { squareness: Some((0, 1e-6)), ..none() }, "squareness[0]"),
        (CompensationSettings { squareness: Some((1, f64::INFINITY)), ..none() }, "squareness[1]"),
        (
            CompensationSettings { straightness: Some((0, Straightness::Quadratic(1e-6))), ..none() },
            "straightness[0]",
        ),
        (CompensationSettings { crosstalk: Some((7, Talk::Constant(0.0))), ..none() }, "crosstalk[0]"),
        (CompensationSettings { intalk: Some(Talk::Constant(1.0)), ..none() }, "intalk.Constant"),
        (
            CompensationSettings {
                dividing: [Cycle::harmonic(2e-3, 2.5e-3, 0.0)].into_iter().collect(),
                ..none()
            },
            "dividing[0].values",
        ),
        (
            CompensationSettings { ripple: [Cycle::harmonic(1.0, 0.0, 0.0)].into_iter().collect(), ..none() },
            "ripple[0].period_m",
        ),
        (
            CompensationSettings {
                ripple: [Cycle { period_m: 1e-3, values: [1.0].into_iter().collect() }].into_iter().collect(),
                ..none()
            },
            "ripple[0].values",
        ),
        (
            CompensationSettings {
                reversal: Some(Reversal { force_n: 1.0, decay_s: 0.0, fade_m_per_s: 1.0 }),
                ..none()
            },
            "reversal.decay_s",
        ),
        (CompensationSettings { position_bound_m: 0.0, ..none() }, "position_bound_m"),
        (CompensationSettings { position_rate_m_per_s: f64::NAN, ..none() }, "position_rate_m_per_s"),
        (CompensationSettings { force_bound_n: f64::INFINITY, ..none() }, "force_bound_n"),
        (CompensationSettings { force_rate_n_per_s: -1.0, ..none() }, "force_rate_n_per_s"),
    ];
    for (settings, name) in cases {
        assert_eq!(error_of(settings).name(), name);
    }
}
/// A rate that fixed point does not hold to 1 % is rejected with its range.
#[test]
fn rates_below_the_resolution_are_rejected() {
    let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
    let error_of = |position_rate_m_per_s: f64, force_rate_n_per_s: f64| {
        let settings = CompensationSettings {
            position_rate_m_per_s,
            force_rate_n_per_s,
            ..CompensationSettings::default()
        };
        AxisCompensation::<Fixed>::new(&settings, rates, FIRST_AXIS).err()
    };
    assert!(matches!(
        error_of(1e-7, 1e4),
        Some(ConfigError::OutOfRange { name: "position_rate_m_per_s", .. })
    ));
    // The least rate is 50 steps of 2⁻¹⁴ N per tick at 20 kHz: 61 N/s.
    assert!(
        matches!(error_of(1e-3, 1.0), Some(ConfigError::OutOfRange { name: "force_rate_n_per_s", min, .. })
        if (61.0..61.1).contains(&min))
    );
    assert_eq!(error_of(1e-3, 100.0), None);
}

/// The setting of a force model that is refused.
fn refused(model: ForceModel) -> Option<&'static str> {
    let settings = CompensationSettings { force: Some(model), ..CompensationSettings::default() };
    AxisCompensation::<Fixed>::new(&settings, RATES, FIRST_AXIS).err().map(|error| error.name())
}

const fn stribeck(excess_n: f64, velocity_m_per_s: f64) -> Stribeck {
    Stribeck { excess_n, velocity_m_per_s }
}

#[test]
fn rejected_models_are_named() {
    let none = ForceModel::default;
    assert_eq!(refused(none()), None);
    let cases = vec![
        (ForceModel { motor_mass_kg: -1.0, ..none() }, "force.motor_mass_kg"),
        (ForceModel { table_mass_kg: f64::NAN, ..none() }, "force.table_mass_kg"),
        (ForceModel { table_mass_kg: 1e9, ..none() }, "force.table_mass_kg"),
        (ForceModel { motor_coulomb_n: 1001.0, ..none() }, "force.motor_coulomb_n"),
        (
            ForceModel { motor_stribeck: Some(stribeck(1.0, 0.0)), ..none() },
            "force.motor_stribeck.velocity_m_per_s",
        ),
        (ForceModel { load: Some(points(0.0, 0.01, |_| 1001.0)), ..none() }, "force.load.values"),
        (ForceModel { lag_s: -1e-3, ..none() }, "force.lag_s"),
        (ForceModel { lag_s: 2.0, ..none() }, "force.lag_s"),
        (ForceModel { share: 1.1, ..none() }, "force.share"),
    ];
    for (model, name) in cases {
        assert_eq!(refused(model), Some(name));
    }
}

#[test]
fn rejected_frictions_are_named() {
    let friction = |friction: TableFriction| ForceModel { friction, ..ForceModel::default() };
    let table = TableFriction { coulomb_n: 100.0, ..TableFriction::default() };
    let warm_up = |force_n, time_constant_s| TableFriction {
        warm_up: Some(FrictionWarmUp { force_n, time_constant_s }),
        ..table.clone()
    };
    assert_eq!(refused(friction(table.clone())), None);
    let cases = vec![
        (friction(TableFriction { coulomb_n: -1.0, ..table.clone() }), "force.friction.coulomb_n"),
        (
            friction(TableFriction { viscous_n_s_per_m: -1.0, ..table.clone() }),
            "force.friction.viscous_n_s_per_m",
        ),
        (
            friction(TableFriction { half_difference_n_s_per_m: f64::INFINITY, ..table.clone() }),
            "force.friction.half_difference_n_s_per_m",
        ),
        (
            friction(TableFriction { stribeck: Some(stribeck(-101.0, 0.01)), ..table.clone() }),
            "force.friction.stribeck.excess_n",
        ),
        (
            friction(TableFriction { stribeck: Some(stribeck(1001.0, 0.01)), ..table.clone() }),
            "force.friction.stribeck.excess_n",
        ),
        (
            friction(TableFriction { presliding_stiffness_n_per_m: Some(-1.0), ..table.clone() }),
            "force.friction.presliding_stiffness_n_per_m",
        ),
        (
            friction(TableFriction {
                coulomb_n: 0.0,
                presliding_stiffness_n_per_m: Some(50e6),
                ..table.clone()
            }),
            "force.friction.coulomb_n",
        ),
        (
            friction(TableFriction { map: Some(points(0.0, 0.01, |_| f64::NAN)), ..table.clone() }),
            "force.friction.map.values",
        ),
        (friction(warm_up(2000.0, 100.0)), "force.friction.warm_up.force_n"),
        (friction(warm_up(20.0, 0.0)), "force.friction.warm_up.time_constant_s"),
    ];
    for (model, name) in cases {
        assert_eq!(refused(model), Some(name));
    }
}

#[test]
fn a_stretch_requires_the_force_model() {
    let settings = CompensationSettings { stretch_m_per_n: Some(1e-8), ..CompensationSettings::default() };
    let error = AxisCompensation::<Fixed>::new(&settings, RATES, FIRST_AXIS).unwrap_err();
    assert_eq!(error.to_string(), "stretch_m_per_n: expected together with force, which is missing");
}

/// The compliance is a gain of fixed point, below 128 errors of 1.024 µm per newton.
#[test]
fn a_stretch_has_the_range_of_a_gain() {
    let of = |m_per_n| {
        let force = Some(ForceModel::default());
        let settings =
            CompensationSettings { force, stretch_m_per_n: Some(m_per_n), ..CompensationSettings::default() };
        AxisCompensation::<Fixed>::new(&settings, RATES, FIRST_AXIS).err()
    };
    assert_eq!(of(131e-6), None);
    for m_per_n in [132e-6, -1e-9] {
        let Some(ConfigError::OutOfRange { name: "stretch_m_per_n", min: 0.0, max }) = of(m_per_n) else {
            panic!("{:?}", of(m_per_n))
        };
        assert!((max - 131.072e-6).abs() < 1e-12, "{max}");
    }
}
