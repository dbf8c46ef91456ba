//! Between table and tool, and channels that are late: nothing upstream sees any of it.

use std::f64::consts::TAU;

use files::log::Channel;
use plant::instruments::Instruments;

use crate::bench::{PLAIN, Seen, assert_near, changed, circle, declared, fit, run, run_with, with};

/// What roundings of position leave in the tool, µm: a 2⁻²¹ nm and the seventeenth digit of 100 mm.
const EXACT_UM: f64 = 1e-9;

/// Tool − table of x, µm.
fn leaning_um(seen: &Seen) -> Vec<f64> {
    seen.beyond_um(Channel::Tool, Channel::Table)
}

/// The circle on which accelerations are seen: 2 m/s² on each axis.
fn swinging() -> String {
    circle(20.0, 200.0, 3.0)
}

/// Measured acceleration of a table, m/s², by second differences; the first and last sample are left out.
fn acceleration(seen: &Seen, axis: &str) -> Vec<f64> {
    let per_square = 1e-3 / seen.log.sample_time_s.powi(2);
    let table = seen.channel(axis, Channel::Table);
    table.windows(3).map(|t| per_square * (t[0] - 2.0 * t[1] + t[2])).collect()
}

/// Tool − table per own and per the other axis's measured acceleration, µm per m/s².
///
/// The second difference is the mean over 2 ms where the effect goes by the moment: at the reversals, where friction
/// jumps, the two differ, and 1 % of the slope is left to that.
fn assert_leans(effect: &str, own: f64, other: f64) {
    let motion = swinging();
    let plain = run(PLAIN, &motion);
    let seen = run(&with(effect), &motion);
    seen.assert_same(&plain, &[Channel::Tool]);
    let leaning = leaning_um(&seen);
    let (x, y) = (acceleration(&seen, "x"), acceleration(&seen, "y"));
    let found = fit([&x, &y], &leaning[1..leaning.len() - 1]);
    let bound = 0.01 * own.abs().max(other.abs());
    assert_near(found[0], own, bound, "per own acceleration");
    assert_near(found[1], other, bound, "per the other's acceleration");
    assert_near(found[2], 0.0, bound, "at none");
}

/// Tool − table = coefficient · own acceleration.
pub fn intalk() {
    assert_leans("name = \"intalk\"\num_s2_per_m = 2.0", 2.0, 0.0);
}

/// Tool − table = coefficient · acceleration of the source.
pub fn crosstalk() {
    assert_leans("name = \"crosstalk\"\num_s2_per_m = -1.5\nsource = \"y\"", 0.0, -1.5);
}

/// Tool x − table x is, everywhere, a function of table y (mm), in µm.
fn assert_bent(effect: &str, expected_um: impl Fn(f64) -> f64) {
    let motion = circle(50.0, 100.0, 1.0);
    let plain = run(PLAIN, &motion);
    let seen = run(&with(effect), &motion);
    seen.assert_same(&plain, &[Channel::Tool]);
    let y_mm = seen.channel("y", Channel::Table);
    for (leaning_um, &y_mm) in leaning_um(&seen).iter().zip(y_mm) {
        assert_near(*leaning_um, expected_um(y_mm), EXACT_UM, "tool − table");
    }
    assert!(y_mm.iter().copied().fold(0.0, f64::max) > 49.0, "y was not moved");
}

/// Tool x − table x = coefficient · y.
pub fn squareness() {
    assert_bent("name = \"squareness\"\num_per_m = 30.0", |y_mm| 30.0 * 1e-3 * y_mm);
}

/// Tool x − table x = coefficient · y².
pub fn straightness() {
    let effect = "name = \"straightness\"\num_per_m2 = 800.0\nsource = \"y\"";
    assert_bent(effect, |y_mm| 800.0 * (1e-3 * y_mm).powi(2));
}

/// Tool − table = A·(1 − exp(−t/τ)), t on the session's clock, which does not begin with the run.
pub fn thermal_drift() {
    let (amplitude_um, tau_s, start_s) = (8.0, 2.0, 1.5);
    let effect =
        format!("name = \"thermal_drift\"\namplitude_um = {amplitude_um}\ntime_constant_s = {tau_s}");
    let run = |machine: &str| run_with(machine, &swinging(), start_s, |_| Instruments::default());
    let (plain, seen) = (run(PLAIN), run(&with(&effect)));
    seen.assert_same(&plain, &[Channel::Tool]);
    for (i, leaning_um) in leaning_um(&seen).iter().enumerate() {
        let time_s = start_s + 1e-3 * i as f64;
        let expected_um = amplitude_um * (1.0 - (-time_s / tau_s).exp());
        assert_near(*leaning_um, expected_um, EXACT_UM, "tool − table");
    }
}

