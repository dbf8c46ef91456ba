//! Step responses of the loops against their transfer functions, and changes of gains and law during motion.

use crate::slide::Slide;
use proptest::prelude::*;
use shared::axis::{AxisState, Reading};
use shared::compensate::Correction;
use shared::config::{AxisConfig, AxisSettings, Law, LowPass, Notch, Notches, Rates};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

fn position(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

const fn reading(motor: Position) -> Reading {
    Reading { motor, table: None }
}

/// Step response of HPC over an ideal velocity loop (an integrator) in continuous time, x = Kp·t.
///
/// The characteristic polynomial s³ + 6s² + 16s + 16 = (s + 2)(s² + 4s + 8) has the roots −2 and −2 ± 2j:
/// y = 1 − A·e^(−2x) − e^(−2x)(B·cos 2x + C·sin 2x). y(0) = y'(0) = y''(0) = 0 give A = 2, B = −1, C = 1.
fn hpc(x: f64) -> f64 {
    1.0 - (-2.0 * x).exp() * (2.0 - (2.0 * x).cos() + (2.0 * x).sin())
}

/// Greatest difference of the step response from its closed form, µm of a step of 1 mm. The velocity loop is ideal: an
/// integrator that holds the velocity command over a tick T, so that P is 1 − (1 − Kp·T)ⁿ after n ticks.
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
        let _ = state.position_tick(&config, position(target), Correction::NONE, reading(position(at_m)));
        at_m += state.velocity_command_m_per_s() / rate_hz;
    }
    worst
}

/// P matches to the rounding of the format. HPC differs from the continuous response by the hold of its output, a delay of
/// T/2: at y' = 4·Kp·e^(−2x)·(1 − cos 2x) ≤ 0.83·Kp the error is 0.42·Kp·T of the step. The test allows ±40 % of that.
#[test]
fn the_step_response_of_the_position_loop_matches_its_closed_form() {
    for rate_hz in [1000.0, 4000.0, 20_000.0] {
        for (name, p, hpc) in [
            ("fixed", step_response::<Fixed>(Law::P, rate_hz), step_response::<Fixed>(Law::Hpc, rate_hz)),
            ("f32", step_response::<f32>(Law::P, rate_hz), step_response::<f32>(Law::Hpc, rate_hz)),
            ("f64", step_response::<f64>(Law::P, rate_hz), step_response::<f64>(Law::Hpc, rate_hz)),
        ] {
            // A velocity rounded by r leaves an error of r/Kp. Fixed point: a step of 1 nm/s, 25 pm, a step of the error, 62 pm,
            // and 1 pm of the reading. f32: 2⁻²⁴ of Kp·1 mm, 60 pm.
            let rounding = match name {
                "fixed" => 9e-5,
                "f32" => 6e-5,
                _ => 1e-9,
            };
            assert!(p < rounding, "{name}, P at {rate_hz} Hz: {p} µm");
            let hold = slope() * 0.5 * 40.0 / rate_hz * 1000.0;
            assert!(hpc < 1.4 * hold + 0.05 && hpc > 0.6 * hold, "{name}, HPC: {hpc} µm, expected {hold}");
        }
    }
}

/// Greatest slope dy/dx of the step response of HPC.
fn slope() -> f64 {
    let slopes = (0..5000).map(|k| f64::from(k) * 1e-3).map(|x| (hpc(x + 1e-3) - hpc(x)) * 1e3);
    slopes.fold(0.0, f64::max)
}

/// The velocity loop on a mass m, integrated exactly for a force that is held over a tick, against the same discrete loop
/// in f64: F = Kv·(e + Σe·T/Ti), e = command − v, with v differenced from the reading.
#[test]
fn the_step_response_of_the_velocity_loop_matches_its_equations() {
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
        // Kp·0.2 mm = 10 mm/s. No further position tick follows, so this velocity command is held.
        let _ = state.position_tick(&config, position(0.2e-3), Correction::NONE, reading(Position(0)));
        let (mut ex, mut ev, mut last, mut integral, mut worst) = (0.0, 0.0, 0.0, 0.0, 0.0f64);
        for _ in 0..400 {
            let (force, _) = state.velocity_tick(&config, reading(position(x)), S::default());
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
        // The roots are −63/s and −237/s: after 0.1 s the transient has decayed to less than 1 %.
        assert!((ev - 0.01).abs() < 1e-4);
        worst
    }
    // Fixed point resolves 1 nm/s and 61 µN; the integral gain, 0.006, is rounded by 2⁻²⁵: 5e-6 of 10 mm/s.
    assert!(run::<Fixed>() < 1e-6, "{}", run::<Fixed>());
    assert!(run::<f32>() < 1e-6, "{}", run::<f32>());
    assert!(run::<f64>() < 1e-10, "{}", run::<f64>());
}

/// A mass with viscous friction, and its control loops.
struct TestPlant<S: Scalar> {
    config: AxisConfig<S>,
    state: AxisState<S>,
    command_m: f64,
    at_m: f64,
    velocity: f64,
    force: f64,
}

