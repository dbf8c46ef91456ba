//! Effects in the controller, in the position of the motor.

use files::log::Channel;

use crate::runs::{PLAIN, ROUNDING_N, ROUNDING_UM, assert_all, declared, lines, run, with};

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
