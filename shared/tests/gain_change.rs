//! Changes of gains and law in operation: velocity command and force in every tick after the change.

use crate::slide::Slide;
use shared::axis::{AxisState, Reading};
use shared::compensate::Correction;
use shared::config::{AxisConfig, AxisSettings, Law, Rates};
use shared::scalar::{Fixed, Scalar};
use shared::units::{Position, VELOCITY_M_PER_S};

fn position(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

const fn reading(motor: Position) -> Reading {
    Reading { motor, table: None }
}

/// Distance of a locked motor from its command, m.
const HELD_M: f64 = 1e-4;

/// The position loop runs in every fifth tick, so that the decay fractions of the two offsets differ.
const SLOWER: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };

/// On a locked motor, without an integral part, the gains change from Kp₀, Kv₀ to Kp, Kv at t = 0. The offset between the
/// outputs of the old and the new gains decays with the time constant 1/Kp of the new ones:
///
/// v = Kp·x + (Kp₀ − Kp)·x·e^(−Kp·t)          at the position ticks, held between them
/// F = Kv·v + (Kv₀ − Kv)·v₀·e^(−Kp·t)          in every tick, v₀ = Kp₀·x
fn offset_decays<S: Scalar>([from_kp, from_kv]: [f64; 2], [kp, kv]: [f64; 2]) {
    let config = |position_gain_per_s, velocity_gain_n_s_per_m| {
        let settings = AxisSettings {
            position_gain_per_s,
            velocity_gain_n_s_per_m,
            velocity_integral_time_s: None,
            ..AxisSettings::default()
        };
        AxisConfig::<S>::new(&settings, SLOWER).unwrap()
    };
    let (from, to) = (config(from_kp, from_kv), config(kp, kv));
    let (motor, command) = (reading(Position(0)), position(HELD_M));
    let mut state = AxisState::at_rest(Position(0), motor);
    let _ = state.position_tick(&from, command, Correction::NONE, motor);
    let _ = state.velocity_tick(&from, motor, S::default());
    state.change(&from, &to);
    let before = from_kp * HELD_M;
    // In fixed point the decay fraction is rounded by 2⁻²⁵. The relative error of the time constant is the same, and the
    // offset changes by at most 1/e of it. The absolute tolerances below are for the steps of offset and law.
    let relative = match S::NAME {
        "fixed" => 2f64.powi(-25) / (kp / SLOWER.velocity_loop_hz) / std::f64::consts::E,
        "f32" => 2f64.powi(-19),
        _ => 1e-9,
    };
    let mut commanded = 0.0;
    for n in 0..12_000 {
        let remaining = (-kp * f64::from(n) / SLOWER.velocity_loop_hz).exp();
        if n % SLOWER.position_loop_divider == 0 {
            let _ = state.position_tick(&to, command, Correction::NONE, motor);
            commanded = kp * HELD_M + (before - kp * HELD_M) * remaining;
        }
        let (force, _) = state.velocity_tick(&to, motor, S::default());
        let error = state.velocity_command_m_per_s() - commanded;
        let tolerance = 2e-9 + relative * (from_kp + kp) * HELD_M;
        let context = format!("{}, tick {n}", S::NAME);
        assert!(error.abs() < tolerance, "{context}: {error} m/s from {commanded}, tolerance {tolerance}");
        let expected = kv * state.velocity_command_m_per_s() + (from_kv - kv) * before * remaining;
        let error = force.value() - expected;
        let tolerance = 2e-4 + relative * (from_kv + kv) * (before + commanded);
        assert!(error.abs() < tolerance, "{context}: {error} N from {expected}, tolerance {tolerance}");
    }
    // 0.6 s are at least 24 time constants; e⁻²⁴ of an offset is less than a step in fixed point, so it has ended.
    if S::NAME == "fixed" {
        let made = to.position.velocity(&mut Default::default(), S::from_distance(command.0));
        assert!((state.velocity_command_m_per_s() - made.value() * VELOCITY_M_PER_S).abs() < 1e-15);
    }
}

#[test]
fn an_offset_at_a_change_of_gains_fades_with_the_time_constant_of_the_new_loop() {
    for (from, to) in [
        ([20.0, 1e4], [40.0, 1e4]),
        ([100.0, 1e4], [40.0, 1e4]),
        ([40.0, 1e4], [40.0, 2e4]),
        ([40.0, 2e4], [40.0, 1e4]),
        ([50.0, 1e4], [100.0, 2e4]),
    ] {
        offset_decays::<Fixed>(from, to);
        offset_decays::<f32>(from, to);
        offset_decays::<f64>(from, to);
    }
}

