//! A position loop that commands the velocity of a drive.

use super::{
    Command, SAMPLE_S, STEPS, Simulated, behind_gap, found, log, machine, names, stepping, swinging,
};
use files::log::Log;
use trace::{Identification, trace};

/// A machine that the machine file does not know.
struct Axis {
    /// Kp of the position loop, 1/s.
    gain_per_s: f64,
    /// Kf.
    feedforward: f64,
    /// Gain of the drive's velocity loop over the mass, 1/s, and its integral time, s.
    velocity_gain_per_s: f64,
    integral_s: f64,
    /// Friction over the mass, m/s².
    friction: f64,
    /// I (1/s²), D and FF2 (s) of the position loop, and its deadband, mm.
    pid: [f64; 4],
    /// Lost motion, mm, and lag of the table per acceleration, mm per m/s².
    lost_mm: f64,
    lag_mm: f64,
}

const AXIS: Axis = Axis {
    gain_per_s: 45.0,
    feedforward: 0.8,
    velocity_gain_per_s: 400.0,
    integral_s: 0.02,
    friction: 0.0,
    pid: [0.0; 4],
    lost_mm: 0.0,
    lag_mm: 0.0,
};

/// Position loop each millisecond, velocity loop and mass in steps of 50 µs.
fn simulated(axis: &Axis, command: Command, seconds: u32) -> Simulated {
    let h = SAMPLE_S / f64::from(STEPS);
    let (mut x, mut v, mut integral) = (command(0.0), 0.0, 0.0);
    let (mut error_sum, mut last_error) = (0.0, 0.0);
    let [mut commands, mut motor, mut acceleration] = [const { Vec::<f64>::new() }; 3];
    for i in 0..1000 * seconds {
        let t = SAMPLE_S * f64::from(i);
        let [now, before, earlier] = [0.0, 1.0, 2.0].map(|samples| command(t - samples * SAMPLE_S));
        commands.push(now);
        motor.push(x);
        let [i_per_s2, d, ff2_s, deadband_mm] = axis.pid;
        let error = (now - x) - (now - x).clamp(-deadband_mm, deadband_mm);
        error_sum += error * SAMPLE_S;
        let wanted = axis.gain_per_s * error
            + i_per_s2 * error_sum
            + d * (error - last_error) / SAMPLE_S
            + axis.feedforward * (now - before) / SAMPLE_S
            + ff2_s * (now - 2.0 * before + earlier) / (SAMPLE_S * SAMPLE_S);
        last_error = error;
        let start = v;
        for _ in 0..STEPS {
            let error = wanted - v;
            integral += error * h / axis.integral_s;
            v += h * (axis.velocity_gain_per_s * (error + integral) - 1e3 * axis.friction * (v / 0.2).tanh());
            x += h * v;
        }
        acceleration.push(1e-3 * (v - start) / SAMPLE_S);
    }
    let behind = behind_gap(&motor, axis.lost_mm);
    let table = behind.iter().zip(&acceleration).map(|(x, a)| x - axis.lag_mm * a).collect();
    Simulated { command: commands, motor, table }
}

fn logs(axis: &Axis, seed: u64) -> [Log; 3] {
    [
        log("swing.csv", seed, simulated(axis, swinging, 12), true),
        log("step.csv", seed + 100, simulated(axis, stepping, 15), true),
        log("held.csv", seed + 200, simulated(axis, |t| swinging(t + 3.0), 8), true),
    ]
}

fn traced(axis: &Axis, keys: &str, seed: u64) -> Identification {
    let logs = logs(axis, seed);
    trace(&machine(&format!("drive = \"velocity\"\n{keys}")), &logs[..2], &logs[2..], &|_| {}).unwrap()
}

/// Logs of a drive with Kp 45 1/s and Kf 80 %.
pub fn usual_logs() -> [Log; 3] {
    logs(&AXIS, 2)
}

const KEYS: &str = "position_gain_per_s = 45.0\nfeedforward_percent = 80.0\n";

/// A velocity loop with an integral part and any bandwidth is part of the model: what it leaves of the motor is no effect.
#[test]
fn a_drive_of_unknown_bandwidth_is_no_effect() {
    // The last has no integral part: a dead time is another optimum of its fit, which leaves micrometres.
    for (seed, velocity_gain_per_s, integral_s) in
        [(1, 150.0, 0.02), (2, 400.0, 0.02), (3, 1500.0, 0.02), (8, 200.0, f64::INFINITY)]
    {
        let trace = traced(&Axis { velocity_gain_per_s, integral_s, ..AXIS }, KEYS, seed);
        assert_eq!(names(&trace), [""; 0], "{velocity_gain_per_s}");
        let motor =
            trace.axes()[0].residuals.iter().find(|r| r.stage == model::effects::Stage::Motor).unwrap();
        // The noise of the encoder, 50 nm, and what the steps of the model leave.
        assert!(motor.after.validate < 0.3, "{velocity_gain_per_s}: {} µm", motor.after.validate);
    }
}

