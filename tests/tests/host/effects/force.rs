//! Effects that are forces on table or motor, in the force of the drive.

use std::f64::consts::TAU;

use files::log::Channel;
use model::axis::KeyNames;
use model::machine::Machine;
use plant::instruments::Instruments;

use crate::effects::runs::{
    PLAIN, ROUNDING_N, ROUNDING_UM, RunLog, assert_all, assert_near, at, changed, declared, difference, fit,
    lines, run, run_with, with,
};

/// Asserts the effect of a force on the table: the drive compensates it, and the screw is stretched by it.
fn assert_on_table(effect_run: &RunLog, plain: &RunLog, mm_s: f64, expected_n: f64) {
    let steady = effect_run.steady(mm_s);
    assert_all(&effect_run.change(Channel::Force, plain), &steady, expected_n, ROUNDING_N, "force");
    let stretch_um = -expected_n / declared().mechanics.stiffness_n_per_um.unwrap();
    assert_all(&effect_run.drive_train_change_um(plain), &steady, stretch_um, ROUNDING_UM, "table − motor");
    // The integral part of the velocity loop removes its effect on the motor.
    assert_all(&effect_run.change(Channel::Motor, plain), &steady, 0.0, ROUNDING_UM, "motor");
}

/// Friction rises by excess·exp(−(v/vs)²), against the motion.
pub fn stribeck() {
    let (excess_n, vs_mm_s) = (80.0, 5.0);
    let motion = lines(&[(3.0, 2.0), (9.0, 5.0), (49.0, 40.0), (9.0, 40.0), (3.0, 5.0), (0.0, 2.0)]);
    let plain = run(PLAIN, &motion);
    let effect = format!("name = \"stribeck\"\nstatic_excess_n = {excess_n}\nvelocity_mm_s = {vs_mm_s}");
    let effect_run = run(&with(&effect), &motion);
    for mm_s in [2.0_f64, 5.0, 40.0, -40.0, -5.0, -2.0] {
        let rise_n = excess_n * (-(mm_s / vs_mm_s).powi(2)).exp();
        assert_on_table(&effect_run, &plain, mm_s, rise_n.copysign(mm_s));
    }
}

/// Friction of the motor rises by excess·exp(−(v/vs)²), against the motion. The drive compensates it, and the screw
/// does not transmit it.
pub fn motor_stribeck() {
    let (excess_n, vs_mm_s) = (80.0, 5.0);
    let motion = lines(&[(3.0, 2.0), (9.0, 5.0), (49.0, 40.0), (9.0, 40.0), (3.0, 5.0), (0.0, 2.0)]);
    let plain = run(PLAIN, &motion);
    let effect =
        format!("name = \"motor_stribeck\"\nstatic_excess_n = {excess_n}\nvelocity_mm_s = {vs_mm_s}");
    let effect_run = run(&with(&effect), &motion);
    for mm_s in [2.0_f64, 5.0, 40.0, -40.0, -5.0, -2.0] {
        let rise_n = excess_n * (-(mm_s / vs_mm_s).powi(2)).exp();
        let steady = effect_run.steady(mm_s);
        let expected_n = rise_n.copysign(mm_s);
        assert_all(&effect_run.change(Channel::Force, &plain), &steady, expected_n, ROUNDING_N, "force");
        assert_all(&effect_run.drive_train_change_um(&plain), &steady, 0.0, ROUNDING_UM, "table − motor");
    }
}

/// For the force F that the motion needs, a drive that lacks a part a in one direction is commanded F/(1 − a) in this direction.
pub fn drive_asymmetry() {
    let motion = lines(&[(60.0, 50.0), (0.0, 50.0)]);
    let plain = run(PLAIN, &motion);
    for percent in [8.0_f64, -8.0] {
        let effect_run = run(&with(&format!("name = \"drive_asymmetry\"\npercent = {percent:?}")), &motion);
        for mm_s in [50.0, -50.0] {
            let steady = effect_run.steady(mm_s);
            let needed_n = at(plain.force_n(), &steady)[0];
            let is_weak = mm_s * percent > 0.0;
            let expected_n = if is_weak { needed_n / (1.0 - 0.01 * percent.abs()) - needed_n } else { 0.0 };
            assert_all(&effect_run.change(Channel::Force, &plain), &steady, expected_n, ROUNDING_N, "force");
            assert_all(&effect_run.drive_train_change_um(&plain), &steady, 0.0, ROUNDING_UM, "table − motor");
        }
    }
}

