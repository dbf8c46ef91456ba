//! Seen in the force that the drive gives.

use std::f64::consts::TAU;

use host_sim::log::Channel;

use crate::bench::{
    PLAIN, ROUNDING_N, ROUNDING_UM, Seen, assert_all, assert_near, declared, fit, lines, of, run, with,
};

/// A force on the table: the drive gives it, too, and the screw bends by it, the other way.
fn assert_on_table(seen: &Seen, plain: &Seen, mm_s: f64, expected_n: f64) {
    let steady = seen.steady(mm_s);
    assert_all(&seen.moved(Channel::Force, plain), &steady, expected_n, ROUNDING_N, "force");
    let bent_um = -expected_n / declared().stiffness_n_per_um.unwrap();
    assert_all(&seen.drive_train_moved_um(plain), &steady, bent_um, ROUNDING_UM, "table − motor");
    // The integral part of the velocity loop leaves nothing of it in the motor's place.
    assert_all(&seen.moved(Channel::Motor, plain), &steady, 0.0, ROUNDING_UM, "motor");
}

/// Friction rises by excess·exp(−(v/vs)²), against the motion.
pub fn stribeck() {
    let (excess_n, vs_mm_s) = (80.0, 5.0);
    let motion = lines(&[(3.0, 2.0), (9.0, 5.0), (49.0, 40.0), (9.0, 40.0), (3.0, 5.0), (0.0, 2.0)]);
    let plain = run(PLAIN, &motion);
    let effect = format!("name = \"stribeck\"\nstatic_excess_n = {excess_n}\nvelocity_mm_s = {vs_mm_s}");
    let seen = run(&with(&effect), &motion);
    for mm_s in [2.0_f64, 5.0, 40.0, -40.0, -5.0, -2.0] {
        let rise_n = excess_n * (-(mm_s / vs_mm_s).powi(2)).exp();
        assert_on_table(&seen, &plain, mm_s, rise_n.copysign(mm_s));
    }
}

/// b + h forwards and b − h backwards: h·|v| more force, the same way for both.
pub fn friction_asymmetry() {
    let half = 300.0;
    let motion = lines(&[(40.0, 30.0), (160.0, 100.0), (40.0, 100.0), (0.0, 30.0)]);
    let plain = run(PLAIN, &motion);
    let effect = format!("name = \"friction_asymmetry\"\nhalf_difference_n_s_per_m = {half}");
    let seen = run(&with(&effect), &motion);
    for mm_s in [30.0_f64, 100.0, -100.0, -30.0] {
        assert_on_table(&seen, &plain, mm_s, 1e-3 * half * mm_s.abs());
    }
}

/// Against a constant force the drive pushes that much more, in both directions.
pub fn constant_load() {
    let force_n = 300.0;
    let motion = lines(&[(40.0, 50.0), (0.0, 50.0)]);
    let plain = run(PLAIN, &motion);
    let seen = run(&with(&format!("name = \"constant_load\"\nforce_n = {force_n}")), &motion);
    for mm_s in [50.0, -50.0] {
        assert_on_table(&seen, &plain, mm_s, force_n);
    }
}

/// A force d on the motor is answered with the force −L/(1 + L)·d and the way s·d/D, with
/// D = m·s³ + b·s² + Kv(s + Kp)(s + 1/Ti), at ω = 2π·v/period; 1/(1 + L) = s²(m·s + b)/D is 1e-4 there.
pub fn torque_ripple() {
    let (amplitude_n, period_mm, phase_rad, mm_s) = (50.0, 4.0, 0.3, 2.0);
    let motion = lines(&[(10.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect = format!(
        "name = \"torque_ripple\"\namplitude_n = {amplitude_n}\nperiod_mm = {period_mm}\nphase_rad = {phase_rad}"
    );
    let seen = run(&with(&effect), &motion);
    let axis = declared();
    let (kv, kp) = (axis.velocity_gain_n_s_per_m.unwrap(), axis.position_gain_per_s.unwrap());
    let per_ti = 1.0 / axis.velocity_integral_time_s.unwrap();
    let mass_kg = axis.motor_mass_kg.unwrap() + axis.table_mass_kg.unwrap();
    let omega: f64 = TAU * mm_s / period_mm;
    let real = kv * kp * per_ti - (kv + axis.viscous_n_s_per_m.unwrap()) * omega.powi(2);
    let imaginary = kv * (kp + per_ti) * omega - mass_kg * omega.powi(3);
    let way_um = 1e6 * amplitude_n * omega / real.hypot(imaginary);

    let motor_mm = seen.channel("x", Channel::Motor);
    for mm_s in [mm_s, -mm_s] {
        let steady = seen.steady(mm_s);
        let angle = |&i: &usize| TAU * motor_mm[i] / period_mm + phase_rad;
        let sines: Vec<f64> = steady.iter().map(|i| angle(i).sin()).collect();
        let cosines: Vec<f64> = steady.iter().map(|i| angle(i).cos()).collect();
        let parts = |values: Vec<f64>| -> Vec<f64> { fit([&sines, &cosines], &of(&values, &steady)) };
        // The tick in which the force answers, 0.25 ms, and 1/(1 + L) are 1e-3 of it together.
        let force = parts(seen.moved(Channel::Force, &plain));
        assert_near(force[0], -amplitude_n, 0.005 * amplitude_n, "force in phase");
        assert_near(force[1], 0.0, 0.005 * amplitude_n, "force across");
        assert_near(force[2], 0.0, ROUNDING_N, "mean force");
        // Friction's rise with speed within the wave is left out of D but for b: 2 %.
        let motor = parts(seen.moved(Channel::Motor, &plain));
        assert_near(motor[0].hypot(motor[1]), way_um, 0.02 * way_um, "motor");
        // What acts on the motor does not bend the screw: only the table's share of the wave's inertia does.
        assert_all(&seen.drive_train_moved_um(&plain), &steady, 0.0, ROUNDING_UM, "table − motor");
    }
}
