//! No correction exceeds its declared rate or bound.

use super::*;

/// Settings of all compensations, each present or absent, of random magnitude, for an axis whose other axis is `other`.
fn any_settings(other: u8) -> impl Strategy<Value = CompensationSettings> {
    let sizes = (0.0..1.0f64, 0.0..1.0f64, 0.0..1.0f64, any::<[bool; 14]>(), 1e-3..0.1f64, 1e3..1e6f64);
    sizes.prop_map(move |(a, b, c, has, position_rate_m_per_s, force_rate_n_per_s)| CompensationSettings {
        pitch: has[0].then(|| Pitch {
            of: PitchSource::Screw,
            forward: points(-0.3, 0.01, |x| 20e-6 * a * (40.0 * x).sin()),
            backward: Some(points(-0.3, 0.01, |x| 20e-6 * b * (70.0 * x).cos())),
        }),
        backlash_width_m: has[1].then_some(30e-6 * a),
        dividing: has[2].then(|| Cycle::harmonic(20e-6 * b, 2.5e-3, a)).into_iter().collect(),
        reversal: has[3].then_some(Reversal {
            force_n: 100.0 * a,
            decay_s: 0.05 * b + 1e-3,
            fade_m_per_s: c + 0.01,
        }),
        intalk: has[4].then(|| Talk::Over(points(-0.3, 0.01, |x| 1e-5 * (a - x)))),
        crosstalk: has[5].then_some((other, Talk::Constant(-2e-5 * b))),
        squareness: has[6].then_some((other, 1e-3 * c)),
        straightness: has[7].then_some((other, Straightness::Quadratic(1e-3 * a))),
        ripple: has[8].then(|| Cycle::harmonic(100.0 * c, 1e-3, b)).into_iter().collect(),
        screw: has[9]
            .then(|| [Cycle::harmonic(20e-6 * a, 5e-3, b), Cycle::harmonic(20e-6 * c, 7e-3, a)])
            .into_iter()
            .flatten()
            .collect(),
        force: has[10].then(|| any_force([a, b, c])),
        stretch_m_per_n: (has[10] && has[11]).then_some(1e-7 * b),
        drift: has[12].then(|| TimePoints {
            start_s: -0.1 * a,
            spacing_s: 0.2 + 0.1 * b,
            values: [0.0, 20e-6 * c, -20e-6 * a].into_iter().collect(),
        }),
        products: has[13].then(|| any_products(other, [a, b])).into_iter().flatten().collect(),
        position_bound_m: 20e-6,
        position_rate_m_per_s,
        force_bound_n: 100.0,
        force_rate_n_per_s,
    })
}

/// An acceleration times the other position, and a speed times the direction.
fn any_products(other: u8, [a, b]: [f64; 2]) -> [Product; 2] {
    let factors = [
        [
            Factor::Acceleration { axis: 1 - other, full_scale_m_per_s2: 1.0 + 10.0 * a },
            Factor::Position { axis: other, full_scale_m: 0.1 },
        ],
        [
            Factor::Speed { axis: 1 - other, full_scale_m_per_s: 1.0 + b },
            Factor::Direction { axis: 1 - other },
        ],
    ];
    [(20e-6 * a, factors[0]), (-20e-6 * b, factors[1])]
        .map(|(amplitude_m, factors)| Product { amplitude_m, factors: factors.into_iter().collect() })
}

fn any_force([a, b, c]: [f64; 3]) -> ForceModel {
    let stribeck = Stribeck { excess_n: 50.0 * a, velocity_m_per_s: 1e-3 + 0.05 * b };
    ForceModel {
        motor_mass_kg: 100.0 * a,
        table_mass_kg: 100.0 * b,
        motor_coulomb_n: 100.0 * c,
        motor_stribeck: (a > 0.5).then_some(stribeck),
        friction: TableFriction {
            coulomb_n: 5.0 + 90.0 * b,
            viscous_n_s_per_m: 1000.0 * c,
            half_difference_n_s_per_m: 500.0 * a,
            presliding_stiffness_n_per_m: (c > 0.5).then_some(20e6 + 100e6 * a),
            stribeck: (b > 0.5).then_some(stribeck),
            map: (a > 0.5).then(|| points(-0.3, 0.01, |x| 30.0 * (20.0 * x).sin())),
            warm_up: (b > 0.3).then_some(FrictionWarmUp { force_n: 40.0 * c, time_constant_s: 0.1 }),
        },
        load: (c < 0.5).then(|| points(-0.3, 0.01, |x| 100.0 * b * (9.0 * x).cos())),
        lag_s: 0.02 * c,
        share: a,
    }
}

