//! Effects between table and tool, and latencies of the log: the loop does not depend on them.

use std::f64::consts::TAU;

use files::log::Channel;
use plant::instruments::Instruments;

use crate::effects::runs::{PLAIN, RunLog, assert_near, changed, circle, declared, fit, run, run_with, with};

/// Rounding of a position in the tool channel, µm: 2⁻²¹ nm and the seventeenth digit of 100 mm.
const EXACT_UM: f64 = 1e-9;

/// Tool − table of x, µm.
fn offset_um(effect_run: &RunLog) -> Vec<f64> {
    effect_run.difference_um(Channel::Tool, Channel::Table)
}

/// A circle with accelerations of up to 2 m/s² on each axis.
fn accelerating_circle() -> String {
    circle(20.0, 200.0, 3.0)
}

/// Acceleration of a table, m/s², by second differences; without the first and the last sample.
fn acceleration(effect_run: &RunLog, axis: &str) -> Vec<f64> {
    let per_square = 1e-3 / effect_run.log.sample_time_s.powi(2);
    let table = effect_run.channel(axis, Channel::Table);
    table.windows(3).map(|t| per_square * (t[0] - 2.0 * t[1] + t[2])).collect()
}

/// Asserts tool − table per acceleration of the axis itself and of the other axis, µm per m/s².
///
/// The second difference is a mean over 2 ms, the effect depends on the instantaneous acceleration: they differ at
/// reversals, where friction jumps, by 1 % of the slope.
fn assert_acceleration_offset(effect: &str, own: f64, other: f64) {
    let motion = accelerating_circle();
    let plain = run(PLAIN, &motion);
    let effect_run = run(&with(effect), &motion);
    effect_run.assert_same(&plain, &[Channel::Tool]);
    let offset_um = offset_um(&effect_run);
    let (x, y) = (acceleration(&effect_run, "x"), acceleration(&effect_run, "y"));
    let found = fit([&x, &y], &offset_um[1..offset_um.len() - 1]);
    let bound = 0.01 * own.abs().max(other.abs());
    assert_near(found[0], own, bound, "per own acceleration");
    assert_near(found[1], other, bound, "per acceleration of the other axis");
    assert_near(found[2], 0.0, bound, "without acceleration");
}

/// Tool − table = coefficient · own acceleration.
pub fn intalk() {
    assert_acceleration_offset("name = \"intalk\"\num_s2_per_m = 2.0", 2.0, 0.0);
}

/// Tool − table = coefficient · acceleration of the source.
pub fn crosstalk() {
    assert_acceleration_offset("name = \"crosstalk\"\num_s2_per_m = -1.5\nsource = \"y\"", 0.0, -1.5);
}

/// Asserts that tool x − table x (µm) is a function of table y (mm).
fn assert_position_offset(effect: &str, expected_um: impl Fn(f64) -> f64) {
    let motion = circle(50.0, 100.0, 1.0);
    let plain = run(PLAIN, &motion);
    let effect_run = run(&with(effect), &motion);
    effect_run.assert_same(&plain, &[Channel::Tool]);
    let y_mm = effect_run.channel("y", Channel::Table);
    for (offset_um, &y_mm) in offset_um(&effect_run).iter().zip(y_mm) {
        assert_near(*offset_um, expected_um(y_mm), EXACT_UM, "tool − table");
    }
    assert!(y_mm.iter().copied().fold(0.0, f64::max) > 49.0, "y was not moved");
}

/// Tool x − table x = coefficient · y.
pub fn squareness() {
    assert_position_offset("name = \"squareness\"\num_per_m = 30.0", |y_mm| 30.0 * 1e-3 * y_mm);
}

/// Tool x − table x = coefficient · y².
pub fn straightness() {
    let effect = "name = \"straightness\"\num_per_m2 = 800.0\nsource = \"y\"";
    assert_position_offset(effect, |y_mm| 800.0 * (1e-3 * y_mm).powi(2));
}

/// Tool x − table x = the natural spline through 0, 6 and 0 µm at −50, 0 and 50 mm of y: with u = |y|/50 mm, its second derivative is −18 µm at
/// u = 0 and falls linearly to zero at u = 1, so that it is 6·(1 − 3/2·u² + 1/2·u³); beyond the knots it is constant.
pub fn straightness_map() {
    let knots = "positions_mm = [-50.0, 0.0, 50.0]\nerror_um = [0.0, 6.0, 0.0]";
    let effect = format!("name = \"straightness_map\"\nsource = \"y\"\n{knots}");
    assert_position_offset(&effect, |y_mm| {
        let u = (y_mm.abs() / 50.0).min(1.0);
        6.0 * (1.0 - 1.5 * u * u + 0.5 * u.powi(3))
    });
}

