//! Friction curves, in the force of the drive.

use files::log::Channel;

use crate::effects::runs::{PLAIN, ROUNDING_N, RunLog, assert_all, changed, declared, lines, run};

/// The velocities of the motion: two speeds in both directions.
const SPEEDS_MM_S: [f64; 4] = [10.0, 60.0, -60.0, -10.0];

/// The machine with a friction curve of x in the place of its Coulomb friction.
fn machine(curve: &str) -> String {
    changed(PLAIN, "coulomb_n = 250.0 ", &format!("friction_curve = {{ {curve} }} "))
}

fn run_curve(machine: &str) -> RunLog {
    run(machine, &lines(&[(8.0, 10.0), (68.0, 60.0), (8.0, 60.0), (0.0, 10.0)]))
}

/// At a constant velocity the force is the sum of the curve, viscous friction and motor friction, ±40 N·tanh(v/0.2
/// mm/s).
fn assert_force(machine: &str, curve_n: impl Fn(f64) -> f64) {
    let effect_run = run_curve(machine);
    let plain = run_curve(PLAIN);
    let axis = declared();
    for mm_s in SPEEDS_MM_S {
        let other_n = 1e-3 * mm_s * axis.mechanics.viscous_n_s_per_m.unwrap()
            + axis.mechanics.motor_coulomb_n.unwrap().copysign(mm_s);
        let steady = effect_run.steady(mm_s);
        assert_all(effect_run.force_n(), &steady, curve_n(mm_s) + other_n, ROUNDING_N, "force");
        // The same equation with Coulomb friction holds for the machine without the curve.
        let coulomb_n = axis.mechanics.coulomb_n.unwrap().copysign(mm_s);
        assert_all(plain.force_n(), &steady, coulomb_n + other_n, ROUNDING_N, "force without");
    }
    let y = |effect_run: &RunLog| effect_run.channel("y", Channel::Force).to_vec();
    assert_eq!(y(&effect_run), y(&plain), "the friction of the other axis does not change");
}

/// Straight lines between the points of each direction; the last line continues beyond the last point.
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
    // A curve that is continuous through zero is used without bristles.
    let machine = changed(&machine(&curve), "presliding_stiffness_n_per_um = 40.0 ", "# ");
    let machine = changed(&machine, "presliding_damping_n_s_per_m = 2000.0 ", "# ");
    assert_force(&machine, |mm_s| {
        let v: f64 = 1e-3 * mm_s;
        let sech = 2.0 / ((beta * v).exp() + (-beta * v).exp());
        load_n * (mu2 * v * v + (mu1 * gamma - mu2) * sech) * (alpha * v).tanh()
    });
}
