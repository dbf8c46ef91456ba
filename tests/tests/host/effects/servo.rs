//! Effects in the controller, in the position of the motor.

use files::log::Channel;
use model::machine::Machine;
use plant::simulate::controller_setup;

use crate::effects::runs::{
    PLAIN, ROUNDING_N, ROUNDING_UM, RunLog, assert_all, changed, declared, lines, run, with,
};

/// At a constant velocity command − motor = v·(1 − Kf)/Kp′ with Kp′ = Kp·(1 + percent/100).
pub fn servo_mismatch() {
    let percent = 10.0;
    let motion = lines(&[(60.0, 50.0), (0.0, 50.0)]);
    let plain = run(PLAIN, &motion);
    let effect_run = run(&with(&format!("name = \"servo_mismatch\"\npercent = {percent}")), &motion);
    let axis = declared();
    let not_led = 1.0 - 0.01 * axis.controller.feedforward_percent.unwrap();
    let kp = axis.controller.position_gain_per_s.unwrap();
    for mm_s in [50.0, -50.0] {
        let steady = effect_run.steady(mm_s);
        for (run, gain) in [(&plain, kp), (&effect_run, kp * (1.0 + 0.01 * percent))] {
            let lag_um = run.difference_um(Channel::Command, Channel::Motor);
            // The transient has decayed to 1e-5.
            let expected_um = 1e3 * mm_s * not_led / gain;
            assert_all(&lag_um, &steady, expected_um, 1e-4 * expected_um.abs(), "command − motor");
        }
        assert_all(&effect_run.drive_train_change_um(&plain), &steady, 0.0, ROUNDING_UM, "table − motor");
        assert_all(&effect_run.change(Channel::Force, &plain), &steady, 0.0, ROUNDING_N, "force");
    }
}

