//! Effects between motor and table, and of the motor reading.

use std::f64::consts::TAU;

use files::log::Channel;

use crate::effects::runs::{
    PLAIN, ROUNDING_N, ROUNDING_UM, RunLog, assert_all, assert_near, changed, declared, lines, mean, run,
    with,
};

/// The screw pushes at one edge of the gap, and after a reversal at the other: table − motor changes by ∓width/2.
///
/// Stretch and friction depend on the velocity alone and cancel in the difference of the runs.
pub fn backlash() {
    let width_um: f64 = 12.0;
    let motion = lines(&[(60.0, 50.0), (0.0, 50.0)]);
    let plain = run(PLAIN, &motion);
    let effect_run = run(&with(&format!("name = \"backlash\"\nwidth_um = {width_um}")), &motion);
    let change_um = effect_run.drive_train_change_um(&plain);
    for mm_s in [50.0_f64, -50.0] {
        let steady = effect_run.steady(mm_s);
        let expected_um = -(0.5 * width_um).copysign(mm_s);
        assert_all(&change_um, &steady, expected_um, ROUNDING_UM, "table − motor");
        // The motor is fed back: it and its force do not change.
        assert_all(&effect_run.change(Channel::Motor, &plain), &steady, 0.0, ROUNDING_UM, "motor");
        assert_all(&effect_run.change(Channel::Force, &plain), &steady, 0.0, ROUNDING_N, "force");
    }
}

/// Travel of table and motor (µm) since the reversal, when the motor has travelled by `travel_um`.
fn since_reversal_um(effect_run: &RunLog, travel_um: f64) -> [f64; 2] {
    let [motor, table] = [Channel::Motor, Channel::Table].map(|channel| effect_run.channel("x", channel));
    let turn = (0..motor.len()).max_by(|&a, &b| motor[a].total_cmp(&motor[b])).unwrap();
    let then = (turn..motor.len()).find(|&i| 1e3 * (motor[turn] - motor[i]) > travel_um).unwrap();
    [table, motor].map(|position_mm| 1e3 * (position_mm[turn] - position_mm[then]))
}

/// While the motor crosses the gap the table does not move, on a guideway without bristles; after it the table lags by
/// the gap.
#[test]
fn the_table_is_at_standstill_while_the_motor_crosses_the_gap() {
    let width_um = 12.0;
    let stiff = "presliding_stiffness_n_per_um = 40.0 ";
    let damping = "presliding_damping_n_s_per_m = 2000.0 ";
    let without = |machine: &str| changed(&changed(machine, stiff, "# "), damping, "# ");
    let motion = lines(&[(10.0, 50.0), (0.0, 50.0)]);
    let effect_run = |machine: &str| run(&without(machine), &motion);
    let (plain, gap) =
        (effect_run(PLAIN), effect_run(&with(&format!("name = \"backlash\"\nwidth_um = {width_um:?}"))));
    // The table reverses when the screw no longer pushes it, some 10 nm after the motor.
    assert_near(since_reversal_um(&gap, width_um)[0], 0.0, 0.03, "table in the gap");
    let lost_um = |effect_run: &RunLog| {
        let [table_um, motor_um] = since_reversal_um(effect_run, 40.0);
        motor_um - table_um
    };
    // Without a gap the stretch of the screw changes by twice the friction; the inertia, 250 kg · 0.5 m/s², is 125 N.
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
    let effect_run = run(&with(&effect), &motion);
    let change_um = effect_run.drive_train_change_um(&plain);
    let motor_mm = effect_run.channel("x", Channel::Motor);
    for (&change_um, &motor_mm) in change_um.iter().zip(motor_mm) {
        // The tolerance covers the change of forces by 40 µm/m more speed: some mN over 200 N/µm.
        assert_near(change_um, 1e-3 * slope_um_per_m * motor_mm, ROUNDING_UM, "table − motor");
    }
    let max_mm = motor_mm.iter().copied().fold(0.0, f64::max);
    assert_near(max_mm, 100.0, 0.5, "end of the travel");
}

