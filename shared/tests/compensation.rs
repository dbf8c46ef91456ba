//! Each compensation cancels its effect and can be switched alone. No correction exceeds its declared rate or bound,
//! whatever is set, switched or replaced.
//!
//! The expected corrections are computed here in f64 from the definitions of the effects.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::TAU;

use proptest::prelude::*;
use shared::compensate::settings::{Cycle, Pitch, PitchSource, Points, Reversal, Straightness, Talk};
use shared::compensate::{AxisCompensation, Compensation, CompensationKind, CompensationSettings};
use shared::config::{ConfigError, Rates};
use shared::machine::Reading;
use shared::scalar::{Fixed, Scalar};
use shared::units::{PER_M, Position};

const RATES: Rates = Rates { velocity_loop_hz: 4000.0, position_loop_divider: 1 };
const RATE_HZ: f64 = 4000.0;

fn position(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

fn points(start_m: f64, spacing_m: f64, value: impl Fn(f64) -> f64) -> Points {
    let values = (0..64).map(|k| value(start_m + spacing_m * f64::from(k))).collect();
    Points { start_m, spacing_m, values }
}

struct Bench<S: Scalar> {
    all: Compensation<S, 2>,
    /// Corrections of the last tick by channel: commands (m), motor readings (m), forces (N).
    added: [[f64; 2]; 3],
}

impl<S: Scalar> Bench<S> {
    fn new(settings: [&CompensationSettings; 2]) -> Self {
        let mut all = Compensation::none([position(0.0); 2]);
        for (axis, settings) in settings.into_iter().enumerate() {
            all.replace(axis, AxisCompensation::new(settings, RATES, 2).unwrap());
        }
        Self { all, added: [[0.0; 2]; 3] }
    }

    fn tick(&mut self, command_m: [f64; 2], motor_m: [f64; 2]) {
        let raw = motor_m.map(|m| Reading { motor: position(m), table: None });
        let readings = self.all.readings(&raw);
        let commands = self.all.commands(&command_m.map(position));
        let forces = self.all.forces(&readings);
        for axis in 0..2 {
            self.added[0][axis] = commands[axis] as f64 / PER_M;
            self.added[1][axis] = (readings[axis].motor - raw[axis].motor) as f64 / PER_M;
            self.added[2][axis] = forces[axis].value();
        }
    }

    /// 2000 ticks in a straight line, then 2000 ticks at rest, in which the rate limiters reach their targets.
    fn settle(&mut self, from: [f64; 2], to: [f64; 2]) {
        for k in 0..=4000 {
            let fraction = (f64::from(k) / 2000.0).min(1.0);
            let positions = [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * fraction);
            self.tick(positions, positions);
        }
    }
}

/// The expected correction at x and y, m or N.
type Expected = fn(f64, f64) -> f64;

/// Each compensation alone on the first axis, with its channel in [`Bench::added`] and the correction expected there at
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

/// Tolerance 4 nm and 10 mN. Linear interpolation between the 64 points of a cycle has an error of (2π/64)²/8 = 1.2e-3 of
/// the amplitude, 2.4 nm and 7.2 mN; the rest is for the number format.
fn cancels<S: Scalar>(to: [f64; 2]) {
    for (item, settings, channel, expected) in items() {
        let mut bench = Bench::<S>::new([&settings, &CompensationSettings::default()]);
        bench.settle([to[0] - 0.02, to[1] - 0.02], to);
        let (added, exact) = (bench.added[channel][0], expected(to[0], to[1]));
        let tolerance = if channel == 2 { 10e-3 } else { 4e-9 };
        assert!((added - exact).abs() < tolerance, "{} {item:?}: {added:e}, expected {exact:e}", S::NAME);
        // Switched off the correction is zero; switched on again it has the same value.
        bench.all.switch(0, item, false);
        bench.settle(to, to);
        assert!(bench.added[channel][0].abs() < 1e-12, "{item:?} off: {:e}", bench.added[channel][0]);
        bench.all.switch(0, item, true);
        bench.settle(to, to);
        assert!((bench.added[channel][0] - added).abs() < 1e-12, "{item:?} switched on again");
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
    let mut bench = Bench::<S>::new([&settings, &CompensationSettings::default()]);
    let mut worst = 0.0f64;
    for k in 0..8000 {
        let angle = omega * f64::from(k) / RATE_HZ;
        let positions = [radius * angle.cos(), radius * angle.sin()];
        bench.tick(positions, positions);
        let acceleration = -omega * omega * if cross { positions[1] } else { positions[0] };
        if k > 4000 {
            worst = worst.max((bench.added[0][0] + c * acceleration).abs());
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
        let mut bench = Bench::<Fixed>::new([&both(of), &CompensationSettings::default()]);
        for (from, to, value) in [(0.0, 0.05, 2e-6), (0.05, 0.02, 5e-6), (0.02, 0.03, 2e-6)] {
            bench.settle([from, 0.0], [to, 0.0]);
            assert!((bench.added[0][0] - sign * value).abs() < 1e-10, "{of:?}: {:e}", bench.added[0][0]);
        }
    }
}

/// Settings of all nine compensations, each present or absent, of random magnitude.
fn any_settings() -> impl Strategy<Value = CompensationSettings> {
    let sizes = (0.0..1.0f64, 0.0..1.0f64, 0.0..1.0f64, any::<[bool; 9]>(), 1e-3..0.1f64, 1e3..1e6f64);
    sizes.prop_map(|(a, b, c, has, position_rate_m_per_s, force_rate_n_per_s)| CompensationSettings {
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
        crosstalk: has[5].then_some((1, Talk::Constant(-2e-5 * b))),
        squareness: has[6].then_some((1, 1e-3 * c)),
        straightness: has[7].then_some((1, Straightness::Quadratic(1e-3 * a))),
        ripple: has[8].then(|| Cycle::harmonic(100.0 * c, 1e-3, b)).into_iter().collect(),
        position_bound_m: 20e-6,
        position_rate_m_per_s,
        force_bound_n: 100.0,
        force_rate_n_per_s,
    })
}

/// Random lines of 200 ticks, each preceded by switching a compensation or by replacing the settings. In every tick each
/// correction is within its bound and changes by no more than its rate.
fn stays_within_rate_and_bound<S: Scalar>(
    one: &CompensationSettings,
    other: &CompensationSettings,
    moves: &[([f64; 2], u8)],
) {
    let mut bench = Bench::<S>::new([one, other]);
    let mut positions = [0.0; 2];
    // More than two steps of a fixed-point signal, 62 pm and 61 µN; f32 and f64 round to less.
    let (step_m, step_n) = (0.2e-9, 2e-4);
    for &(to, action) in moves {
        let from = positions;
        match action {
            0..=8 => bench.all.switch(0, CompensationKind::ALL[usize::from(action)], action % 2 == 0),
            9 => bench.all.replace(0, AxisCompensation::new(other, RATES, 2).unwrap()),
            10 => bench.all.replace(0, AxisCompensation::new(one, RATES, 2).unwrap()),
            _ => CompensationKind::ALL.into_iter().for_each(|item| bench.all.switch(0, item, true)),
        }
        for k in 1..=200 {
            let fraction = f64::from(k) / 200.0;
            positions = [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * fraction);
            let before = bench.added;
            bench.tick(positions, positions);
            let rate = one.position_rate_m_per_s.max(other.position_rate_m_per_s) / RATE_HZ + step_m;
            let rise = one.force_rate_n_per_s.max(other.force_rate_n_per_s) / RATE_HZ + step_n;
            #[expect(clippy::needless_range_loop, reason = "of two arrays, one inside the other")]
            for axis in 0..2 {
                for (channel, (bound, most)) in
                    [(20e-6 + step_m, rate), (20e-6 + step_m, rate), (100.0 + step_n, rise)]
                        .into_iter()
                        .enumerate()
                {
                    let (value, change) =
                        (bench.added[channel][axis], bench.added[channel][axis] - before[channel][axis]);
                    assert!(value.abs() <= bound, "{}: channel {channel}: {value:e} of {bound:e}", S::NAME);
                    assert!(change.abs() <= most, "{}: channel {channel}: {change:e} of {most:e}", S::NAME);
                }
            }
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

    /// Up to 0.2 m in 50 ms on each axis, 4 m/s, with reversals within a tick.
    #[test]
    fn corrections_stay_within_rate_and_bound(
        one in any_settings(), other in any_settings(),
        moves in prop::collection::vec(([-0.1..0.1f64, -0.1..0.1], 0u8..12), 1..12),
    ) {
        stays_within_rate_and_bound::<Fixed>(&one, &other, &moves);
        stays_within_rate_and_bound::<f32>(&one, &other, &moves);
        stays_within_rate_and_bound::<f64>(&one, &other, &moves);
    }
}

#[test]
fn rejected_settings_are_named() {
    let error_of =
        |settings: CompensationSettings| AxisCompensation::<Fixed>::new(&settings, RATES, 2).unwrap_err();
    let none = CompensationSettings::default;
    let name_of = |error| {
        let (ConfigError::NotFinite(name)
        | ConfigError::NotPositive(name)
        | ConfigError::NotWhileRunning(name)
        | ConfigError::OutOfRange { name, .. }) = error;
        name
    };
    let cases = vec![
        (CompensationSettings { backlash_width_m: Some(-1e-6), ..none() }, "backlash_width_m"),
        (CompensationSettings { backlash_width_m: Some(f64::NAN), ..none() }, "backlash_width_m"),
        (CompensationSettings { backlash_width_m: Some(3e-3), ..none() }, "backlash_width_m"),
        (CompensationSettings { squareness: Some((2, 1e-6)), ..none() }, "squareness"),
        (CompensationSettings { squareness: Some((1, f64::INFINITY)), ..none() }, "squareness"),
        (CompensationSettings { crosstalk: Some((7, Talk::Constant(0.0))), ..none() }, "crosstalk"),
        (CompensationSettings { intalk: Some(Talk::Constant(1.0)), ..none() }, "intalk"),
        (
            CompensationSettings {
                dividing: [Cycle::harmonic(2e-3, 2.5e-3, 0.0)].into_iter().collect(),
                ..none()
            },
            "dividing",
        ),
        (
            CompensationSettings { ripple: [Cycle::harmonic(1.0, 0.0, 0.0)].into_iter().collect(), ..none() },
            "ripple",
        ),
        (
            CompensationSettings {
                ripple: [Cycle { period_m: 1e-3, values: [1.0].into_iter().collect() }].into_iter().collect(),
                ..none()
            },
            "ripple",
        ),
        (
            CompensationSettings {
                reversal: Some(Reversal { force_n: 1.0, decay_s: 0.0, fade_m_per_s: 1.0 }),
                ..none()
            },
            "reversal_decay_s",
        ),
        (CompensationSettings { position_bound_m: 0.0, ..none() }, "position_bound_m"),
        (CompensationSettings { position_rate_m_per_s: f64::NAN, ..none() }, "position_rate_m_per_s"),
        (CompensationSettings { force_bound_n: f64::INFINITY, ..none() }, "force_bound_n"),
        (CompensationSettings { force_rate_n_per_s: -1.0, ..none() }, "force_rate_n_per_s"),
    ];
    for (settings, name) in cases {
        assert_eq!(name_of(error_of(settings)), name);
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
    let mut bench = Bench::<f64>::new([&dividing, &none]);
    bench.settle([0.0; 2], [0.001, 0.0]);
    // A reversal of the command starts the force pulse.
    for k in 0..4 {
        bench.tick([0.001 - 1e-5 * f64::from(k), 0.0], [0.001, 0.0]);
    }
    let before = bench.added;
    assert!(before[1][0].abs() > 1e-6 && before[2][0].abs() > 1.0, "{before:?}");
    bench.all.replace(0, AxisCompensation::new(&none, RATES, 2).unwrap());
    let mut last = before;
    for _ in 0..40_000 {
        bench.tick([0.001, 0.0], [0.001, 0.0]);
        for (kind, rate) in [(1, none.position_rate_m_per_s), (2, none.force_rate_n_per_s)] {
            let step = (bench.added[kind][0] - last[kind][0]).abs();
            assert!(step <= rate / RATE_HZ * (1.0 + 1e-6) + 1e-12, "{kind}: {step}");
        }
        last = bench.added;
    }
    assert!(last.iter().all(|added| added[0].abs() < 1e-12), "{last:?}");
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
        AxisCompensation::<Fixed>::new(&settings, rates, 2).err()
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
