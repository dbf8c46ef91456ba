//! The force feed-forward against its equations, computed here in f64 from the motion itself.

use super::*;

/// x(t) = A·(1 − cos ωt): reversals at rest, from 0 to 2A.
#[derive(Clone, Copy)]
pub struct Stroke {
    amplitude_m: f64,
    omega: f64,
}

impl Stroke {
    /// Position, velocity and acceleration at a time.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let (sine, cosine) = (self.omega * t).sin_cos();
        let speed = self.amplitude_m * self.omega;
        [self.amplitude_m * (1.0 - cosine), speed * sine, speed * self.omega * cosine]
    }
}

/// The settings of a model without limits that would show: 1 MN/s is 250 N per tick.
pub fn settings(model: ForceModel) -> CompensationSettings {
    CompensationSettings {
        force: Some(model),
        force_bound_n: 5000.0,
        force_rate_n_per_s: 4e6,
        ..CompensationSettings::default()
    }
}

/// Greatest difference between the added force and an expected one in the ticks `from` to 8000 of a stroke, and the
/// greatest expected force, N. The expected force is that in the middle of the interval over which the acceleration is a
/// second difference, one tick before the command.
fn worst<S: Scalar>(
    stroke: Stroke,
    model: &ForceModel,
    from: u32,
    mut expected: impl FnMut(f64, [f64; 3]) -> f64,
) -> [f64; 2] {
    let settings = settings(model.clone());
    let mut plant = TwoAxes::<S>::new([&settings, &CompensationSettings::default()]);
    let (mut worst, mut greatest) = (0.0f64, 0.0f64);
    for k in 1..8000 {
        let t = f64::from(k) / RATE_HZ;
        let [x, ..] = stroke.at(t);
        plant.tick([x, 0.0], [x, 0.0]);
        let exact = expected(t, stroke.at(t - 0.5 / RATE_HZ));
        if k >= from {
            worst = worst.max((plant.added[2][0] - exact).abs());
            greatest = greatest.max(exact.abs());
        }
    }
    [worst, greatest]
}

pub const SLOW: Stroke = Stroke { amplitude_m: 0.02, omega: TAU };

/// Masses, viscous friction and its asymmetry, share: F = 0.7·(50 kg·a + 800·v + 200·|v|). The acceleration is half a tick
/// older than the velocity: 50·jerk·0.125 ms, and jerk = Aω³ = 5 m/s³, is 0.03 N. A step of the acceleration in fixed
/// point, 4 kHz: 2⁻¹⁴·16 nm·rate²/2¹⁰ is 15 nm/s²; of the velocity, 4 µm/s times 1000 N·s/m, 4 mN.
fn follows_masses_and_viscous_friction<S: Scalar>() {
    let model = ForceModel {
        motor_mass_kg: 20.0,
        table_mass_kg: 30.0,
        friction: TableFriction {
            viscous_n_s_per_m: 800.0,
            half_difference_n_s_per_m: 200.0,
            ..TableFriction::default()
        },
        share: 0.7,
        ..ForceModel::default()
    };
    let [worst, greatest] =
        worst::<S>(SLOW, &model, 10, |_, [_, v, a]| 0.7 * (50.0 * a + 800.0 * v + 200.0 * v.abs()));
    assert!((80.0..150.0).contains(&greatest), "{greatest}");
    assert!(worst < 0.04 && worst > 0.005, "{}: {worst} N of {greatest} N", S::NAME);
}