/// b + h forwards and b − h backwards: h·|v| more force in + direction for both.
pub fn friction_asymmetry() {
    let half = 300.0;
    let motion = lines(&[(40.0, 30.0), (160.0, 100.0), (40.0, 100.0), (0.0, 30.0)]);
    let plain = run(PLAIN, &motion);
    let effect = format!("name = \"friction_asymmetry\"\nhalf_difference_n_s_per_m = {half}");
    let effect_run = run(&with(&effect), &motion);
    for mm_s in [30.0_f64, 100.0, -100.0, -30.0] {
        assert_on_table(&effect_run, &plain, mm_s, 1e-3 * half * mm_s.abs());
    }
}

/// The drive compensates a constant force in both directions.
pub fn constant_load() {
    let force_n = 300.0;
    let motion = lines(&[(40.0, 50.0), (0.0, 50.0)]);
    let plain = run(PLAIN, &motion);
    let effect_run = run(&with(&format!("name = \"constant_load\"\nforce_n = {force_n}")), &motion);
    for mm_s in [50.0, -50.0] {
        assert_on_table(&effect_run, &plain, mm_s, force_n);
    }
}

/// Asserts that the drive compensates a load over the position (mm) in both directions of an axis, and that the screw is stretched by it. The load
/// changes by at most 62 N/s, and the response of the loop takes some 10 ms.
fn assert_load([plain, with]: [&str; 2], load_n: impl Fn(f64) -> f64) {
    let mm_s = 20.0;
    let motion = lines(&[(60.0, mm_s), (0.0, mm_s)]);
    let [plain, effect_run] = [plain, with].map(|machine| run(machine, &motion));
    let table_mm = effect_run.channel("x", Channel::Table);
    let expected_n: Vec<f64> = table_mm.iter().map(|mm| load_n(*mm)).collect();
    let stretch_um: Vec<f64> =
        expected_n.iter().map(|n| -n / declared().mechanics.stiffness_n_per_um.unwrap()).collect();
    let force_error = difference(&effect_run.change(Channel::Force, &plain), &expected_n);
    let stretch_error = difference(&effect_run.drive_train_change_um(&plain), &stretch_um);
    for mm_s in [mm_s, -mm_s] {
        let steady = effect_run.steady(mm_s);
        assert_all(&force_error, &steady, 0.0, ROUNDING_N + 0.9, "force");
        assert_all(&stretch_error, &steady, 0.0, ROUNDING_UM + 0.005, "table − motor");
    }
    let largest_n = expected_n.iter().fold(0.0f64, |max, n| max.max(n.abs()));
    assert!(largest_n > 50.0, "{largest_n}");
}

/// slope·(x − c) + curvature·(x − c)², which changes by slope and twice the curvature, times 20 mm/s.
pub fn position_load() {
    let (centre_mm, slope, curvature) = (20.0, 1500.0, 20_000.0);
    let effect = format!(
        "name = \"position_load\"\nslope_n_per_m = {slope:?}\ncentre_mm = {centre_mm:?}\n\
         curvature_n_per_m2 = {curvature:?}"
    );
    assert_load([PLAIN, &with(&effect)], |mm| {
        let x_m = 1e-3 * (mm - centre_mm);
        x_m * (slope + curvature * x_m)
    });
}

/// sine·sin q + cosine·cos q, at 20°/s by at most 100 N·m · 0.35 rad/s = 35 N·m/s. The axis has the keys of a rotary one, of the same values.
pub fn gravity() {
    let mut machine = Machine::parse(PLAIN, "vmc.toml").unwrap();
    machine.axis["x"].settings.names = KeyNames::Rotary;
    let plain = machine.to_toml();
    let effect = "[[axis.x.effect]]\nname = \"gravity\"\nsine_nm = 80.0\ncosine_nm = -60.0";
    assert_load([&plain, &format!("{plain}\n{effect}\n")], |deg| {
        let (sine, cosine) = deg.to_radians().sin_cos();
        80.0 * sine - 60.0 * cosine
    });
}