/// At constant speed v against the friction b·v the integral supplies the whole force. With a feed-forward of 100 % the
/// following error is zero, so a change of Kp does not change the force. If the integral were reset, the force would lose
/// b·v = 100 N.
fn keeps_its_integral<S: Scalar>() {
    let (rate, friction_n_s_per_m, speed) = (SLOWER.velocity_loop_hz, 2000.0, 0.05);
    let table = Slide { mass_kg: 60.0, viscous_n_s_per_m: friction_n_s_per_m, coulomb_n: 0.0 };
    let config = |position_gain_per_s| {
        let settings =
            AxisSettings { position_gain_per_s, feedforward_percent: 100.0, ..AxisSettings::default() };
        AxisConfig::<S>::new(&settings, Rates { position_loop_divider: 1, ..SLOWER }).unwrap()
    };
    let (before, after) = (config(30.0), config(60.0));
    let mut state = AxisState::at_rest(Position(0), reading(Position(0)));
    let (mut target_m, mut motor_m, mut velocity) = (0.0, 0.0, 0.0);
    let mut tick = |state: &mut AxisState<S>, config: &AxisConfig<S>| {
        target_m += speed / rate;
        let _ = state.position_tick(config, position(target_m), Correction::NONE, reading(position(motor_m)));
        let (force, _) = state.velocity_tick(config, reading(position(motor_m)), S::default());
        table.step(&mut motor_m, &mut velocity, force.value(), 1.0 / rate);
        force.value()
    };
    let steady = friction_n_s_per_m * speed;
    // The slowest time constant is 1/Kp: 2 s are 60 of them.
    let last = (0..40_000).map(|_| tick(&mut state, &before)).last().unwrap();
    // The velocity is the difference of two readings, each rounded to 2⁻¹⁰ nm: 20 nm/s, which is 1 mN at
    // Kv = 50,000 N·s/m. Twice that allows for the integral, which collects it. 2⁻²⁴ of 0.05 m/s in f32 is 0.15 mN.
    let tolerance = 2.5e-3;
    assert!((last - steady).abs() < tolerance, "{}: {last} N", S::NAME);
    state.change(&before, &after);
    for n in 0..20_000 {
        let force = tick(&mut state, &after);
        assert!((force - steady).abs() < tolerance, "{}, tick {n}: {force} N, not {steady}", S::NAME);
    }
}

#[test]
fn a_change_of_gains_keeps_the_integral() {
    keeps_its_integral::<Fixed>();
    keeps_its_integral::<f32>();
    keeps_its_integral::<f64>();
}

/// The DC gain of the HPC filter is one: for a constant error x, P and HPC have the same output Kp·x. A change between them
/// leaves the velocity command unchanged in every tick, because the filter starts settled at x. A filter that started at
/// zero would need several 1/Kp to settle.
fn changes_law_without_a_step<S: Scalar>() {
    let kp = 40.0;
    let config = |law| {
        let settings = AxisSettings { law, position_gain_per_s: kp, ..AxisSettings::default() };
        AxisConfig::<S>::new(&settings, SLOWER).unwrap()
    };
    let laws = [config(Law::P), config(Law::Hpc), config(Law::P), config(Law::Hpc)];
    for held_m in [HELD_M, -HELD_M] {
        let motor = reading(Position(0));
        let mut state = AxisState::at_rest(Position(0), motor);
        let _ = state.position_tick(&laws[0], position(held_m), Correction::NONE, motor);
        for change in laws.windows(2) {
            state.change(&change[0], &change[1]);
            for n in 0..1000 {
                let _ = state.position_tick(&change[1], position(held_m), Correction::NONE, motor);
                let error = state.velocity_command_m_per_s() - kp * held_m;
                // A velocity step of 1 nm/s in fixed point; f32 rounds product and sum, each by 2⁻²⁴.
                assert!(
                    error.abs() < 1e-9 + 2f64.powi(-23) * kp * HELD_M,
                    "{}, tick {n}: {error} m/s",
                    S::NAME
                );
            }
        }
    }
}

#[test]
fn p_and_hpc_have_the_same_output_for_a_constant_error() {
    changes_law_without_a_step::<Fixed>();
    changes_law_without_a_step::<f32>();
    changes_law_without_a_step::<f64>();
}
