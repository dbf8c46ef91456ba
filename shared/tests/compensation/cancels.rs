//! Each compensation cancels its effect and can be switched alone.

use super::*;

/// The expected correction at x and y, m or N.
type Expected = fn(f64, f64) -> f64;

/// A load of 50 N + 100 N/m·x, and nothing else.
fn load() -> ForceModel {
    ForceModel { load: Some(points(-0.3, 0.01, |x| 50.0 + 100.0 * x)), ..ForceModel::default() }
}

/// 20 µm where both positions are 0.2 m.
fn yaw() -> Product {
    let at = |axis| Factor::Position { axis, full_scale_m: 0.2 };
    Product { amplitude_m: 20e-6, factors: [at(0), at(1)].into_iter().collect() }
}

/// Each compensation alone on the first axis, with its channel in [`TwoAxes::added`] and the correction expected there at
/// (x, y) after a motion in + direction.
fn items() -> Vec<(CompensationKind, CompensationSettings, usize, Expected)> {
    let none = CompensationSettings::default;
    let slope = || points(-0.3, 0.01, |x| 30e-6 * x);
    vec![
        // table = motor + 30 µm/m·motor.
        (
            CompensationKind::Pitch,
            CompensationSettings {
                pitch: Some(Pitch { of: PitchSource::Screw, forward: slope(), backward: None }),
                ..none()
            },
            0,
            |x, _| -30e-6 * x,
        ),
        // table = motor − half the width after a motion in + direction.
        (
            CompensationKind::Backlash,
            CompensationSettings { backlash_width_m: Some(8e-6), ..none() },
            0,
            |_, _| 4e-6,
        ),
        // reading = motor + 2 µm·sin(…).
        (
            CompensationKind::Dividing,
            CompensationSettings {
                dividing: [Cycle::harmonic(2e-6, 2.5e-3, 0.4)].into_iter().collect(),
                ..none()
            },
            1,
            |x, _| -2e-6 * (TAU * x / 2.5e-3 + 0.4).sin(),
        ),
        // tool x = … + 40 µm/m·y.
        (
            CompensationKind::Squareness,
            CompensationSettings { squareness: Some((1, 40e-6)), ..none() },
            0,
            |_, y| -40e-6 * y,
        ),
        // tool x = … + 50 µm/m²·y².
        (
            CompensationKind::Straightness,
            CompensationSettings { straightness: Some((1, Straightness::Quadratic(50e-6))), ..none() },
            0,
            |_, y| -50e-6 * y * y,
        ),
        // Force on the motor = force + 6 N·sin(…).
        (
            CompensationKind::Ripple,
            CompensationSettings {
                ripple: [Cycle::harmonic(6.0, 5e-3, 0.2)].into_iter().collect(),
                ..none()
            },
            2,
            |x, _| -6.0 * (TAU * x / 5e-3 + 0.2).sin(),
        ),
    ]
}

/// More of them: periodic error of the screw, drift, and what follows from a load.
fn more_items() -> Vec<(CompensationKind, CompensationSettings, usize, Expected)> {
    let none = CompensationSettings::default;
    vec![
        // table = motor + 2 µm·sin(…) + 0.8 µm·sin(…): the lead, and a belt of 7 mm.
        (
            CompensationKind::Screw,
            CompensationSettings {
                screw: [Cycle::harmonic(2e-6, 10e-3, 0.7), Cycle::harmonic(0.8e-6, 7e-3, -0.2)]
                    .into_iter()
                    .collect(),
                ..none()
            },
            0,
            |x, _| -2e-6 * (TAU * x / 10e-3 + 0.7).sin() - 0.8e-6 * (TAU * x / 7e-3 - 0.2).sin(),
        ),
        // tool = table + 3 µm from 0.5 s on (the second end of TwoAxes::settle is at 1 s).
        (
            CompensationKind::Drift,
            CompensationSettings {
                drift: Some(TimePoints {
                    start_s: 0.0,
                    spacing_s: 0.5,
                    values: [0.0, 3e-6].into_iter().collect(),
                }),
                ..none()
            },
            0,
            |_, _| -3e-6,
        ),
        // tool = table + 500 µm/m²·x·y: the yaw of the other guideway times the lever.
        (
            CompensationKind::Products,
            CompensationSettings { products: [yaw()].into_iter().collect(), ..none() },
            0,
            |x, y| -500e-6 * x * y,
        ),
        // At rest the force on the table is the load, 50 N + 100 N/m·x; 1/(100 N/µm).
        (
            CompensationKind::Stretch,
            CompensationSettings { stretch_m_per_n: Some(1e-8), force: Some(load()), ..none() },
            0,
            |x, _| 1e-8 * (50.0 + 100.0 * x),
        ),
        (CompensationKind::Force, CompensationSettings { force: Some(load()), ..none() }, 2, |x, _| {
            50.0 + 100.0 * x
        }),
    ]
}