/// Friction rises by force·exp(−t/τ), t on the session clock, which a run need not start at zero.
pub fn friction_warm_up() {
    let (force_n, time_constant_s, start_s, mm_s): (f64, f64, f64, f64) = (90.0, 4.0, 3.0, 20.0);
    let motion = lines(&[(60.0, mm_s), (0.0, mm_s)]);
    let run = |machine: &str| run_with(machine, &motion, start_s, |_| Instruments::default());
    let plain = run(PLAIN);
    let effect =
        format!("name = \"friction_warm_up\"\nforce_n = {force_n}\ntime_constant_s = {time_constant_s}");
    let effect_run = run(&with(&effect));
    let change_n = effect_run.change(Channel::Force, &plain);
    let stretch_um = effect_run.drive_train_change_um(&plain);
    for mm_s in [mm_s, -mm_s] {
        for i in effect_run.steady(mm_s) {
            let time_s = start_s + i as f64 * effect_run.log.sample_time_s;
            let expected_n = (force_n * (-time_s / time_constant_s).exp()).copysign(mm_s);
            // Friction falls by up to 10 N/s, and the response of the loop takes some 10 ms.
            assert_near(change_n[i], expected_n, ROUNDING_N + 0.2, "force");
            let expected_um = -expected_n / declared().mechanics.stiffness_n_per_um.unwrap();
            assert_near(stretch_um[i], expected_um, ROUNDING_UM + 0.002, "table − motor");
        }
    }
}

