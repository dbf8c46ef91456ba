//! Friction that is given as a curve, in the force that the drive gives.

use files::log::Channel;

use crate::bench::{PLAIN, ROUNDING_N, Seen, assert_all, changed, declared, lines, run};

/// The motion: each of two speeds both ways.
const SPEEDS_MM_S: [f64; 4] = [10.0, 60.0, -60.0, -10.0];

/// The machine whose guideway of x has a curve instead of its Coulomb friction.
fn machine(curve: &str) -> String {
    changed(PLAIN, "coulomb_n = 250.0 ", &format!("friction_curve = {{ {curve} }} "))
}

fn seen(machine: &str) -> Seen {
    run(machine, &lines(&[(8.0, 10.0), (68.0, 60.0), (8.0, 60.0), (0.0, 10.0)]))
}

/// At a steady speed the force is the curve's, with viscous friction and that of the motor, ±40 N·tanh(v/0.2 mm/s).
fn assert_force(machine: &str, curve_n: impl Fn(f64) -> f64) {
    let seen = seen(machine);
    let plain = self::seen(PLAIN);
    let axis = declared();
    for mm_s in SPEEDS_MM_S {
        let rest_n = 1e-3 * mm_s * axis.mechanics.viscous_n_s_per_m.unwrap()
            + axis.mechanics.motor_coulomb_n.unwrap().copysign(mm_s);
        let steady = seen.steady(mm_s);
        assert_all(seen.force_n(), &steady, curve_n(mm_s) + rest_n, ROUNDING_N, "force");
        // The same with Coulomb friction: the equation is not the curve's alone.
        let coulomb_n = axis.mechanics.coulomb_n.unwrap().copysign(mm_s);
        assert_all(plain.force_n(), &steady, coulomb_n + rest_n, ROUNDING_N, "force without");
    }
    let y = |seen: &Seen| seen.channel("y", Channel::Force).to_vec();
    assert_eq!(y(&seen), y(&plain), "the other axis has its own friction");
}

/// Straight lines between the points, of each direction its own; beyond the last one the last line goes on.
#[test]
fn piecewise() {
    let curve = "piecewise = { \
         forward = [{ speed_mm_s = 0.0, force_n = 300.0 }, { speed_mm_s = 20.0, force_n = 180.0 }, \
         { speed_mm_s = 100.0, force_n = 240.0 }], \
         backward = [{ speed_mm_s = 5.0, force_n = 150.0 }, { speed_mm_s = 50.0, force_n = 250.0 }] }";
    assert_force(&machine(curve), |mm_s| {
        if mm_s > 20.0 {
            180.0 + (mm_s - 20.0) / 80.0 * 60.0
        } else if mm_s > 0.0 {
            300.0 - mm_s / 20.0 * 120.0
        } else {
            -(150.0 + (-mm_s - 5.0) / 45.0 * 100.0)
        }
    });
}

/// Load · [μ2·v² + (μ1·γ − μ2)·sech βv]·tanh αv, v in m/s.
#[test]
fn falling_rising() {
    let (mu1, mu2, alpha, beta, gamma, load_n) = (0.16, 0.06, 2000.0, 40.0, 1.1, 2000.0);
    let curve = format!(
        "falling_rising = {{ mu1 = {mu1}, mu2 = {mu2}, alpha = {alpha}, beta = {beta}, gamma = {gamma}, \
         load_n = {load_n} }}"
    );
    // A curve that leads through zero has no bristles under it.
    let machine = changed(&machine(&curve), "presliding_stiffness_n_per_um = 40.0 ", "# ");
    let machine = changed(&machine, "presliding_damping_n_s_per_m = 2000.0 ", "# ");
    assert_force(&machine, |mm_s| {
        let v: f64 = 1e-3 * mm_s;
        let sech = 2.0 / ((beta * v).exp() + (-beta * v).exp());
        load_n * (mu2 * v * v + (mu1 * gamma - mu2) * sech) * (alpha * v).tanh()
    });
}