/// Tool x − table x = coefficient · x · y.
pub fn yaw() {
    let motion = circle(50.0, 100.0, 1.0);
    let plain = run(PLAIN, &motion);
    let effect_run = run(&with("name = \"yaw\"\nsource = \"y\"\num_per_m2 = 1200.0"), &motion);
    effect_run.assert_same(&plain, &[Channel::Tool]);
    let [x_mm, y_mm] = ["x", "y"].map(|axis| effect_run.channel(axis, Channel::Table));
    let mut largest_um = 0.0f64;
    for (i, offset_um) in offset_um(&effect_run).iter().enumerate() {
        let expected_um = 1200.0 * 1e-6 * x_mm[i] * y_mm[i];
        largest_um = largest_um.max(expected_um.abs());
        assert_near(*offset_um, expected_um, EXACT_UM, "tool − table");
    }
    // At 45°, 50²/2 mm².
    assert!((largest_um / 1.5 - 1.0).abs() < 0.01, "{largest_um}");
}

/// Reading of x = tool + angle·y.
pub fn probe_rotation() {
    assert_position_offset("name = \"probe_rotation\"\num_per_m = 170.0", |y_mm| 170.0 * 1e-3 * y_mm);
}

/// Reading = tool + gain·x.
pub fn probe_gain() {
    let motion = circle(50.0, 100.0, 1.0);
    let (plain, effect_run) =
        (run(PLAIN, &motion), run(&with("name = \"probe_gain\"\num_per_m = -400.0"), &motion));
    effect_run.assert_same(&plain, &[Channel::Tool]);
    let x_mm = plain.channel("x", Channel::Tool);
    for (change_um, x_mm) in effect_run.change(Channel::Tool, &plain).iter().zip(x_mm) {
        assert_near(*change_um, -400.0 * 1e-3 * x_mm, EXACT_UM, "reading − tool");
    }
}

/// Tool − table = rate·t, with the time t of the session, which begins before the run.
pub fn thermal_rate() {
    let (um_per_min, start_s) = (30.0, 40.0);
    let effect = format!("name = \"thermal_rate\"\num_per_min = {um_per_min:?}");
    let run = |machine: &str| run_with(machine, &accelerating_circle(), start_s, |_| Instruments::default());
    let (plain, effect_run) = (run(PLAIN), run(&with(&effect)));
    effect_run.assert_same(&plain, &[Channel::Tool]);
    for (i, offset_um) in offset_um(&effect_run).iter().enumerate() {
        let expected_um = um_per_min / 60.0 * (start_s + 1e-3 * i as f64);
        assert_near(*offset_um, expected_um, EXACT_UM, "tool − table");
    }
}

/// Tool − table = A·(1 − exp(−t/τ)), with the time t of the session, which begins before the run.
pub fn thermal_drift() {
    let (amplitude_um, tau_s, start_s) = (8.0, 2.0, 1.5);
    let effect =
        format!("name = \"thermal_drift\"\namplitude_um = {amplitude_um}\ntime_constant_s = {tau_s}");
    let run = |machine: &str| run_with(machine, &accelerating_circle(), start_s, |_| Instruments::default());
    let (plain, effect_run) = (run(PLAIN), run(&with(&effect)));
    effect_run.assert_same(&plain, &[Channel::Tool]);
    for (i, offset_um) in offset_um(&effect_run).iter().enumerate() {
        let time_s = start_s + 1e-3 * i as f64;
        let expected_um = amplitude_um * (1.0 - (-time_s / tau_s).exp());
        assert_near(*offset_um, expected_um, EXACT_UM, "tool − table");
    }
}