/// All terms of LinuxCNC's pid are part of the model: what they leave of the motor is no effect. Without the keys, 1500 1/s² of the
/// integral part, 4 ms of the acceleration and 20 µm of deadband leave micrometres.
#[test]
fn the_terms_of_a_pid_are_part_of_the_model() {
    let axis = Axis { pid: [1500.0, 0.02, 4e-3, 0.02], ..AXIS };
    let left_um = |trace: &Identification| {
        let motor =
            trace.axes()[0].residuals.iter().find(|r| r.stage == model::effects::Stage::Motor).unwrap();
        motor.after.validate
    };
    let pid = "pid_i_per_s2 = 1500.0\npid_d = 0.02\npid_ff2_s = 4e-3\npid_deadband_um = 20.0\n";
    let known = traced(&axis, &format!("{KEYS}{pid}"), 9);
    // The steps of 50 µs of this simulator change the drive's gain of 400 1/s by 1 %: a part of it may be told, not as a fact.
    for found in &known.axes()[0].found {
        let percent = found.effect.values()[0];
        assert!(found.effect.name() == "servo_mismatch" && percent.abs() < 1.5, "{found:?}");
        assert!(!trace::certainty::is_certain(&known.axes()[0], found), "{found:?}");
    }
    let without_um = left_um(&traced(&axis, KEYS, 9));
    assert!(
        left_um(&known) < 0.3 && without_um > 10.0 * left_um(&known),
        "{without_um} {} µm",
        left_um(&known)
    );
}

/// A position gain 6 % above the declared one, or a feed-forward 3 percentage points below it: in steady motion the axis lags by
/// v·(1 − Kf)/Kp, and the unknown drive follows the rest. One of both is found, with the true lag and the other as its rival.
#[test]
fn gain_and_feedforward_of_an_unknown_drive_are_rivals() {
    for (seed, gain, feedforward) in [(4, 45.0 * 1.06, 0.8), (5, 45.0, 0.77)] {
        let trace = traced(&Axis { gain_per_s: gain, feedforward, ..AXIS }, KEYS, seed);
        let [one] = &trace.axes()[0].found[..] else { panic!("{:?}", names(&trace)) };
        let percent = one.effect.values()[0];
        let (lag_s, rival) = match one.effect.name() {
            "servo_mismatch" => (0.2 / (45.0 * (1.0 + 0.01 * percent)), "feedforward_mismatch"),
            "feedforward_mismatch" => ((0.2 - 0.01 * percent) / 45.0, "servo_mismatch"),
            other => panic!("{other}"),
        };
        assert_eq!(one.rival_names(), [rival]);
        let true_s = (1.0 - feedforward) / gain;
        assert!((lag_s / true_s - 1.0).abs() < 0.01, "{}: {lag_s} {true_s}", one.effect.name());
    }
}

/// 8 µm of lost motion, of which nobody can say how much is a gap, and a lag of 0.9 µm per m/s².
#[test]
fn lost_motion_has_its_size_and_names_its_parts_as_rivals() {
    let axis = Axis { friction: 0.5, lost_mm: 8e-3, lag_mm: 9e-4, ..AXIS };
    let trace = traced(&axis, KEYS, 6);
    let (lost, width_um, half) = found(&trace, "lost_motion").unwrap();
    assert!((width_um - 8.0).abs() < half.max(0.1) && half < 0.3, "{width_um} ± {half}");
    assert_eq!(lost.rival_names(), ["backlash", "windup"]);
    let (_, lag, half) = found(&trace, "windup").unwrap();
    assert!((lag - 0.9).abs() < half.max(0.02) && half < 0.1, "{lag} ± {half}");
    assert!(found(&trace, "backlash").is_none(), "{:?}", names(&trace));
}

/// A machine file with names alone: the motor stage says which keys it lacks, and the table stage finds the same.
#[test]
fn a_machine_file_may_hold_nothing_but_the_kind_of_drive() {
    let axis = Axis { lost_mm: 8e-3, ..AXIS };
    let trace = traced(&axis, "", 7);
    let (_, width_um, half) = found(&trace, "lost_motion").unwrap();
    assert!((width_um - 8.0).abs() < half.max(0.1) && half < 0.3, "{width_um} ± {half}");
    let needs: Vec<&str> = trace.axes()[0].not_testable.iter().map(|stage| stage.needs.as_str()).collect();
    assert!(needs.iter().any(|needs| needs.contains("position_gain_per_s in the machine file")), "{needs:?}");
}

/// Gains that the machine file does not have are fitted: what they would be wrong by is no effect, the lag (1 − Kf)/Kp in steady motion is
/// the true one, and the lost motion behind the motor is found beside it.
#[test]
fn unknown_gains_are_fitted_and_are_no_effects() {
    for (seed, lost_mm) in [(11, 0.0), (12, 0.008)] {
        let axis = Axis { lost_mm, ..AXIS };
        let logs = logs(&axis, seed);
        let (with_gains, notes) = init::gains::of_unknown(&machine("drive = \"velocity\"\n"), &logs[..2]);
        assert_eq!(notes.len(), 1, "{notes:?}");
        let trace = trace(&with_gains, &logs[..2], &logs[2..], &|_| {}).unwrap();
        let expected: &[&str] = if lost_mm > 0.0 { &["lost_motion"] } else { &[] };
        assert_eq!(names(&trace), expected, "{lost_mm}");
        let controller = &trace.axes()[0].model.axis.settings.controller;
        let [gain, percent] =
            [controller.position_gain_per_s, controller.feedforward_percent].map(Option::unwrap);
        let lag_s = (1.0 - 0.01 * percent) / gain;
        assert!((lag_s / (0.2 / 45.0) - 1.0).abs() < 0.02, "{gain} 1/s, {percent} %");
        let motor =
            trace.axes()[0].residuals.iter().find(|r| r.stage == model::effects::Stage::Motor).unwrap();
        // As with declared gains: the noise of the encoder and what the steps of the model leave.
        assert!(motor.after.validate < 0.3, "{} µm", motor.after.validate);
    }
}

/// A declared gain is left as it is.
#[test]
fn declared_gains_are_not_replaced() {
    let declared = machine(&format!("drive = \"velocity\"\n{KEYS}"));
    let (same, notes) = init::gains::of_unknown(&declared, &logs(&AXIS, 2)[..2]);
    assert!(same == declared && notes.is_empty(), "{notes:?}");
}
