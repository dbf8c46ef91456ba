//! Between motor and table: what the screw and its readings do.

use std::f64::consts::TAU;

use files::log::Channel;

use crate::bench::{
    PLAIN, ROUNDING_N, ROUNDING_UM, Seen, assert_all, assert_near, changed, declared, lines, mean, run, with,
};

/// The screw pushes at one edge of the gap and then at the other: table − motor ∓ width/2.
///
/// Spring and friction are the same at the same speed, so that nothing else is left of the difference.
pub fn backlash() {
    let width_um: f64 = 12.0;
    let motion = lines(&[(60.0, 50.0), (0.0, 50.0)]);
    let plain = run(PLAIN, &motion);
    let seen = run(&with(&format!("name = \"backlash\"\nwidth_um = {width_um}")), &motion);
    let moved_um = seen.drive_train_moved_um(&plain);
    for mm_s in [50.0_f64, -50.0] {
        let steady = seen.steady(mm_s);
        let expected_um = -(0.5 * width_um).copysign(mm_s);
        assert_all(&moved_um, &steady, expected_um, ROUNDING_UM, "table − motor");
        // The motor is what is fed back: it and its force are where they were.
        assert_all(&seen.moved(Channel::Motor, &plain), &steady, 0.0, ROUNDING_UM, "motor");
        assert_all(&seen.moved(Channel::Force, &plain), &steady, 0.0, ROUNDING_N, "force");
    }
}

/// How far the table has gone back (µm) when the motor has gone back by a way, and how far the motor has by then.
fn followed_um(seen: &Seen, way_um: f64) -> [f64; 2] {
    let [motor, table] = [Channel::Motor, Channel::Table].map(|channel| seen.channel("x", channel));
    let turn = (0..motor.len()).max_by(|&a, &b| motor[a].total_cmp(&motor[b])).unwrap();
    let there = (turn..motor.len()).find(|&i| 1e3 * (motor[turn] - motor[i]) > way_um).unwrap();
    [table, motor].map(|place| 1e3 * (place[turn] - place[there]))
}

/// While the motor crosses the gap the table stands, where no bristles of the guideway carry it; further on it is
/// behind by the gap.
#[test]
fn the_table_stands_while_the_motor_crosses_the_gap() {
    let width_um = 12.0;
    let stiff = "presliding_stiffness_n_per_um = 40.0 ";
    let damping = "presliding_damping_n_s_per_m = 2000.0 ";
    let without = |machine: &str| changed(&changed(machine, stiff, "# "), damping, "# ");
    let motion = lines(&[(10.0, 50.0), (0.0, 50.0)]);
    let seen = |machine: &str| run(&without(machine), &motion);
    let (plain, gap) = (seen(PLAIN), seen(&with(&format!("name = \"backlash\"\nwidth_um = {width_um:?}"))));
    // It turns when the screw no longer pushes it, some 10 nm behind the motor's turn.
    assert_near(followed_um(&gap, width_um)[0], 0.0, 0.03, "table in the gap");
    let lost_um = |seen: &Seen| {
        let [table_um, motor_um] = followed_um(seen, 40.0);
        motor_um - table_um
    };
    // Without a gap the screw is bent over from one side of the friction to the other; 250 kg · 0.5 m/s² on either
    // side are 125 N more or less.
    let axis = declared();
    let (coulomb_n, k) = (axis.mechanics.coulomb_n.unwrap(), axis.mechanics.stiffness_n_per_um.unwrap());
    let inertia_n = 0.5 * axis.mechanics.table_mass_kg.unwrap();
    assert_near(lost_um(&plain), 2.0 * coulomb_n / k, 2.0 * inertia_n / k, "lost without a gap");
    assert_near(lost_um(&gap) - lost_um(&plain), width_um, 2.0 * inertia_n / k, "lost in the gap");
}

/// Table = (1 + slope)·motor.
pub fn pitch_progressive() {
    let slope_um_per_m = 40.0;
    let motion = lines(&[(100.0, 50.0), (0.0, 50.0)]);
    let plain = run(PLAIN, &motion);
    let effect = format!("name = \"pitch_progressive\"\nslope_um_per_m = {slope_um_per_m}");
    let seen = run(&with(&effect), &motion);
    let moved_um = seen.drive_train_moved_um(&plain);
    let motor_mm = seen.channel("x", Channel::Motor);
    for (&moved_um, &motor_mm) in moved_um.iter().zip(motor_mm) {
        // The rest is what 40 µm/m more speed changes of the forces: some mN over 200 N/µm.
        assert_near(moved_um, 1e-3 * slope_um_per_m * motor_mm, ROUNDING_UM, "table − motor");
    }
    let longest = motor_mm.iter().copied().fold(0.0, f64::max);
    assert_near(longest, 100.0, 0.5, "the slope is seen over the whole travel");
}