const RATES: Rates = Rates { velocity_loop_hz: 4000.0, position_loop_divider: 1 };
const FRICTION_N_S_PER_M: f64 = 2000.0;
const TABLE: Slide = Slide { mass_kg: 60.0, viscous_n_s_per_m: FRICTION_N_S_PER_M, coulomb_n: 0.0 };

impl<S: Scalar> TestPlant<S> {
    fn new(settings: &AxisSettings) -> Self {
        let config = AxisConfig::new(settings, RATES).unwrap();
        let state = AxisState::at_rest(Position(0), reading(Position(0)));
        Self { config, state, command_m: 0.0, at_m: 0.0, velocity: 0.0, force: 0.0 }
    }

    /// One tick at a commanded speed. Returns the changes of velocity command (m/s) and force (N).
    fn tick(&mut self, speed: f64) -> [f64; 2] {
        let before = [self.state.velocity_command_m_per_s(), self.force];
        self.command_m += speed / RATES.velocity_loop_hz;
        let reading = reading(position(self.at_m));
        let _ = self.state.position_tick(&self.config, position(self.command_m), Correction::NONE, reading);
        let (force, _) = self.state.velocity_tick(&self.config, reading, S::default());
        self.force = force.value();
        TABLE.step(&mut self.at_m, &mut self.velocity, self.force, 1.0 / RATES.velocity_loop_hz);
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
            notches: Notches(
                [700.0, 1100.0, 350.0, 1500.0]
                    .map(|hz| notch.then_some(Notch { frequency_hz: hz, width_hz: 200.0, depth: 0.9 })),
            ),
            low_pass: low_pass.then_some(LowPass { frequency_hz: 900.0, damping_ratio: 0.7 }),
            ..AxisSettings::default()
        })
}

/// In the tick of the change velocity command and force are held. Then the offset decays by Kp·T per tick. In the end the
/// following error is that of the new gains: v/Kp·(1 − Kf), plus v/Kp·b/Kv without an integral part, within the travel of
/// one and a half ticks.
fn changes_without_a_jump<S: Scalar>(from: &AxisSettings, to: &AxisSettings) {
    let speed = 0.05;
    let mut plant = TestPlant::<S>::new(from);
    // 0.5 s of acceleration, 2 s at constant speed.
    for k in 0..2000 {
        plant.tick(speed * f64::from(k) / 2000.0);
    }
    for _ in 0..8000 {
        plant.tick(speed);
    }
    plant.change(to);
    let [command, force] = plant.tick(speed);
    assert!(command.abs() < 1e-12 && force.abs() < 1e-9, "{}: {command} m/s, {force} N", S::NAME);
    // The offset is of the order of the speed and decays by Kp·T per tick; a factor of 3 is for the loop itself.
    let most = 3.0 * speed * to.position_gain_per_s / RATES.velocity_loop_hz + 2e-5;
    for _ in 0..400 {
        let [command, force] = plant.tick(speed);
        assert!(command.abs() < most, "{}: {command} m/s in a tick, at most {most}", S::NAME);
        assert!(force.abs() < 3.0 * to.velocity_gain_n_s_per_m * most, "{}: {force} N", S::NAME);
    }
    for _ in 0..20_000 {
        plant.tick(speed);
    }
    // Without an integral part, the friction force b·v needs a velocity error of v·b/Kv.
    let by_friction = if to.velocity_integral_time_s.is_some() {
        0.0
    } else {
        FRICTION_N_S_PER_M / to.velocity_gain_n_s_per_m
    };
    let expected = speed / to.position_gain_per_s * (1.0 - to.feedforward_percent / 100.0 + by_friction);
    let error = plant.following_error_m() - expected;
    let tolerance = 1.5 * speed / RATES.velocity_loop_hz;
    assert!(error.abs() < tolerance, "{}: {error} m from {expected}", S::NAME);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 1 } else { 24 }))]

    #[test]
    fn a_change_of_gains_or_law_is_bumpless(from in settings(), to in settings()) {
        changes_without_a_jump::<Fixed>(&from, &to);
        changes_without_a_jump::<f32>(&from, &to);
        changes_without_a_jump::<f64>(&from, &to);
    }
}

/// At rest, where holding the outputs for a tick makes no difference, a change to the same settings has no effect on any
/// later force, bit for bit.
#[test]
fn a_change_to_the_same_settings_at_rest_has_no_effect() {
    let settings = AxisSettings { law: Law::Hpc, ..AxisSettings::default() };
    let mut one = TestPlant::<Fixed>::new(&settings);
    let mut other = TestPlant::<Fixed>::new(&settings);
    other.change(&settings);
    other.tick(0.0);
    one.tick(0.0);
    for _ in 0..1000 {
        one.tick(0.02);
        other.tick(0.02);
        assert_eq!(one.force.to_bits(), other.force.to_bits());
    }
}
