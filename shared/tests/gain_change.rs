//! Gains changed while the loops run: what each of the outputs is from that tick on.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use shared::axis::{AxisState, Reading};
use shared::config::{AxisConfig, AxisSettings, Law, Rates};
use shared::scalar::{Fixed, Scalar};
use shared::units::{Position, VELOCITY_M_PER_S};

fn place(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

const fn reading(motor: Position) -> Reading {
    Reading { motor, table: None }
}

/// How far a motor that is held is from its command.
const HELD_M: f64 = 1e-4;

/// Position loops with every fifth tick, so that the share of an offset that fades in the one is not that of the other.
const SLOWER: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };

/// On a motor that is held, a change at t = 0 from gains `from` to `to`, integral left out: velocity command and force in
/// every tick from there on. What made the one or the other before was Kp·x, Kv·v; the offset between that and
/// what the new gains make fades as e^(−t/T), T = 1/Kp of the new ones:
///
/// v = Kp·x + (Kp₀ − Kp)·x·e^(−Kp·t)          at the position ticks, held between them
/// F = Kv·v + (Kv₀ − Kv)·v₀·e^(−Kp·t)          in every tick, v₀ = Kp₀·x
fn fades<S: Scalar>([from_kp, from_kv]: [f64; 2], [kp, kv]: [f64; 2]) {
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
    let (motor, command) = (reading(Position(0)), place(HELD_M));
    let mut state = AxisState::at_rest(Position(0), motor);
    let _ = state.position_tick(&from, command, 0, motor);
    let _ = state.velocity_tick(&from, motor, S::default());
    state.change(&from, &to);
    let before = from_kp * HELD_M;
    // The share that fades is right to 2⁻²⁵ in fixed point, which is the same part of the time constant as of the share;
    // an offset that fades changes with its time constant by 1/e of itself at most. A step of the format for the
    // offset, one for the law.
    let part = match S::NAME {
        "fixed" => 2f64.powi(-25) / (kp / SLOWER.velocity_loop_hz) / std::f64::consts::E,
        "f32" => 2f64.powi(-19),
        _ => 1e-9,
    };
    let mut commanded = 0.0;
    for n in 0..12_000 {
        let left = (-kp * f64::from(n) / SLOWER.velocity_loop_hz).exp();
        if n % SLOWER.position_loop_divider == 0 {
            let _ = state.position_tick(&to, command, 0, motor);
            commanded = kp * HELD_M + (before - kp * HELD_M) * left;
        }
        let (force, _) = state.velocity_tick(&to, motor, S::default());
        let off = state.velocity_command_m_per_s() - commanded;
        let allowed = 2e-9 + part * (from_kp + kp) * HELD_M;
        assert!(off.abs() < allowed, "{}, tick {n}: {off} m/s of {commanded}, allowed {allowed}", S::NAME);
        let expected = kv * state.velocity_command_m_per_s() + (from_kv - kv) * before * left;
        let off = force.value() - expected;
        let allowed = 2e-4 + part * (from_kv + kv) * (before + commanded);
        assert!(off.abs() < allowed, "{}, tick {n}: {off} N of {expected}, allowed {allowed}", S::NAME);
    }
    // 0.6 s are at least 24 time constants, e⁻²⁴ of an offset: less than a step in fixed point, where none is left.
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
        fades::<Fixed>(from, to);
        fades::<f32>(from, to);
        fades::<f64>(from, to);
    }
}

/// At a constant speed against friction b·v the integral gives the whole force, and nothing is left for it to learn: a
/// change of Kp with feed-forward of 100 %, where neither gain has an error to work on, changes nothing at all. An
/// integral that was lost would have to be learnt anew, b·v = 100 N of it.
fn keeps_its_integral<S: Scalar>() {
    let (rate, mass_kg, friction_n_s_per_m, speed) = (SLOWER.velocity_loop_hz, 60.0, 2000.0, 0.05);
    let config = |position_gain_per_s| {
        let settings =
            AxisSettings { position_gain_per_s, feedforward_percent: 100.0, ..AxisSettings::default() };
        AxisConfig::<S>::new(&settings, Rates { position_loop_divider: 1, ..SLOWER }).unwrap()
    };
    let (before, after) = (config(30.0), config(60.0));
    let mut state = AxisState::at_rest(Position(0), reading(Position(0)));
    let (mut command_m, mut at_m, mut velocity) = (0.0, 0.0, 0.0);
    let mut tick = |state: &mut AxisState<S>, config: &AxisConfig<S>| {
        command_m += speed / rate;
        let _ = state.position_tick(config, place(command_m), 0, reading(place(at_m)));
        let (force, _) = state.velocity_tick(config, reading(place(at_m)), S::default());
        velocity += (force.value() - friction_n_s_per_m * velocity) / mass_kg / rate;
        at_m += velocity / rate;
        force.value()
    };
    let steady = friction_n_s_per_m * speed;
    // The slowest part settles with 1/Kp: 2 s are 60 of them.
    let last = (0..40_000).map(|_| tick(&mut state, &before)).last().unwrap();
    // Kv·1 nm/s = 50 µN and a step of the force in fixed point; 2⁻²⁴ of a reading of 50 µm a tick in f32, 50 mN.
    let tolerance = 0.1;
    assert!((last - steady).abs() < tolerance, "{}: {last} N", S::NAME);
    state.change(&before, &after);
    for n in 0..20_000 {
        let force = tick(&mut state, &after);
        assert!((force - steady).abs() < tolerance, "{}, tick {n}: {force} N of {steady}", S::NAME);
    }
}

#[test]
fn a_change_of_gains_keeps_what_was_integrated() {
    keeps_its_integral::<Fixed>();
    keeps_its_integral::<f32>();
    keeps_its_integral::<f64>();
}

/// The filter of high-order position control has a gain of one at standstill: with an error that does not change, P and
/// HPC ask for the same Kp·x. Going over from one to the other and back, the command stays there in every tick, since
/// the filter starts settled on the error that the loop had; one that starts empty would fill up over some 1/Kp.
fn goes_over<S: Scalar>() {
    let kp = 40.0;
    let config = |law| {
        let settings = AxisSettings { law, position_gain_per_s: kp, ..AxisSettings::default() };
        AxisConfig::<S>::new(&settings, SLOWER).unwrap()
    };
    let laws = [config(Law::P), config(Law::Hpc), config(Law::P), config(Law::Hpc)];
    for held_m in [HELD_M, -HELD_M] {
        let motor = reading(Position(0));
        let mut state = AxisState::at_rest(Position(0), motor);
        let _ = state.position_tick(&laws[0], place(held_m), 0, motor);
        for change in laws.windows(2) {
            state.change(&change[0], &change[1]);
            for n in 0..1000 {
                let _ = state.position_tick(&change[1], place(held_m), 0, motor);
                let off = state.velocity_command_m_per_s() - kp * held_m;
                // Of fixed point, a gain within 2⁻²⁵ of 2.5e-3 and a step of the velocity; of f32, 2⁻²⁴ of all.
                assert!(off.abs() < 2e-9 + 2e-5 * kp * HELD_M, "{}, tick {n}: {off} m/s", S::NAME);
            }
        }
    }
}

#[test]
fn an_error_that_stands_is_the_same_to_p_and_hpc() {
    goes_over::<Fixed>();
    goes_over::<f32>();
    goes_over::<f64>();
}
