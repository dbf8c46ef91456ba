//! The loops as wholes: step responses from their transfer functions, and changes while an axis moves.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use proptest::prelude::*;
use shared::axis::{AxisState, Reading};
use shared::config::{AxisConfig, AxisSettings, Law, LowPass, Notch, Rates};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

fn place(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

const fn reading(motor: Position) -> Reading {
    Reading { motor, table: None }
}

/// Step response of the position loop over an ideal velocity loop, an integrator that holds the velocity
/// command for a tick: at times x = Kp·t.
///
/// P: 1 − (1 − Kp·T)ⁿ. HPC in continuous time: x³ + 6x² + 16x + 16 = (x + 2)(x² + 4x + 8), so that
/// y = 1 − A·e^(−2x) − e^(−2x)(B·cos 2x + C·sin 2x); y(0) = y'(0) = y''(0) = 0 give A = 2, B = −1, C = 1.
fn hpc(x: f64) -> f64 {
    1.0 - (-2.0 * x).exp() * (2.0 - (2.0 * x).cos() + (2.0 * x).sin())
}

/// Greatest difference from what is expected, of a step of 1 mm, µm.
fn step_response<S: Scalar>(law: Law, rate_hz: f64) -> f64 {
    let kp = 40.0;
    let rates = Rates { velocity_loop_hz: rate_hz, position_loop_divider: 1 };
    let settings = AxisSettings { law, position_gain_per_s: kp, ..AxisSettings::default() };
    let config = AxisConfig::<S>::new(&settings, rates).unwrap();
    let mut state = AxisState::at_rest(Position(0), reading(Position(0)));
    let (target, mut at_m, mut worst) = (1e-3, 0.0f64, 0.0f64);
    #[expect(clippy::cast_possible_truncation, reason = "some thousand ticks")]
    let ticks = (5.0 / kp * rate_hz) as i32;
    for n in 0..ticks {
        let expected = match law {
            Law::P => 1.0 - (1.0 - kp / rate_hz).powi(n),
            Law::Hpc => hpc(kp * f64::from(n) / rate_hz),
        };
        worst = worst.max((at_m / target - expected).abs() * target * 1e6);
        let _ = state.position_tick(&config, place(target), 0, reading(place(at_m)));
        at_m += state.velocity_command_m_per_s() / rate_hz;
    }
    worst
}

/// P to the rounding of the format: velocity resolves 1 nm/s, Kp 2⁻²⁵ of 0.0025. HPC meets the continuous response
/// but for the hold of its output, a delay of half a tick: |y'| ≤ 0.42·Kp per unit (its greatest, by the
/// derivative above), so 0.21·Kp·T of the step, within a third.
#[test]
fn the_position_loop_steps_as_its_poles_say() {
    for rate_hz in [1000.0, 4000.0, 20_000.0] {
        for (name, p, hpc) in [
            ("fixed", step_response::<Fixed>(Law::P, rate_hz), step_response::<Fixed>(Law::Hpc, rate_hz)),
            ("f32", step_response::<f32>(Law::P, rate_hz), step_response::<f32>(Law::Hpc, rate_hz)),
            ("f64", step_response::<f64>(Law::P, rate_hz), step_response::<f64>(Law::Hpc, rate_hz)),
        ] {
            let rounding = if name == "f64" { 1e-6 } else { 0.02 };
            assert!(p < rounding, "{name}, P at {rate_hz} Hz: {p} µm");
            let hold = slope() * 0.5 * 40.0 / rate_hz * 1000.0;
            assert!(hpc < 1.4 * hold + 0.05 && hpc > 0.6 * hold, "{name}, HPC: {hpc} µm, expected {hold}");
        }
    }
}

/// Greatest slope of the step response of HPC, per Kp.
fn slope() -> f64 {
    let slopes = (0..5000).map(|k| f64::from(k) * 1e-3).map(|x| (hpc(x + 1e-3) - hpc(x)) * 1e3);
    slopes.fold(0.0, f64::max)
}

/// The velocity loop on a mass m, stepped exactly for the held force: with e = command − v, v the difference of
/// the reading, the discrete loop is simulated here in f64 from its equations alone.
#[test]
fn the_velocity_loop_steps_as_its_equations_say() {
    fn run<S: Scalar>() -> f64 {
        let (rate, mass, kv, ti) = (4000.0, 100.0, 30_000.0, 0.02);
        let rates = Rates { velocity_loop_hz: rate, position_loop_divider: 1 };
        let settings = AxisSettings {
            velocity_gain_n_s_per_m: kv,
            velocity_integral_time_s: Some(ti),
            position_gain_per_s: 50.0,
            ..AxisSettings::default()
        };
        let config = AxisConfig::<S>::new(&settings, rates).unwrap();
        let mut state = AxisState::at_rest(Position(0), reading(Position(0)));
        let (mut x, mut v) = (0.0f64, 0.0f64);
        // A step of 0.2 mm of position asks for 10 mm/s at first: the command is held there.
        let _ = state.position_tick(&config, place(0.2e-3), 0, reading(Position(0)));
        let (mut ex, mut ev, mut last, mut integral, mut worst) = (0.0, 0.0, 0.0, 0.0, 0.0f64);
        for _ in 0..400 {
            let (force, _) = state.velocity_tick(&config, reading(place(x)), S::default());
            let a = force.value() / mass;
            x += v / rate + a / (2.0 * rate * rate);
            v += a / rate;
            let error = 0.01 - (ex - last) * rate;
            integral += error / rate / ti;
            let a = kv * (error + integral) / mass;
            last = ex;
            ex += ev / rate + a / (2.0 * rate * rate);
            ev += a / rate;
            worst = worst.max((v - ev).abs());
        }
        // It has come to the command, and over it on the way: both by the integral part.
        assert!((ev - 0.01).abs() < 1e-4);
        worst
    }
    // 1 nm/s of velocity, 61 µN of force: an integral gain of 2⁻²⁵ in 0.006 is 5e-6 of 10 mm/s.
    assert!(run::<Fixed>() < 1e-6, "{}", run::<Fixed>());
    assert!(run::<f32>() < 1e-6, "{}", run::<f32>());
    assert!(run::<f64>() < 1e-10, "{}", run::<f64>());
}

/// An axis of one mass under its loops.
struct Bench<S: Scalar> {
    config: AxisConfig<S>,
    state: AxisState<S>,
    command_m: f64,
    at_m: f64,
    velocity: f64,
    force: f64,
}

const RATES: Rates = Rates { velocity_loop_hz: 4000.0, position_loop_divider: 1 };
const MASS_KG: f64 = 60.0;
const FRICTION_N_S_PER_M: f64 = 2000.0;

impl<S: Scalar> Bench<S> {
    fn new(settings: &AxisSettings) -> Self {
        let config = AxisConfig::new(settings, RATES).unwrap();
        let state = AxisState::at_rest(Position(0), reading(Position(0)));
        Self { config, state, command_m: 0.0, at_m: 0.0, velocity: 0.0, force: 0.0 }
    }

    /// One tick at a commanded speed. What velocity command (m/s) and force (N) have changed by.
    fn tick(&mut self, speed: f64) -> [f64; 2] {
        let before = [self.state.velocity_command_m_per_s(), self.force];
        self.command_m += speed / RATES.velocity_loop_hz;
        let reading = reading(place(self.at_m));
        let _ = self.state.position_tick(&self.config, place(self.command_m), 0, reading);
        let (force, _) = self.state.velocity_tick(&self.config, reading, S::default());
        self.force = force.value();
        let a = (self.force - FRICTION_N_S_PER_M * self.velocity) / MASS_KG;
        self.velocity += a / RATES.velocity_loop_hz;
        self.at_m += self.velocity / RATES.velocity_loop_hz;
        [self.state.velocity_command_m_per_s() - before[0], self.force - before[1]]
    }

    fn change(&mut self, settings: &AxisSettings) {
        let to = AxisConfig::new(settings, RATES).unwrap();
        self.state.change(&self.config, &to);
        self.config = to;
    }

    fn following_error_m(&self) -> f64 {
        self.command_m - self.at_m
    }
}

fn settings() -> impl Strategy<Value = AxisSettings> {
    let filters = (any::<bool>(), any::<bool>());
    (any::<bool>(), 20.0..60.0f64, 0.0..100.0f64, 1e4..3e4f64, prop::option::of(0.02..0.1f64), filters)
        .prop_map(|(hpc, kp, kf, kv, ti, (notch, low_pass))| AxisSettings {
            law: if hpc { Law::Hpc } else { Law::P },
            position_gain_per_s: kp,
            feedforward_percent: kf,
            velocity_gain_n_s_per_m: kv,
            velocity_integral_time_s: ti,
            notch: notch.then_some(Notch { frequency_hz: 700.0, width_hz: 200.0, depth: 0.9 }),
            low_pass: low_pass.then_some(LowPass { frequency_hz: 900.0, damping_ratio: 0.7 }),
            ..AxisSettings::default()
        })
}

/// In the tick of a change neither output moves at all (it holds); in the next ones it moves as the loop does:
/// by the share of the offset that fades and by what the motion itself changes in a tick. Afterwards the
/// following error is the new gains': (1 − Kf)·v/Kp, with one tick of the discrete loop beside it, and half
/// of one more for the force that friction takes where there is no integral part.
fn changes<S: Scalar>(from: &AxisSettings, to: &AxisSettings) {
    let speed = 0.05;
    let mut bench = Bench::<S>::new(from);
    // Gently up to speed, and on.
    for k in 0..2000 {
        bench.tick(speed * f64::from(k) / 2000.0);
    }
    for _ in 0..8000 {
        bench.tick(speed);
    }
    bench.change(to);
    let [command, force] = bench.tick(speed);
    assert!(command.abs() < 1e-12 && force.abs() < 1e-9, "{}: {command} m/s, {force} N", S::NAME);
    // The offset is at most what all of the speed can differ by, and fades by Kp·T of it.
    let most = 3.0 * speed * to.position_gain_per_s / RATES.velocity_loop_hz + 2e-5;
    for _ in 0..400 {
        let [command, force] = bench.tick(speed);
        assert!(command.abs() < most, "{}: {command} m/s in a tick of {most}", S::NAME);
        assert!(force.abs() < 3.0 * to.velocity_gain_n_s_per_m * most, "{}: {force} N", S::NAME);
    }
    for _ in 0..20_000 {
        bench.tick(speed);
    }
    // What friction takes: v·b/Kv of velocity error without an integral part, over Kp.
    let by_friction = if to.velocity_integral_time_s.is_some() {
        0.0
    } else {
        FRICTION_N_S_PER_M / to.velocity_gain_n_s_per_m
    };
    let expected = speed / to.position_gain_per_s * (1.0 - to.feedforward_percent / 100.0 + by_friction);
    let off = bench.following_error_m() - expected;
    assert!(off.abs() < 1.5 * speed / RATES.velocity_loop_hz, "{}: {off} m off {expected}", S::NAME);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 1 } else { 24 }))]

    #[test]
    fn a_change_of_gains_or_law_does_not_jump(from in settings(), to in settings()) {
        changes::<Fixed>(&from, &to);
        changes::<f32>(&from, &to);
        changes::<f64>(&from, &to);
    }
}

/// Changed to the same settings, an axis goes on to the last bit as if it had not been: at rest, where the hold of
/// the tick of the change is no change.
#[test]
fn a_change_to_the_same_at_rest_is_none() {
    let settings = AxisSettings { law: Law::Hpc, ..AxisSettings::default() };
    let mut one = Bench::<Fixed>::new(&settings);
    let mut other = Bench::<Fixed>::new(&settings);
    other.change(&settings);
    other.tick(0.0);
    one.tick(0.0);
    for _ in 0..1000 {
        one.tick(0.02);
        other.tick(0.02);
        assert_eq!(one.force.to_bits(), other.force.to_bits());
    }
}
