//! What sits in the drive: seen in the place of the motor.

use files::log::Channel;

use crate::bench::{PLAIN, ROUNDING_N, ROUNDING_UM, assert_all, declared, lines, run, with};

/// At a steady speed command − motor = v·(1 − Kf)/Kp′ with Kp′ = Kp·(1 + percent/100).
pub fn servo_mismatch() {
    let percent = 10.0;
    let motion = lines(&[(60.0, 50.0), (0.0, 50.0)]);
    let plain = run(PLAIN, &motion);
    let seen = run(&with(&format!("name = \"servo_mismatch\"\npercent = {percent}")), &motion);
    let axis = declared();
    let share = 1.0 - 0.01 * axis.controller.feedforward_percent.unwrap();
    let kp = axis.controller.position_gain_per_s.unwrap();
    for mm_s in [50.0, -50.0] {
        let steady = seen.steady(mm_s);
        for (run, gain) in [(&plain, kp), (&seen, kp * (1.0 + 0.01 * percent))] {
            let behind_um = run.beyond_um(Channel::Command, Channel::Motor);
            // Settled to 1e-5 of it.
            let expected_um = 1e3 * mm_s * share / gain;
            assert_all(&behind_um, &steady, expected_um, 1e-4 * expected_um.abs(), "command − motor");
        }
        assert_all(&seen.drive_train_moved_um(&plain), &steady, 0.0, ROUNDING_UM, "table − motor");
        assert_all(&seen.moved(Channel::Force, &plain), &steady, 0.0, ROUNDING_N, "force");
    }
}

/// While it speeds up evenly, the loop sees a speed a·τ too low and asks for that much more; the position loop takes it
/// back at a way of a·τ/Kp. At a steady speed nothing of it is left.
pub fn velocity_lag() {
    let (lag_ms, m_per_s2, mm_s) = (0.2, 0.5, 300.0);
    let motion = lines(&[(400.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let seen = run(&with(&format!("name = \"velocity_lag\"\nms = {lag_ms}")), &motion);
    let moved_um = seen.moved(Channel::Motor, &plain);
    let ahead_um = 1e3 * m_per_s2 * lag_ms / declared().controller.position_gain_per_s.unwrap();
    assert_all(&moved_um, &seen.speeding_up(m_per_s2), ahead_um, 0.002 * ahead_um, "motor");
    for mm_s in [mm_s, -mm_s] {
        let steady = seen.steady(mm_s);
        assert_all(&moved_um, &steady, 0.0, ROUNDING_UM, "motor");
        assert_all(&seen.drive_train_moved_um(&plain), &steady, 0.0, ROUNDING_UM, "table − motor");
        assert_all(&seen.moved(Channel::Force, &plain), &steady, 0.0, ROUNDING_N, "force");
    }
}