/// A first-order lag of T = 8 ms: in the steady state of a sine, v is smaller by 1/√(1 + (ωT)²) and later by atan(ωT). The
/// filter is a backward difference: its phase is that of the lag to ωT·(ω·tick/2), 4e-5.
fn follows_a_lagging_axis<S: Scalar>() {
    let model = ForceModel {
        friction: TableFriction { viscous_n_s_per_m: 1000.0, ..TableFriction::default() },
        lag_s: 8e-3,
        ..ForceModel::default()
    };
    let phase = (TAU * 8e-3f64).atan();
    let gain = (1.0 + (TAU * 8e-3f64).powi(2)).sqrt().recip();
    let [lagging, greatest] = worst::<S>(SLOW, &model, 500, |t, _| {
        1000.0 * gain * 0.02 * TAU * (TAU * (t - 0.5 / RATE_HZ) - phase).sin()
    });
    assert!((120.0..126.0).contains(&greatest), "{greatest}");
    assert!(lagging < 0.03, "{}: {lagging} N", S::NAME);
    // Without the lag the difference is that of the phase, 0.05 rad of 125 N.
    let model = ForceModel { lag_s: 0.0, ..model };
    let [early, _] = worst::<S>(SLOW, &model, 500, |t, _| {
        1000.0 * gain * 0.02 * TAU * (TAU * (t - 0.5 / RATE_HZ) - phase).sin()
    });
    assert!((5.0..8.0).contains(&early), "{early}");
}

/// Sliding friction of motor and table with a rise towards standstill, without bristles: g(v)·tanh(v / 0.2 mm/s). The curves
/// are linear between points that are an eighth of an octave apart: errors of 0.21 % of tanh and 0.48 % of the excess, and of the product
/// where both change.
fn follows_sliding_friction<S: Scalar>() {
    let stribeck = Some(Stribeck { excess_n: 40.0, velocity_m_per_s: 5e-3 });
    let model = ForceModel {
        motor_coulomb_n: 30.0,
        motor_stribeck: stribeck,
        friction: TableFriction { coulomb_n: 80.0, stribeck, ..TableFriction::default() },
        ..ForceModel::default()
    };
    let [worst, greatest] = worst::<S>(SLOW, &model, 10, |_, [_, v, _]| {
        (110.0 + 80.0 * (-(v / 5e-3).powi(2)).exp()) * (v / 0.2e-3).tanh()
    });
    assert!((165.0..190.0).contains(&greatest), "{greatest}");
    assert!(worst < 0.8 && worst > 0.01, "{}: {worst} N of {greatest} N", S::NAME);
}

/// Bristles: dF = σ₀·dx − σ₀·|dx|·F/g(v), integrated here in 400 steps a tick. Slow strokes reverse many ticks long within the
/// presliding distance of 2 µm, fast ones in a few.
fn follows_presliding<S: Scalar>(stroke: Stroke, bound_n: f64) {
    let (coulomb_n, excess_n, vs, sigma) = (100.0, 40.0, 4e-3, 50e6);
    let model = ForceModel {
        friction: TableFriction {
            coulomb_n,
            presliding_stiffness_n_per_m: Some(sigma),
            stribeck: Some(Stribeck { excess_n, velocity_m_per_s: vs }),
            ..TableFriction::default()
        },
        ..ForceModel::default()
    };
    let (mut friction, mut last) = (0.0, 0.0);
    let [worst, greatest] = worst::<S>(stroke, &model, 1, |t, _| {
        let [x, ..] = stroke.at(t);
        let (dx, v) = ((x - last) / 400.0, (x - last) * RATE_HZ);
        let level = coulomb_n + excess_n * f64::exp(-(v / vs).powi(2));
        for _ in 0..400 {
            friction += sigma * dx - sigma * dx.abs() / level * friction;
        }
        last = x;
        friction
    });
    assert!(greatest > coulomb_n && greatest < coulomb_n + excess_n, "{greatest}");
    // The rounding of a force to 61 µN must show.
    assert!(worst < bound_n && worst > 61e-6, "{}: {worst} N of {greatest} N", S::NAME);
}