/// Table = motor + A·sin(2π·motor/period + phase).
///
/// To carry the wave the screw has to push: with ω = 2π·v/period, m·A·ω² for the mass and (c + b)·A·ω for what damps,
/// which bends it by that over k.
pub fn pitch_cyclic() {
    let (amplitude_um, period_mm, phase_rad, mm_s) = (2.0, 16.0, 0.7, 50.0);
    let motion = lines(&[(100.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect = format!(
        "name = \"pitch_cyclic\"\namplitude_um = {amplitude_um}\nperiod_mm = {period_mm}\nphase_rad = {phase_rad}"
    );
    let seen = run(&with(&effect), &motion);
    let axis = declared();
    let omega = TAU * mm_s / period_mm;
    let damping = axis.mechanics.damping_n_s_per_m.unwrap() + axis.mechanics.viscous_n_s_per_m.unwrap();
    let push_n_per_um = 1e-6 * (axis.mechanics.table_mass_kg.unwrap() * omega * omega + damping * omega);
    let bound_um = ROUNDING_UM + amplitude_um * push_n_per_um / axis.mechanics.stiffness_n_per_um.unwrap();
    assert!(bound_um < 0.01 * amplitude_um, "{bound_um}");
    let moved_um = seen.drive_train_moved_um(&plain);
    let motor_mm = seen.channel("x", Channel::Motor);
    for i in [seen.steady(mm_s), seen.steady(-mm_s)].concat() {
        let expected_um = amplitude_um * (TAU * motor_mm[i] / period_mm + phase_rad).sin();
        assert_near(moved_um[i], expected_um, bound_um, "table − motor");
    }
}

/// Reading = motor + A·sin(2π·motor/period + phase); what is fed back is the reading, so it is the motor, and the table
/// with it, that makes the wave, the other way round.
///
/// The loops leave |s²(m·s + b)/(m·s³ + b·s² + Kv(s + Kp)(s + 1/Ti))| = 2e-4 of it in the reading at ω = 2π·v/period.
pub fn resolver_dividing() {
    let (amplitude_um, period_mm, phase_rad, mm_s) = (1.0, 3.2, 0.4, 2.0);
    let motion = lines(&[(6.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect = format!(
        "name = \"resolver_dividing\"\namplitude_um = {amplitude_um}\nperiod_mm = {period_mm}\n\
         phase_rad = {phase_rad}"
    );
    let seen = run(&with(&effect), &motion);
    let [moved_um, table_um, reading_um] = [
        seen.drive_train_moved_um(&plain),
        seen.moved(Channel::Table, &plain),
        seen.moved(Channel::Motor, &plain),
    ];
    let reading_mm = seen.channel("x", Channel::Motor);
    for i in [seen.steady(mm_s), seen.steady(-mm_s)].concat() {
        let wave = |motor_mm: f64| amplitude_um * (TAU * motor_mm / period_mm + phase_rad).sin();
        let true_mm = reading_mm[i] - 1e-3 * wave(reading_mm[i]);
        // Putting the wave into its own argument once leaves (2π·A/period)² of it: 4e-6.
        assert_near(moved_um[i], -wave(true_mm), ROUNDING_UM, "table − motor");
        assert_near(table_um[i], -wave(true_mm), 2.0 * ROUNDING_UM, "table");
        assert_near(reading_um[i], 0.0, ROUNDING_UM, "motor");
    }
}

/// Under the force F of guideway and mass the screw gives by F/k: table − motor changes by −F·(1/k′ − 1/k).
pub fn windup() {
    let softer_n_per_um = 120.0;
    let mm_s = 200.0;
    let motion = lines(&[(250.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let seen = run(&with(&format!("name = \"windup\"\nstiffness_n_per_um = {softer_n_per_um}")), &motion);
    let axis = declared();
    let more_um_per_n = 1.0 / softer_n_per_um - 1.0 / axis.mechanics.stiffness_n_per_um.unwrap();
    let moved_um = seen.drive_train_moved_um(&plain);
    let friction_n = |mm_s: f64| {
        axis.mechanics.coulomb_n.unwrap().copysign(mm_s)
            + 1e-3 * mm_s * axis.mechanics.viscous_n_s_per_m.unwrap()
    };
    for mm_s in [mm_s, -mm_s] {
        let steady = seen.steady(mm_s);
        let expected_um = -friction_n(mm_s) * more_um_per_n;
        assert_all(&moved_um, &steady, expected_um, ROUNDING_UM, "table − motor");
        assert_all(&seen.moved(Channel::Force, &plain), &steady, 0.0, ROUNDING_N, "force");
        assert_near(mean(&seen.moved(Channel::Motor, &plain), &steady), 0.0, ROUNDING_UM, "motor");
    }
}