/// Random lines of 200 ticks, each preceded by switching a compensation or by replacing the settings of the first axis, `first`
/// by `replacement` and back. In every tick each correction is within its bound and changes by no more than its rate.
fn stays_within_rate_and_bound<S: Scalar>(
    [first, second, replacement]: [&CompensationSettings; 3],
    moves: &[([f64; 2], u8)],
) {
    let mut plant = TwoAxes::<S>::new([first, second]);
    let fastest = |rate: fn(&CompensationSettings) -> f64| {
        [first, second, replacement].map(rate).into_iter().fold(0.0, f64::max)
    };
    let m_per_s = fastest(|settings| settings.position_rate_m_per_s);
    let n_per_s = fastest(|settings| settings.force_rate_n_per_s);
    let mut positions = [0.0; 2];
    // More than two steps of a fixed-point signal, 62 pm and 61 µN; f32 and f64 round to less.
    let (step_m, step_n) = (0.2e-9, 2e-4);
    for &(to, action) in moves {
        let from = positions;
        match action {
            0..=13 => plant.all.switch(0, CompensationKind::ALL[usize::from(action)], action % 2 == 0),
            14 => plant.all.replace(0, &AxisCompensation::new(replacement, RATES, FIRST_AXIS).unwrap()),
            15 => plant.all.replace(0, &AxisCompensation::new(first, RATES, FIRST_AXIS).unwrap()),
            _ => CompensationKind::ALL.into_iter().for_each(|item| plant.all.switch(0, item, true)),
        }
        for k in 1..=200 {
            let fraction = f64::from(k) / 200.0;
            positions = [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * fraction);
            let before = plant.added;
            plant.tick(positions, positions);
            let (rate, rise) = (m_per_s / RATE_HZ + step_m, n_per_s / RATE_HZ + step_n);
            #[expect(clippy::needless_range_loop, reason = "of two arrays, one inside the other")]
            for axis in 0..2 {
                for (channel, (bound, most)) in
                    [(20e-6 + step_m, rate), (20e-6 + step_m, rate), (100.0 + step_n, rise)]
                        .into_iter()
                        .enumerate()
                {
                    let (value, change) =
                        (plant.added[channel][axis], plant.added[channel][axis] - before[channel][axis]);
                    assert!(value.abs() <= bound, "{}: channel {channel}: {value:e} of {bound:e}", S::NAME);
                    assert!(change.abs() <= most, "{}: channel {channel}: {change:e} of {most:e}", S::NAME);
                }
            }
        }
    }
}
proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 1 } else { 12 }))]

    /// Up to 0.2 m in 50 ms on each axis, 4 m/s, with reversals within a tick.
    #[test]
    fn corrections_stay_within_rate_and_bound(
        first in any_settings(1), second in any_settings(0), replacement in any_settings(1),
        moves in prop::collection::vec(([-0.1..0.1f64, -0.1..0.1], 0u8..17), 1..12),
    ) {
        let settings = [&first, &second, &replacement];
        stays_within_rate_and_bound::<Fixed>(settings, &moves);
        stays_within_rate_and_bound::<f32>(settings, &moves);
        stays_within_rate_and_bound::<f64>(settings, &moves);
    }
}
/// After the settings are replaced by empty ones, each correction returns to zero at its declared rate.
#[test]
fn a_removed_compensation_fades_out() {
    let dividing = CompensationSettings {
        dividing: [Cycle::harmonic(20e-6, 2.5e-3, 1.5)].into_iter().collect(),
        reversal: Some(Reversal { force_n: 100.0, decay_s: 0.01, fade_m_per_s: 1.0 }),
        ..CompensationSettings::default()
    };
    let none = CompensationSettings::default();
    let mut plant = TwoAxes::<f64>::new([&dividing, &none]);
    plant.settle([0.0; 2], [0.001, 0.0]);
    // A reversal of the command starts the force pulse.
    for k in 0..4 {
        plant.tick([0.001 - 1e-5 * f64::from(k), 0.0], [0.001, 0.0]);
    }
    let before = plant.added;
    assert!(before[1][0].abs() > 1e-6 && before[2][0].abs() > 1.0, "{before:?}");
    plant.all.replace(0, &AxisCompensation::new(&none, RATES, FIRST_AXIS).unwrap());
    let mut last = before;
    for _ in 0..40_000 {
        plant.tick([0.001, 0.0], [0.001, 0.0]);
        for (kind, rate) in [(1, none.position_rate_m_per_s), (2, none.force_rate_n_per_s)] {
            let step = (plant.added[kind][0] - last[kind][0]).abs();
            assert!(step <= rate / RATE_HZ * (1.0 + 1e-6) + 1e-12, "{kind}: {step}");
        }
        last = plant.added;
    }
    assert!(last.iter().all(|added| added[0].abs() < 1e-12), "{last:?}");
}