/// Table = motor + A·sin(2π·motor/period + phase).
///
/// The force that moves the table along the wave, m·A·ω² and (c + b)·A·ω with ω = 2π·v/period, stretches the screw by
/// that over k.
pub fn pitch_cyclic() {
    let (amplitude_um, period_mm, phase_rad, mm_s) = (2.0, 16.0, 0.7, 50.0);
    let motion = lines(&[(100.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect = format!(
        "name = \"pitch_cyclic\"\namplitude_um = {amplitude_um}\nperiod_mm = {period_mm}\nphase_rad = {phase_rad}"
    );
    let effect_run = run(&with(&effect), &motion);
    let axis = declared();
    let omega = TAU * mm_s / period_mm;
    let damping = axis.mechanics.damping_n_s_per_m.unwrap() + axis.mechanics.viscous_n_s_per_m.unwrap();
    let push_n_per_um = 1e-6 * (axis.mechanics.table_mass_kg.unwrap() * omega * omega + damping * omega);
    let bound_um = ROUNDING_UM + amplitude_um * push_n_per_um / axis.mechanics.stiffness_n_per_um.unwrap();
    assert!(bound_um < 0.01 * amplitude_um, "{bound_um}");
    let change_um = effect_run.drive_train_change_um(&plain);
    let motor_mm = effect_run.channel("x", Channel::Motor);
    for i in [effect_run.steady(mm_s), effect_run.steady(-mm_s)].concat() {
        let expected_um = amplitude_um * (TAU * motor_mm[i] / period_mm + phase_rad).sin();
        assert_near(change_um[i], expected_um, bound_um, "table − motor");
    }
}

/// Table = motor + error, a natural cubic spline through the knots: with three knots at a distance h it is, in the
/// coordinate u = (x − x₁)/h from the middle one, y₁ + (y₂ − y₀)/2·u + B·(3u²/4 − |u|³/4) with B = y₀ − 2y₁ + y₂. It is
/// constant beyond the ends.
fn spline_um(mm: f64, positions_mm: [f64; 3], values_um: [f64; 3]) -> f64 {
    let [y0, y1, y2] = values_um;
    let u = ((mm - positions_mm[1]) / (positions_mm[2] - positions_mm[1])).clamp(-1.0, 1.0);
    y1 + 0.5 * (y2 - y0) * u + (y0 - 2.0 * y1 + y2) * (0.75 * u * u - 0.25 * u.abs().powi(3))
}

/// The error is that of its direction where both are given: table − motor changes by it, and the motor is fed back.
pub fn pitch_map() {
    let positions = [10.0, 50.0, 90.0];
    let (error_um, negative_um) = ([1.0, -4.0, 2.0], [7.0, 5.0, 3.0]);
    let motion = lines(&[(100.0, 50.0), (0.0, 50.0)]);
    let plain = run(PLAIN, &motion);
    let both = format!("name = \"pitch_map\"\npositions_mm = {positions:?}\nerror_um = {error_um:?}\n");
    let each_way = format!("{both}error_negative_um = {negative_um:?}\n");
    for (effect, backwards_um) in [(both, error_um), (each_way, negative_um)] {
        let effect_run = run(&with(&effect), &motion);
        let change_um = effect_run.drive_train_change_um(&plain);
        let motor_mm = effect_run.channel("x", Channel::Motor);
        for (mm_s, values_um) in [(50.0, error_um), (-50.0, backwards_um)] {
            for i in effect_run.steady(mm_s) {
                let expected_um = spline_um(motor_mm[i], positions, values_um);
                // At the ends the slope of the error, 0.3 µm/mm, changes the velocity of the table by 15 µm/s, after which
                // 250 kg on 200 N/µm oscillate at 894 rad/s with an amplitude of 17 nm.
                assert_near(change_um[i], expected_um, ROUNDING_UM + 0.017, "table − motor");
            }
            // There the table passes a momentum of 250 kg · 15 µm/s to a velocity loop of 1e5 N·s/m: 0.0375 µm.
            let change_um = effect_run.change(Channel::Motor, &plain);
            assert_all(&change_um, &effect_run.steady(mm_s), 0.0, ROUNDING_UM + 0.0375, "motor");
        }
    }
}

/// After a reversal the motor crosses the gap of the place, negative less positive error, before the table follows.
#[test]
fn the_gap_of_a_pitch_map_varies_with_the_position() {
    let stiff = "presliding_stiffness_n_per_um = 40.0 ";
    let damping = "presliding_damping_n_s_per_m = 2000.0 ";
    let without = |machine: &str| changed(&changed(machine, stiff, "# "), damping, "# ");
    // The width is 4 µm at 0 and 16 µm at 40 mm, on a straight line.
    let map = "name = \"pitch_map\"\npositions_mm = [0.0, 40.0]\nerror_um = [-2.0, -8.0]\n\
               error_negative_um = [2.0, 8.0]\n";
    for (end_mm, width_um) in [(10.0, 7.0), (30.0, 13.0)] {
        let motion = lines(&[(end_mm, 50.0), (0.0, 50.0)]);
        let [plain, gap] = [PLAIN.to_owned(), with(map)].map(|machine| run(&without(&machine), &motion));
        assert_near(since_reversal_um(&gap, width_um)[0], 0.0, 0.03, "table in the gap");
        let lost_um = |run: &RunLog| {
            let [table_um, motor_um] = since_reversal_um(run, 40.0);
            motor_um - table_um
        };
        let axis = declared();
        let inertia_n = 0.5 * axis.mechanics.table_mass_kg.unwrap();
        let bound_um = 2.0 * inertia_n / axis.mechanics.stiffness_n_per_um.unwrap();
        assert_near(lost_um(&gap) - lost_um(&plain), width_um, bound_um, "lost in the gap");
    }
}

/// Once a pole pair.
pub fn resolver_dividing() {
    assert_reading_error("resolver_dividing", 3.2);
}

/// Twice a turn of the screw.
pub fn encoder_ellipticity() {
    assert_reading_error("encoder_ellipticity", 8.0);
}

/// Reading = motor + A·sin(2π·motor/period + phase). The reading is fed back, so that motor and table have the error,
/// with the opposite sign.
///
/// The loops leave |s²(m·s + b)/(m·s³ + b·s² + Kv(s + Kp)(s + 1/Ti))| ≤ 2e-4 of it in the reading at ω = 2π·v/period.
fn assert_reading_error(name: &str, period_mm: f64) {
    let (amplitude_um, phase_rad, mm_s) = (1.0, 0.4, 2.0);
    let motion = lines(&[(6.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect = format!(
        "name = \"{name}\"\namplitude_um = {amplitude_um}\nperiod_mm = {period_mm}\n\
         phase_rad = {phase_rad}"
    );
    let effect_run = run(&with(&effect), &motion);
    let [change_um, table_um, reading_um] = [
        effect_run.drive_train_change_um(&plain),
        effect_run.change(Channel::Table, &plain),
        effect_run.change(Channel::Motor, &plain),
    ];
    let reading_mm = effect_run.channel("x", Channel::Motor);
    for i in [effect_run.steady(mm_s), effect_run.steady(-mm_s)].concat() {
        let wave = |motor_mm: f64| amplitude_um * (TAU * motor_mm / period_mm + phase_rad).sin();
        let true_mm = reading_mm[i] - 1e-3 * wave(reading_mm[i]);
        // One fixed-point iteration for the true position leaves (2π·A/period)² of the error: 4e-6.
        assert_near(change_um[i], -wave(true_mm), ROUNDING_UM, "table − motor");
        assert_near(table_um[i], -wave(true_mm), 2.0 * ROUNDING_UM, "table");
        assert_near(reading_um[i], 0.0, ROUNDING_UM, "motor");
    }
}

/// The screw is stretched by F/k under the force F of the guideway: table − motor changes by −F·(1/k′ − 1/k).
pub fn windup() {
    let softer_n_per_um = 120.0;
    let mm_s = 200.0;
    let motion = lines(&[(250.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect_run =
        run(&with(&format!("name = \"windup\"\nstiffness_n_per_um = {softer_n_per_um}")), &motion);
    let axis = declared();
    let more_um_per_n = 1.0 / softer_n_per_um - 1.0 / axis.mechanics.stiffness_n_per_um.unwrap();
    let change_um = effect_run.drive_train_change_um(&plain);
    let friction_n = |mm_s: f64| {
        axis.mechanics.coulomb_n.unwrap().copysign(mm_s)
            + 1e-3 * mm_s * axis.mechanics.viscous_n_s_per_m.unwrap()
    };
    for mm_s in [mm_s, -mm_s] {
        let steady = effect_run.steady(mm_s);
        let expected_um = -friction_n(mm_s) * more_um_per_n;
        assert_all(&change_um, &steady, expected_um, ROUNDING_UM, "table − motor");
        assert_all(&effect_run.change(Channel::Force, &plain), &steady, 0.0, ROUNDING_N, "force");
        assert_near(mean(&effect_run.change(Channel::Motor, &plain), &steady), 0.0, ROUNDING_UM, "motor");
    }
}

/// Spring and loop together carry what the spring alone does: table − motor changes by L·z/k, with the mean z of eight elements that slip at their own stretches, followed
/// along the logged stretch.
pub fn gear_hysteresis() {
    const SLIPS_AT: [f64; 8] = [0.404, 0.79, 1.132, 1.486, 1.887, 2.381, 3.08, 4.472];
    let (force_n, travel_um, mm_s) = (60.0, 0.5, 200.0);
    let motion = lines(&[(250.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect = format!("name = \"gear_hysteresis\"\nforce_n = {force_n:?}\ntravel_um = {travel_um:?}");
    let effect_run = run(&with(&effect), &motion);
    let [motor_mm, table_mm] =
        [Channel::Motor, Channel::Table].map(|channel| effect_run.channel("x", channel));
    let mut elements = [0.0_f64; 8];
    let mut before_um = 0.0;
    let follow = |(motor_mm, table_mm): (&f64, &f64)| {
        let stretch_um = 1e3 * (motor_mm - table_mm);
        for (element, slips_at) in elements.iter_mut().zip(SLIPS_AT) {
            *element = (*element + (stretch_um - before_um) / (slips_at * travel_um)).clamp(-1.0, 1.0);
        }
        before_um = stretch_um;
        elements.iter().sum::<f64>() / 8.0
    };
    let z: Vec<f64> = motor_mm.iter().zip(table_mm).map(follow).collect();
    let change_um = effect_run.drive_train_change_um(&plain);
    let per_n_um = force_n / declared().mechanics.stiffness_n_per_um.unwrap();
    for mm_s in [mm_s, -mm_s] {
        let steady = effect_run.steady(mm_s);
        assert!(per_n_um * z[steady[0]].abs() > 10.0 * ROUNDING_UM, "{}", z[steady[0]]);
        for &i in &steady {
            // Between the samples, at the end of a transient, the stretch may have turned once more.
            assert_near(change_um[i], per_n_um * z[i], 2.0 * ROUNDING_UM, "table − motor");
        }
        assert_all(&effect_run.change(Channel::Force, &plain), &steady, 0.0, ROUNDING_N, "force");
    }
}

/// Table − motor changes by −F/k·c under the force F of the guideway, with the change c of the compliance on the natural cubic spline through
/// three knots (by hand, as for `friction_map`). The outer ones, at which its slope has a step, are beyond the travel.
pub fn stiffness_map() {
    let (positions_mm, percent, mm_s) = ([-25.0, 125.0, 275.0], [-30.0, 40.0, 20.0], 200.0);
    let motion = lines(&[(250.0, mm_s), (0.0, mm_s)]);
    let plain = run(PLAIN, &motion);
    let effect = format!(
        "name = \"stiffness_map\"\npositions_mm = {positions_mm:?}\ncompliance_percent = {percent:?}"
    );
    let effect_run = run(&with(&effect), &motion);
    let mechanics = declared().mechanics;
    let friction_n = mechanics.coulomb_n.unwrap() + 1e-3 * mm_s * mechanics.viscous_n_s_per_m.unwrap();
    let change = |mm: f64| {
        let [y0, y1, y2] = percent;
        let u = (mm - 125.0) / 150.0;
        0.01 * (y1 + 0.5 * (y2 - y0) * u + (y0 - 2.0 * y1 + y2) * (0.75 * u * u - 0.25 * u.abs().powi(3)))
    };
    let motor_mm = effect_run.channel("x", Channel::Motor);
    let change_um = effect_run.drive_train_change_um(&plain);
    let mut largest_um = 0.0_f64;
    for mm_s in [mm_s, -mm_s] {
        for i in effect_run.steady(mm_s) {
            let stretch_um = friction_n.copysign(mm_s) / mechanics.stiffness_n_per_um.unwrap();
            let expected_um = -stretch_um * change(motor_mm[i]);
            largest_um = largest_um.max(expected_um.abs());
            // The table gains 0.7 µm within 100 mm at 200 mm/s: below 1 mN of inertia. What is left is of rounding.
            assert_near(change_um[i], expected_um, ROUNDING_UM, "table − motor");
        }
        assert_all(
            &effect_run.change(Channel::Force, &plain),
            &effect_run.steady(mm_s),
            0.0,
            ROUNDING_N,
            "force",
        );
    }
    assert!(largest_um > 50.0 * ROUNDING_UM, "{largest_um}");
}
