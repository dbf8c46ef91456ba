//! Errors of the linear scale: of its reading alone, and in a loop that it closes, of the motion.

use std::f64::consts::TAU;

use files::log::Channel;

use plant::instruments::Instruments;

use crate::effects::runs::{PLAIN, RunLog, assert_near, changed, circle, run, run_with, with};

/// The controller reads a position in steps of 2⁻²⁰ nm, and its log has seventeen digits.
const EXACT_UM: f64 = 1e-8;

/// Asserts reading − tool (µm) as a function of the position of the table (mm). The tool of this machine is its table. In a loop closed
/// by the motor, nothing else changes; in one closed by the scale, the table moves by the error.
fn assert_error(effect: &str, expected_um: impl Fn(f64) -> f64) {
    let motion = circle(50.0, 100.0, 1.0);
    let error_um = |run: &RunLog| run.difference_um(Channel::Table, Channel::Tool);
    let assert_reading = |run: &RunLog| {
        for (error_um, x_mm) in error_um(run).iter().zip(run.channel("x", Channel::Tool)) {
            assert_near(*error_um, expected_um(*x_mm), EXACT_UM, "reading − table");
        }
    };
    let (plain, effect_run) = (run(PLAIN, &motion), run(&with(effect), &motion));
    effect_run.assert_same(&plain, &[Channel::Table]);
    assert_reading(&effect_run);

    let closed = changed(PLAIN, "feedback = \"motor\"", "feedback = \"table\"");
    let in_loop = run(&format!("{closed}\n[[axis.x.effect]]\n{effect}\n"), &motion);
    assert_reading(&in_loop);
    let moved_um = in_loop.change(Channel::Tool, &run(&closed, &motion));
    let largest_um = moved_um.iter().fold(0.0f64, |largest, um| largest.max(um.abs()));
    assert!(largest_um > 1.0, "the table moved by {largest_um} µm");
}

/// Reading = (1 + gain)·table.
pub fn scale_gain() {
    assert_error("name = \"scale_gain\"\num_per_m = 60.0", |x_mm| 60.0 * 1e-3 * x_mm);
}

/// Reading = table + A·sin(2π·table/period + phase).
pub fn scale_cyclic() {
    let effect = "name = \"scale_cyclic\"\namplitude_um = 3.0\nperiod_mm = 37.0\nphase_rad = 0.4";
    assert_error(effect, |x_mm| 3.0 * (TAU * x_mm / 37.0 + 0.4).sin());
}

/// A scale that grows by 80·(1 − exp(−t/τ)) µm/m reads less by that; a screw that does so moves table and tool.
pub fn thermal_growth() {
    let (um_per_m, tau_s, start_s) = (80.0, 5.0, 3.0);
    let motion = circle(50.0, 100.0, 1.0);
    let of = |machine: &str| run_with(machine, &motion, start_s, |_| Instruments::default());
    let part = |part: &str| {
        let size = format!("um_per_m = {um_per_m:?}\ntime_constant_s = {tau_s:?}");
        of(&with(&format!("name = \"thermal_growth\"\npart = \"{part}\"\n{size}")))
    };
    let (plain, scale, screw) = (of(PLAIN), part("scale"), part("screw"));
    scale.assert_same(&plain, &[Channel::Table]);
    screw.assert_same(&plain, &[Channel::Table, Channel::Tool]);
    let [read_um, moved_um] = [&scale, &screw].map(|run| run.change(Channel::Table, &plain));
    let tool_um = screw.change(Channel::Tool, &plain);
    for (i, x_mm) in plain.channel("x", Channel::Tool).iter().enumerate() {
        let time_s = start_s + i as f64 * plain.log.sample_time_s;
        let grown_um = um_per_m * (1.0 - (-time_s / tau_s).exp()) * 1e-3 * x_mm;
        assert_near(read_um[i], -grown_um, EXACT_UM, "reading");
        assert_near(moved_um[i], grown_um, EXACT_UM, "table");
        assert_near(tool_um[i], grown_um, EXACT_UM, "tool");
    }
}