/// Under a constant acceleration a the measured velocity is low by a·τ. The velocity loop raises the velocity by that
/// until the position loop balances it at a displacement of a·τ/Kp. At a constant velocity there is no effect.
pub fn velocity_lag() {
    let (lag_ms, m_per_s2, mm_s) = (0.2, 0.5, 300.0);
    let motion = lines(&[(400.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect_run = run(&with(&format!("name = \"velocity_lag\"\nms = {lag_ms}")), &motion);
    let change_um = effect_run.change(Channel::Motor, &plain);
    let ahead_um = 1e3 * m_per_s2 * lag_ms / declared().controller.position_gain_per_s.unwrap();
    assert_all(&change_um, &effect_run.accelerating(m_per_s2), ahead_um, 0.002 * ahead_um, "motor");
    for mm_s in [mm_s, -mm_s] {
        let steady = effect_run.steady(mm_s);
        assert_all(&change_um, &steady, 0.0, ROUNDING_UM, "motor");
        assert_all(&effect_run.drive_train_change_um(&plain), &steady, 0.0, ROUNDING_UM, "table − motor");
        assert_all(&effect_run.change(Channel::Force, &plain), &steady, 0.0, ROUNDING_N, "force");
    }
}

/// At a constant velocity command − motor = v·(1 − Kf′)/Kp with Kf′ = Kf + percent.
pub fn feedforward_mismatch() {
    let percent = 12.0;
    let motion = lines(&[(60.0, 50.0), (0.0, 50.0)]);
    let plain = run(PLAIN, &motion);
    let effect_run = run(&with(&format!("name = \"feedforward_mismatch\"\npercent = {percent}")), &motion);
    let axis = declared();
    let kf_percent = axis.controller.feedforward_percent.unwrap();
    let kp = axis.controller.position_gain_per_s.unwrap();
    for mm_s in [50.0, -50.0] {
        let steady = effect_run.steady(mm_s);
        for (run, kf_percent) in [(&plain, kf_percent), (&effect_run, kf_percent + percent)] {
            let lag_um = run.difference_um(Channel::Command, Channel::Motor);
            // The transient has decayed to 1e-5.
            let expected_um = 1e3 * mm_s * (1.0 - 0.01 * kf_percent) / kp;
            assert_all(&lag_um, &steady, expected_um, 1e-4 * expected_um.abs(), "command − motor");
        }
        assert_all(&effect_run.drive_train_change_um(&plain), &steady, 0.0, ROUNDING_UM, "table − motor");
        assert_all(&effect_run.change(Channel::Force, &plain), &steady, 0.0, ROUNDING_N, "force");
    }
}

/// Viscous friction at which a constant acceleration needs a ramp of the force, N·s/m.
const VISCOUS_N_S_PER_M: f64 = 20_000.0;

/// The machine with this friction.
fn viscous() -> String {
    let declared = format!("viscous_n_s_per_m = {:?} ", declared().mechanics.viscous_n_s_per_m.unwrap());
    changed(PLAIN, &declared, &format!("viscous_n_s_per_m = {VISCOUS_N_S_PER_M:?} "))
}

/// Under a constant acceleration a the force rises by b·a per second, for which the velocity loop needs the velocity
/// error b·a·Ti/Kv; the position loop balances it at a displacement of −b·a·Ti/(Kv·Kp). `ratio` is Ti′/Kv′ divided by
/// Ti/Kv.
fn assert_velocity_loop(effect: &str, ratio: f64) {
    let (m_per_s2, mm_s) = (0.5, 300.0);
    let motion = lines(&[(400.0, mm_s), (0.0, mm_s)]);
    let plain = run(&viscous(), &motion);
    let effect_run = run(&(viscous() + "\n[[axis.x.effect]]\n" + effect), &motion);
    let controller = declared().controller;
    let (kv, kp) = (controller.velocity_gain_n_s_per_m.unwrap(), controller.position_gain_per_s.unwrap());
    let error_m_per_s = VISCOUS_N_S_PER_M * m_per_s2 * controller.velocity_integral_time_s.unwrap() / kv;
    let expected_um = 1e6 * (1.0 - ratio) * error_m_per_s / kp;
    assert!(expected_um.abs() > 5.0, "{expected_um}");
    let change_um = effect_run.change(Channel::Motor, &plain);
    // The slowest pole of the loop with this friction is at −24 1/s: e^(−24·0.4) = 7e-5 of the displacement of 61 µm.
    let bound_um = ROUNDING_UM + 0.005;
    assert_all(&change_um, &effect_run.accelerating(m_per_s2), expected_um, bound_um, "motor");
    for mm_s in [mm_s, -mm_s] {
        let steady = effect_run.steady(mm_s);
        assert_all(&change_um, &steady, 0.0, bound_um, "motor");
        assert_all(&effect_run.change(Channel::Force, &plain), &steady, 0.0, ROUNDING_N, "force");
    }
}

/// Kv′ = Kv·(1 + percent/100).
pub fn velocity_gain_mismatch() {
    assert_velocity_loop("name = \"velocity_gain_mismatch\"\npercent = 25.0\n", 1.0 / 1.25);
}

/// Ti′ = Ti·(1 + percent/100).
pub fn integral_time_mismatch() {
    assert_velocity_loop("name = \"integral_time_mismatch\"\npercent = -20.0\n", 0.8);
}

/// Effects that only one loop of a controller has. The tracer's closed loop has them, and tests them
/// (`host-sim/trace/src/prediction/controller_readings.rs`).
pub const NOT_SIMULATED: [&str; 2] =
    ["name = \"loop_delay\"\nms = 1.0", "name = \"position_delay\"\nms = 2.0"];

/// They are refused by name.
#[test]
fn an_effect_within_the_controller_of_the_machine_is_not_simulated() {
    let filter = "name = \"velocity_lag\"\ntime_constant_ms = 0.4";
    for (effect, name) in
        NOT_SIMULATED.into_iter().chain([filter]).zip(["loop_delay", "position_delay", "velocity_lag"])
    {
        let machine = Machine::parse(&with(effect), "m.toml").unwrap();
        let Err(error) = controller_setup(&machine, &[0.0, 0.0]) else { panic!("{effect} is simulated") };
        let text = error.to_string();
        assert!(
            text.starts_with(&format!("axis.x: the effect {name}")) && text.contains("cannot be simulated"),
            "{text}"
        );
    }
}

/// Under a constant acceleration a, the force that viscous friction b needs rises by b·a per second: the commanded force is ahead
/// by the dead time.
pub fn drive_dead_time() {
    let (dead_ms, m_per_s2, mm_s) = (0.6, 0.5, 300.0);
    let machine = changed(&viscous(), "sample_rate_hz = 1000.0 ", "sample_rate_hz = 4000.0 ");
    let motion = lines(&[(400.0, mm_s)]);
    let plain = run(&machine, &motion);
    let effect_run = run(
        &format!("{machine}\n[[axis.x.effect]]\nname = \"drive_dead_time\"\nms = {dead_ms:?}\n"),
        &motion,
    );
    let change_n = effect_run.change(Channel::Force, &plain);
    let more_n = 1e-3 * dead_ms * VISCOUS_N_S_PER_M * m_per_s2;
    assert_all(&change_n, &effect_run.accelerating(m_per_s2), more_n, 0.005 * more_n, "force");
    let steady = effect_run.steady(mm_s);
    assert_all(&change_n, &steady, 0.0, ROUNDING_N, "force");
    assert_all(&effect_run.change(Channel::Table, &plain), &steady, 0.0, ROUNDING_UM, "table");
}

/// The first force follows the first step of the command two periods later. Once the acceleration is constant, the integral has
/// taken up the delay: position and acting force, which is the logged one, are as without it.
pub fn computation_delay() {
    let (periods, m_per_s2, mm_s) = (2, 0.5, 300.0);
    let machine = changed(&viscous(), "sample_rate_hz = 1000.0 ", "sample_rate_hz = 4000.0 ");
    let motion = lines(&[(400.0, mm_s)]);
    let plain = run(&machine, &motion);
    let effect = format!("\n[[axis.x.effect]]\nname = \"computation_delay\"\nperiods = {periods}.0\n");
    let effect_run = run(&(machine + &effect), &motion);
    let first =
        |run: &RunLog| run.channel("x", Channel::Force).iter().position(|n| n.abs() > ROUNDING_N).unwrap();
    assert_eq!(first(&effect_run) - first(&plain), periods);
    for samples in [effect_run.accelerating(m_per_s2), effect_run.steady(mm_s)] {
        assert_all(&effect_run.change(Channel::Force, &plain), &samples, 0.0, ROUNDING_N, "force");
        assert_all(&effect_run.change(Channel::Motor, &plain), &samples, 0.0, ROUNDING_UM, "motor");
    }
}

/// Under a ramp of the force, a drive with the lag τ is low by τ·dF/dt: the commanded force is higher by τ·b·a under a
/// constant acceleration, and unchanged at a constant velocity. The lag replaces that of the instruments.
pub fn drive_lag() {
    let (lag_ms, m_per_s2, mm_s) = (1.0, 0.5, 300.0);
    // Both loops at the same rate: a log of every fourth tick has one of the four forces between two steps of the
    // position loop, not their mean.
    let machine = changed(&viscous(), "sample_rate_hz = 1000.0 ", "sample_rate_hz = 4000.0 ");
    let motion = lines(&[(400.0, mm_s)]);
    let plain = run(&machine, &motion);
    let effect_run =
        run(&format!("{machine}\n[[axis.x.effect]]\nname = \"drive_lag\"\nms = {lag_ms:?}\n"), &motion);
    let change_n = effect_run.change(Channel::Force, &plain);
    let more_n = 1e-3 * lag_ms * VISCOUS_N_S_PER_M * m_per_s2;
    assert_all(&change_n, &effect_run.accelerating(m_per_s2), more_n, 0.005 * more_n, "force");
    let steady = effect_run.steady(mm_s);
    assert_all(&change_n, &steady, 0.0, ROUNDING_N, "force");
    assert_all(&effect_run.change(Channel::Table, &plain), &steady, 0.0, ROUNDING_UM, "table");
}