/// The channel is that of the run without the effect, delayed by `ms`, and the loop does not change, even when it is
/// closed over the scale.
///
/// A position is interpolated within jerk·τ³/6, 3e-5 µm with the 20 m/s³ of this circle; where friction jumps within τ,
/// by at most 2·250 N on 250 kg, within 2 m/s²·τ²/2 = 4 µm.
pub fn latency() {
    let late_samples = 2;
    // The delay is at most v·τ, with 200 mm/s times the gain of the position loop at ω: |Kp + iKfω|/|Kp + iω|.
    let axis = declared();
    let (kp, kf) =
        (axis.controller.position_gain_per_s.unwrap(), 0.01 * axis.controller.feedforward_percent.unwrap());
    let omega: f64 = 200.0 / 20.0;
    let expected_um = 200.0 * late_samples as f64 * kp.hypot(kf * omega) / kp.hypot(omega);
    let loops = [PLAIN.to_owned(), changed(PLAIN, "feedback = \"motor\"", "feedback = \"table\"")];
    for machine in loops {
        let plain = run(&machine, &accelerating_circle());
        for (word, channel) in [("table", Channel::Table), ("tool", Channel::Tool)] {
            let effect = format!(
                "\n[[axis.x.effect]]\nname = \"latency\"\nchannel = \"{word}\"\nms = {late_samples}.0\n"
            );
            let effect_run = run(&(machine.clone() + &effect), &accelerating_circle());
            effect_run.assert_same(&plain, &[channel]);
            let (delayed, original) = (effect_run.channel("x", channel), plain.channel("x", channel));
            let mut error_um: Vec<f64> = delayed[late_samples..]
                .iter()
                .zip(original)
                .map(|(delayed, original)| 1e3 * (delayed - original).abs())
                .collect();
            error_um.sort_by(f64::total_cmp);
            let (usual, max) = (error_um[error_um.len() * 9 / 10], error_um[error_um.len() - 1]);
            assert!(usual < 0.05 && max < 4.0, "{word}: {usual} µm usually, {max} µm at most");
            let lag_um = delayed
                .iter()
                .zip(original)
                .map(|(delayed, original)| 1e3 * (original - delayed))
                .fold(0.0, f64::max);
            assert_near(lag_um, expected_um, 0.02 * expected_um, "v·τ");
        }
    }
    // A delay by whole samples shifts the force exactly.
    let plain = run(PLAIN, &accelerating_circle());
    let effect = format!("name = \"latency\"\nchannel = \"force\"\nms = {late_samples}.0");
    let effect_run = run(&with(&effect), &accelerating_circle());
    effect_run.assert_same(&plain, &[Channel::Force]);
    assert_eq!(effect_run.force_n()[late_samples..], plain.force_n()[..plain.force_n().len() - late_samples]);
}

/// Tool/table = ω²/(ω² − Ω² + 2iζωΩ) on a circle with the angular frequency Ω, after the transient e^(−ζωt). With the damper at the
/// table, the term 2iζωΩ is in the numerator as well.
pub fn resonance() {
    response("", 0.0);
    response("\ndamped_against = \"table\"", 1.0);
}

/// The response of a mode with a damper that is declared by a key, and the part of the table's speed that the other end of the damper has.
fn response(damper: &str, share: f64) {
    let (frequency_hz, zeta) = (25.0, 0.08);
    let (radius_mm, mm_s) = (2.0, 100.0);
    let motion = circle(radius_mm, mm_s, 20.0);
    let plain = run(PLAIN, &motion);
    let effect = format!(
        "name = \"resonance\"\nchannel = \"tool\"\nfrequency_hz = {frequency_hz:?}\ndamping_ratio = {zeta}{damper}"
    );
    let effect_run = run(&with(&effect), &motion);
    effect_run.assert_same(&plain, &[Channel::Tool]);
    let (own, forced) = (TAU * frequency_hz, mm_s / radius_mm);
    // The transient has decayed to e^(−0.08·157·1.2) = 3e-7; the last turn, with the stop, is left out.
    let samples = 1200..2400;
    let wave = |wave: fn(f64) -> f64| -> Vec<f64> {
        samples.clone().map(|i| wave(forced * 1e-3 * i as f64)).collect()
    };
    let (cosines, sines) = (wave(f64::cos), wave(f64::sin));
    let parts = |channel| fit([&cosines, &sines], &effect_run.channel("x", channel)[samples.clone()]);
    let (table, tool) = (parts(Channel::Table), parts(Channel::Tool));
    // c·cos + s·sin is the real part of (c − i·s)·e^(iΩt).
    let [table, tool] = [(table[0], -table[1]), (tool[0], -tool[1])];
    let gain = tool.0.hypot(tool.1) / table.0.hypot(table.1);
    let phase = tool.1.atan2(tool.0) - table.1.atan2(table.0);
    let phase = (phase + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
    let (real, imaginary) = (own * own - forced * forced, 2.0 * zeta * own * forced);
    let ahead = share * imaginary;
    let expected = ahead.hypot(own * own) / real.hypot(imaginary);
    assert!(expected > 1.1);
    // A first-order error of a step h of 0.1 ms: Ω·h = 0.4 % of the gain and of a radian at most.
    assert_near(gain, expected, 0.004 * expected, "gain");
    assert_near(phase, ahead.atan2(own * own) - imaginary.atan2(real), 0.004, "phase");
}