/// Friction over the position, and that of a cold machine: (100 N + map(x) + 30 N·e^(−t/τ))·direction. Where the direction is
/// ±1, 10 ms after a reversal.
fn follows_additional_friction<S: Scalar>(stiffness: Option<f64>, [has_map, is_cold]: [bool; 2]) {
    let model = ForceModel {
        friction: TableFriction {
            coulomb_n: 100.0,
            presliding_stiffness_n_per_m: stiffness,
            stribeck: Some(Stribeck { excess_n: 40.0, velocity_m_per_s: 4e-3 }),
            map: has_map.then(|| points(-0.3, 0.01, |x| 500.0 * x)),
            warm_up: is_cold.then_some(FrictionWarmUp { force_n: 30.0, time_constant_s: 0.5 }),
            ..TableFriction::default()
        },
        ..ForceModel::default()
    };
    let mut worst = 0.0f64;
    let stroke = SLOW;
    let bench_settings = settings(model);
    let mut plant = TwoAxes::<S>::new([&bench_settings, &CompensationSettings::default()]);
    for k in 1..8000 {
        let t = f64::from(k) / RATE_HZ;
        let [x, v, _] = stroke.at(t);
        plant.tick([x, 0.0], [x, 0.0]);
        let from_reversal = (t + 1e-9) % 0.5;
        if (0.05..0.45).contains(&from_reversal) {
            let map = if has_map { 500.0 * x } else { 0.0 };
            let cold = if is_cold { 30.0 * (-t / 0.5).exp() } else { 0.0 };
            let exact = (100.0 + map + cold) * v.signum();
            worst = worst.max((plant.added[2][0] - exact).abs());
        }
    }
    // At 39 mm/s the excess is 0; the decay over time is linear within an eighth of an octave, 30 N·0.0021; the map is
    // evaluated with every command: half a tick of 0.125 m/s·500 N/m, 8 mN, which must show; without one of both, the rounding of a force to 61 µN.
    let least = if has_map && is_cold { 1e-3 } else { 61e-6 };
    assert!(worst < 0.1 && worst > least, "{} {stiffness:?}: {worst} N", S::NAME);
}

fn all<S: Scalar>() {
    follows_masses_and_viscous_friction::<S>();
    follows_a_lagging_axis::<S>();
    follows_sliding_friction::<S>();
    // Per tick at the reversal A·ω²·tick²/2: 0.1 nm, 25 nm. g(v) is that of 0.48 % of the excess; u³/1536 of e^(−u) per tick.
    follows_presliding::<S>(Stroke { amplitude_m: 50e-6, omega: 0.5 * TAU }, 0.3);
    follows_presliding::<S>(SLOW, 0.3);
    for parts in [[true, true], [true, false], [false, true]] {
        follows_additional_friction::<S>(None, parts);
    }
    follows_additional_friction::<S>(Some(50e6), [true, true]);
}

#[test]
fn the_force_follows_its_model() {
    all::<Fixed>();
    all::<f32>();
    all::<f64>();
}

/// The force on the table without that on the motor, times 1/stiffness: the command is ahead by the deflection of the drive,
/// also if the force itself is switched off.
fn stretch_follows_the_force<S: Scalar>(is_applied: bool) {
    let model = ForceModel {
        motor_mass_kg: 300.0,
        table_mass_kg: 100.0,
        motor_coulomb_n: 50.0,
        friction: TableFriction { viscous_n_s_per_m: 800.0, ..TableFriction::default() },
        share: 0.5,
        ..ForceModel::default()
    };
    let settings = CompensationSettings { stretch_m_per_n: Some(1e-8), ..settings(model) };
    let mut plant = TwoAxes::<S>::new([&settings, &CompensationSettings::default()]);
    plant.all.switch(0, CompensationKind::Force, is_applied);
    let mut worst = 0.0f64;
    for k in 1..4000 {
        let t = f64::from(k) / RATE_HZ;
        let [x, ..] = SLOW.at(t);
        plant.tick([x, 0.0], [x, 0.0]);
        let [_, v, a] = SLOW.at(t - 0.5 / RATE_HZ);
        if k > 100 {
            worst = worst.max((plant.added[0][0] - 1e-8 * (100.0 * a + 800.0 * v)).abs());
        }
        assert_eq!(is_applied, plant.added[2][0] != 0.0, "tick {k}");
    }
    // 1.3 µm at most; half a tick of the jerk, 100 kg·5 m/s³·0.125 ms = 0.06 N, is 0.6 nm; steps of 62 pm.
    assert!(worst < 0.8e-9 && worst > 1e-11, "{}: {worst} m", S::NAME);
}

#[test]
fn the_stretch_follows_the_force_on_the_table() {
    for is_applied in [true, false] {
        stretch_follows_the_force::<Fixed>(is_applied);
        stretch_follows_the_force::<f32>(is_applied);
        stretch_follows_the_force::<f64>(is_applied);
    }
}