/// Friction rises by the map, a natural cubic spline through three knots (by hand: between knots at a distance h, with
/// B = y₀ − 2y₁ + y₂ and u = (x − x₁)/h, it is y₁ + (y₂ − y₀)/2·u + B·(3u²/4 − |u|³/4)), against the motion.
pub fn friction_map() {
    let (positions_mm, friction_n, mm_s) = ([10.0, 30.0, 50.0], [40.0, -30.0, 10.0], 20.0);
    let motion = lines(&[(60.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect =
        format!("name = \"friction_map\"\npositions_mm = {positions_mm:?}\nfriction_n = {friction_n:?}");
    let effect_run = run(&with(&effect), &motion);
    let table_mm = effect_run.channel("x", Channel::Table);
    let level_n = |mm: f64| {
        let [y0, y1, y2] = friction_n;
        let u = ((mm - 30.0) / 20.0).clamp(-1.0, 1.0);
        y1 + 0.5 * (y2 - y0) * u + (y0 - 2.0 * y1 + y2) * (0.75 * u * u - 0.25 * u.abs().powi(3))
    };
    let change_n = effect_run.change(Channel::Force, &plain);
    let stretch_um = effect_run.drive_train_change_um(&plain);
    for mm_s in [mm_s, -mm_s] {
        for i in effect_run.steady(mm_s) {
            let expected_n = level_n(table_mm[i]) * mm_s.signum();
            // Friction changes by up to 110 N/s, and the response of the loop takes some 10 ms.
            assert_near(change_n[i], expected_n, ROUNDING_N + 1.2, "force");
            let expected_um = -expected_n / declared().mechanics.stiffness_n_per_um.unwrap();
            assert_near(stretch_um[i], expected_um, ROUNDING_UM + 0.006, "table − motor");
        }
    }
}

/// The loop responds to a force d on the motor with the force −L/(1 + L)·d and the displacement s·d/D, where
/// D = m·s³ + b·s² + Kv(s + Kp)(s + 1/Ti), at ω = 2π·v/period; 1/(1 + L) = s²(m·s + b)/D is 1e-4 there.
pub fn torque_ripple() {
    let (amplitude_n, period_mm, phase_rad, mm_s) = (50.0, 4.0, 0.3, 2.0);
    let motion = lines(&[(10.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect = format!(
        "name = \"torque_ripple\"\namplitude_n = {amplitude_n}\nperiod_mm = {period_mm}\nphase_rad = {phase_rad}"
    );
    let effect_run = run(&with(&effect), &motion);
    let axis = declared();
    let (kv, kp) =
        (axis.controller.velocity_gain_n_s_per_m.unwrap(), axis.controller.position_gain_per_s.unwrap());
    let per_ti = 1.0 / axis.controller.velocity_integral_time_s.unwrap();
    let mass_kg = axis.mechanics.motor_mass_kg.unwrap() + axis.mechanics.table_mass_kg.unwrap();
    let omega: f64 = TAU * mm_s / period_mm;
    let real = kv * kp * per_ti - (kv + axis.mechanics.viscous_n_s_per_m.unwrap()) * omega.powi(2);
    let imaginary = kv * (kp + per_ti) * omega - mass_kg * omega.powi(3);
    let travel_um = 1e6 * amplitude_n * omega / real.hypot(imaginary);

    let motor_mm = effect_run.channel("x", Channel::Motor);
    for mm_s in [mm_s, -mm_s] {
        let steady = effect_run.steady(mm_s);
        let angle = |&i: &usize| TAU * motor_mm[i] / period_mm + phase_rad;
        let sines: Vec<f64> = steady.iter().map(|i| angle(i).sin()).collect();
        let cosines: Vec<f64> = steady.iter().map(|i| angle(i).cos()).collect();
        let parts = |values: Vec<f64>| -> Vec<f64> { fit([&sines, &cosines], &at(&values, &steady)) };
        // The delay of a tick, 0.25 ms, and 1/(1 + L) are 1e-3 of it.
        let force = parts(effect_run.change(Channel::Force, &plain));
        assert_near(force[0], -amplitude_n, 0.005 * amplitude_n, "force in phase");
        assert_near(force[1], 0.0, 0.005 * amplitude_n, "force in quadrature");
        assert_near(force[2], 0.0, ROUNDING_N, "mean force");
        // D neglects the dependence of friction on velocity except b: 2 %.
        let motor = parts(effect_run.change(Channel::Motor, &plain));
        assert_near(motor[0].hypot(motor[1]), travel_um, 0.02 * travel_um, "motor");
        // A force on the motor does not stretch the screw, except by the inertia of the table.
        assert_all(&effect_run.drive_train_change_um(&plain), &steady, 0.0, ROUNDING_UM, "table − motor");
    }
}

/// The effect equals the declared keys to the last bit, and has an effect on the force.
pub fn presliding() {
    let motion = lines(&[(3.0, 20.0), (0.0, 20.0), (3.0, 20.0)]);
    let keys = "presliding_stiffness_n_per_um = 40.0    # guideway before it slides (LuGre σ0)\n\
                presliding_damping_n_s_per_m = 2000.0   # guideway before it slides (LuGre σ1)\n";
    let without = changed(PLAIN, keys, "");
    let effect =
        "\n[[axis.x.effect]]\nname = \"presliding\"\nstiffness_n_per_um = 40.0\ndamping_n_s_per_m = 2000.0\n";
    let plain = run(PLAIN, &motion);
    run(&(without.clone() + effect), &motion).assert_same(&plain, &[]);
    let change_n = run(&without, &motion).change(Channel::Force, &plain);
    // At a reversal the friction rises at once, or over micrometres.
    let max_n = change_n.iter().fold(0.0f64, |max, n| max.max(n.abs()));
    assert!(max_n > 0.1 * declared().mechanics.coulomb_n.unwrap(), "{max_n}");
}

/// Friction drops by force·exp(−|v|/vs).
pub fn shear_thinning() {
    let (force_n, vs_mm_s) = (80.0, 5.0);
    let motion = lines(&[(3.0, 2.0), (9.0, 5.0), (49.0, 40.0), (9.0, 40.0), (3.0, 5.0), (0.0, 2.0)]);
    let plain = run(PLAIN, &motion);
    let effect = format!("name = \"shear_thinning\"\nforce_n = {force_n}\nvelocity_mm_s = {vs_mm_s}");
    let effect_run = run(&with(&effect), &motion);
    for mm_s in [2.0_f64, 5.0, 40.0, -40.0, -5.0, -2.0] {
        let lack_n = force_n * (-mm_s.abs() / vs_mm_s).exp();
        assert_on_table(&effect_run, &plain, mm_s, -lack_n.copysign(mm_s));
    }
}

/// At a constant velocity no effect; under a constant acceleration a the filtered speed lags by a·τ, and friction is
/// lower by c·a·τ.
pub fn friction_memory() {
    let (viscous, time_constant_s, m_per_s2) = (400.0, 0.05, 0.5);
    let motion = lines(&[(200.0, 400.0), (0.0, 100.0)]);
    let plain = run(PLAIN, &motion);
    let effect = format!(
        "name = \"friction_memory\"\nviscous_n_s_per_m = {viscous}\ntime_constant_s = {time_constant_s}"
    );
    let effect_run = run(&with(&effect), &motion);
    assert_on_table(&effect_run, &plain, -100.0, 0.0);
    let moved = effect_run.change(Channel::Force, &plain);
    let expected_n = -viscous * m_per_s2 * time_constant_s;
    assert_all(&moved, &effect_run.accelerating(m_per_s2), expected_n, ROUNDING_N, "force");
}

/// c·v·|v| more force against the motion.
pub fn quadratic_drag() {
    let newton = 2000.0;
    let motion = lines(&[(40.0, 30.0), (160.0, 100.0), (40.0, 100.0), (0.0, 30.0)]);
    let plain = run(PLAIN, &motion);
    let effect_run = run(&with(&format!("name = \"quadratic_drag\"\nforce_n = {newton}")), &motion);
    for mm_s in [30.0_f64, 100.0, -100.0, -30.0] {
        assert_on_table(&effect_run, &plain, mm_s, 1e-6 * newton * mm_s * mm_s.abs());
    }
}

/// Friction rises by slope·(x − c) + curvature·(x − c)² at the position x.
pub fn preload_variation() {
    let (centre_mm, slope, curvature, mm_s) = (20.0, 300.0, 8000.0, 20.0);
    let motion = lines(&[(60.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect = format!(
        "name = \"preload_variation\"\ncentre_mm = {centre_mm}\nslope_n_per_m = {slope}\n\
         curvature_n_per_m2 = {curvature}"
    );
    let effect_run = run(&with(&effect), &motion);
    let table_mm = effect_run.channel("x", Channel::Table);
    for mm_s in [mm_s, -mm_s] {
        let expected = |mm: &f64| {
            let x_m = 1e-3 * (mm - centre_mm);
            mm_s.signum() * x_m * (slope + curvature * x_m)
        };
        let expected: Vec<f64> = table_mm.iter().map(expected).collect();
        let error = difference(&effect_run.change(Channel::Force, &plain), &expected);
        // Friction rises by up to 20 N/s, and the response of the loop takes some 10 ms.
        assert_all(&error, &effect_run.steady(mm_s), 0.0, ROUNDING_N + 0.3, "force");
    }
}

/// Friction rises by amplitude·sin(2π·x/period + phase): its sign in the force is that of the velocity.
pub fn friction_ripple() {
    let (amplitude_n, period_mm, phase_rad, mm_s) = (50.0_f64, 4.0, 0.3, 2.0);
    let motion = lines(&[(10.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect = format!(
        "name = \"friction_ripple\"\namplitude_n = {amplitude_n}\nperiod_mm = {period_mm}\nphase_rad = {phase_rad}"
    );
    let effect_run = run(&with(&effect), &motion);
    let table_mm = effect_run.channel("x", Channel::Table);
    for mm_s in [mm_s, -mm_s] {
        let steady = effect_run.steady(mm_s);
        let angle = |&i: &usize| TAU * table_mm[i] / period_mm + phase_rad;
        let sines: Vec<f64> = steady.iter().map(|i| angle(i).sin()).collect();
        let cosines: Vec<f64> = steady.iter().map(|i| angle(i).cos()).collect();
        let force = fit([&sines, &cosines], &at(&effect_run.change(Channel::Force, &plain), &steady));
        // The loop at half a period a second, and the dependence of friction on velocity: 2 %.
        assert_near(force[0], amplitude_n.copysign(mm_s), 0.02 * amplitude_n, "force in phase");
        assert_near(force[1], 0.0, 0.02 * amplitude_n, "force in quadrature");
        assert_near(force[2], 0.0, ROUNDING_N, "mean force");
    }
}