/// The channel shows what it showed `ms` earlier without, and the loop, even one that is closed over the scale, does
/// not know of it.
///
/// It is taken back by v·τ − a·τ²/2: what is left is jerk·τ³/6, on this circle 20 m/s³ and so 3e-5 µm; where friction
/// jumps within τ, at most by 2·250 N on 250 kg and so by 2 m/s²·τ²/2 = 4 µm, there only.
pub fn latency() {
    let late = 2;
    // In that time it moves by up to v·τ, v being what the position loop makes of the circle's 200 mm/s:
    // |Kp + iKfω|/|Kp + iω|.
    let axis = declared();
    let (kp, kf) =
        (axis.controller.position_gain_per_s.unwrap(), 0.01 * axis.controller.feedforward_percent.unwrap());
    let omega: f64 = 200.0 / 20.0;
    let expected_um = 200.0 * late as f64 * kp.hypot(kf * omega) / kp.hypot(omega);
    let loops = [PLAIN.to_owned(), changed(PLAIN, "feedback = \"motor\"", "feedback = \"table\"")];
    for machine in loops {
        let plain = run(&machine, &swinging());
        for (word, channel) in [("table", Channel::Table), ("tool", Channel::Tool)] {
            let effect =
                format!("\n[[axis.x.effect]]\nname = \"latency\"\nchannel = \"{word}\"\nms = {late}.0\n");
            let seen = run(&(machine.clone() + &effect), &swinging());
            seen.assert_same(&plain, &[channel]);
            let (shown, was) = (seen.channel("x", channel), plain.channel("x", channel));
            let mut off: Vec<f64> =
                shown[late..].iter().zip(was).map(|(shown, was)| 1e3 * (shown - was).abs()).collect();
            off.sort_by(f64::total_cmp);
            let (usual, most) = (off[off.len() * 9 / 10], off[off.len() - 1]);
            assert!(usual < 0.05 && most < 4.0, "{word}: usually {usual} µm off, at most {most} µm");
            let behind = shown.iter().zip(was).map(|(shown, was)| 1e3 * (was - shown)).fold(0.0, f64::max);
            assert_near(behind, expected_um, 0.02 * expected_um, "v·τ");
        }
    }
    // The force of whole samples ago is that which was logged then.
    let plain = run(PLAIN, &swinging());
    let effect = format!("name = \"latency\"\nchannel = \"force\"\nms = {late}.0");
    let seen = run(&with(&effect), &swinging());
    seen.assert_same(&plain, &[Channel::Force]);
    assert_eq!(seen.force_n()[late..], plain.force_n()[..plain.force_n().len() - late]);
}

/// Tool over table = ω²/(ω² − Ω² + 2iζωΩ) on a circle of the angular frequency Ω, when what swings on its own, with
/// e^(−ζωt), has died away.
pub fn resonance() {
    let (frequency_hz, zeta) = (25.0, 0.08);
    let (radius_mm, mm_s) = (2.0, 100.0);
    let motion = circle(radius_mm, mm_s, 20.0);
    let plain = run(PLAIN, &motion);
    let effect = format!(
        "name = \"resonance\"\nchannel = \"tool\"\nfrequency_hz = {frequency_hz:?}\ndamping_ratio = {zeta}"
    );
    let seen = run(&with(&effect), &motion);
    seen.assert_same(&plain, &[Channel::Tool]);
    let (own, forced) = (TAU * frequency_hz, mm_s / radius_mm);
    // e^(−0.08·157·1.2) = 3e-7 is left by then, and the last turn is left out, where it stops.
    let samples = 1200..2400;
    let wave = |wave: fn(f64) -> f64| -> Vec<f64> {
        samples.clone().map(|i| wave(forced * 1e-3 * i as f64)).collect()
    };
    let (cosines, sines) = (wave(f64::cos), wave(f64::sin));
    let parts = |channel| fit([&cosines, &sines], &seen.channel("x", channel)[samples.clone()]);
    let (table, tool) = (parts(Channel::Table), parts(Channel::Tool));
    // c·cos + s·sin is the real part of (c − i·s)·e^(iΩt).
    let [table, tool] = [(table[0], -table[1]), (tool[0], -tool[1])];
    let gain = tool.0.hypot(tool.1) / table.0.hypot(table.1);
    let phase = tool.1.atan2(tool.0) - table.1.atan2(table.0);
    let phase = (phase + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
    let (real, imaginary) = (own * own - forced * forced, 2.0 * zeta * own * forced);
    let expected = own * own / real.hypot(imaginary);
    assert!(expected > 1.1);
    // A step of 0.1 ms of a swing of first order: Ω·h = 0.4 % of the gain's rise and of a radian, at the most.
    assert_near(gain, expected, 0.004 * expected, "gain");
    assert_near(phase, -imaginary.atan2(real), 0.004, "phase");
}