/// Tolerance 4 nm and 10 mN. Linear interpolation between the 64 points of a cycle has an error of (2π/64)²/8 = 1.2e-3 of
/// the amplitude, 2.4 nm (3.4 nm for the two of the screw) and 7.2 mN; the rest is for the number format.
fn cancels<S: Scalar>(to: [f64; 2]) {
    for (item, settings, channel, expected) in items().into_iter().chain(more_items()) {
        let mut plant = TwoAxes::<S>::new([&settings, &CompensationSettings::default()]);
        plant.settle([to[0] - 0.02, to[1] - 0.02], to);
        let (added, exact) = (plant.added[channel][0], expected(to[0], to[1]));
        let tolerance = if channel == 2 { 10e-3 } else { 4e-9 };
        assert!((added - exact).abs() < tolerance, "{} {item:?}: {added:e}, expected {exact:e}", S::NAME);
        // Switched off the correction is zero; switched on again it has the same value.
        plant.all.switch(0, item, false);
        plant.settle(to, to);
        assert!(plant.added[channel][0].abs() < 1e-12, "{item:?} off: {:e}", plant.added[channel][0]);
        plant.all.switch(0, item, true);
        plant.settle(to, to);
        assert!((plant.added[channel][0] - added).abs() < 1e-12, "{item:?} switched on again");
    }
}

/// In-talk and cross-talk on a circle of radius 2 mm at 8 Hz: the correction is −c·a, with the acceleration a of the same
/// or of the other axis. The second difference lags by one tick: an error of ω/rate = 1.3 % of the amplitude. The
/// coefficient, 0.3 in machine units, is rounded to 2⁻¹⁴: at most 1e-4 of it.
fn cancels_talk<S: Scalar>(cross: bool) {
    let (c, omega, radius) = (1.2e-6, TAU * 8.0, 2e-3);
    let settings = if cross {
        CompensationSettings { crosstalk: Some((1, Talk::Constant(c))), ..CompensationSettings::default() }
    } else {
        CompensationSettings { intalk: Some(Talk::Constant(c)), ..CompensationSettings::default() }
    };
    let mut plant = TwoAxes::<S>::new([&settings, &CompensationSettings::default()]);
    let mut worst = 0.0f64;
    for k in 0..8000 {
        let angle = omega * f64::from(k) / RATE_HZ;
        let positions = [radius * angle.cos(), radius * angle.sin()];
        plant.tick(positions, positions);
        let acceleration = -omega * omega * if cross { positions[1] } else { positions[0] };
        if k > 4000 {
            worst = worst.max((plant.added[0][0] + c * acceleration).abs());
        }
    }
    let amplitude = c * omega * omega * radius;
    assert!(worst < 0.016 * amplitude, "{}: {worst:e} of {amplitude:e}", S::NAME);
    assert!(worst > 0.001 * amplitude, "{}: {worst:e}, expected the delay of a tick", S::NAME);
}

#[test]
fn in_talk_and_cross_talk_are_cancelled() {
    for cross in [false, true] {
        cancels_talk::<Fixed>(cross);
        cancels_talk::<f32>(cross);
        cancels_talk::<f64>(cross);
    }
}

/// Each direction of travel has its own table. The error of a screw is subtracted from the command, that of a scale
/// is added.
#[test]
fn pitch_correction_depends_on_direction_and_source() {
    let table = |value: f64| points(-0.3, 0.01, move |_| value);
    let both = |of| CompensationSettings {
        pitch: Some(Pitch { of, forward: table(2e-6), backward: Some(table(5e-6)) }),
        ..CompensationSettings::default()
    };
    for (of, sign) in [(PitchSource::Screw, -1.0), (PitchSource::Scale, 1.0)] {
        let mut plant = TwoAxes::<Fixed>::new([&both(of), &CompensationSettings::default()]);
        for (from, to, value) in [(0.0, 0.05, 2e-6), (0.05, 0.02, 5e-6), (0.02, 0.03, 2e-6)] {
            plant.settle([from, 0.0], [to, 0.0]);
            assert!((plant.added[0][0] - sign * value).abs() < 1e-10, "{of:?}: {:e}", plant.added[0][0]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 1 } else { 12 }))]

    #[test]
    fn each_compensation_cancels_its_effect_and_can_be_switched_alone(x in -0.2..0.2f64, y in -0.2..0.2f64) {
        cancels::<Fixed>([x, y]);
        cancels::<f32>([x, y]);
        cancels::<f64>([x, y]);
    }
}

/// The corrections of which few machines have one, together and with no other: the sum of both, to two steps of 62 pm and the rounding of each.
#[test]
fn a_screw_and_a_product_add_up() {
    let of = |has_screw: bool, has_product: bool| {
        let factors = [Factor::Position { axis: 1, full_scale_m: 0.1 }].into_iter().collect();
        let settings = CompensationSettings {
            screw: has_screw.then(|| Cycle::harmonic(20e-6, 5e-3, 1.0)).into_iter().collect(),
            products: has_product.then_some(Product { amplitude_m: 30e-6, factors }).into_iter().collect(),
            ..CompensationSettings::default()
        };
        let mut plant = TwoAxes::<Fixed>::new([&settings, &CompensationSettings::default()]);
        plant.settle([0.0; 2], [0.012, 0.06]);
        plant.added[0][0]
    };
    let (screw, product) = (of(true, false), of(false, true));
    // −20 µm·sin(2π·2.4 + 1) to the 1.2e-3 of the amplitude of the curve, and −30 µm·0.6.
    assert!((screw + 20e-6 * (TAU * 2.4 + 1.0).sin()).abs() < 30e-9, "{screw}");
    assert!((product + 18e-6).abs() < 1e-9, "{product}");
    assert!((of(true, true) - screw - product).abs() < 0.3e-9);
}
