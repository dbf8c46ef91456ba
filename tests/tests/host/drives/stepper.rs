//! Stepper motors, with and without an encoder.

use super::{
    Command, SAMPLE_S, STEPS, Simulated, behind_gap, command_and_acceleration, found, log, machine, names,
    stepping, swinging,
};
use commissioning::compensate::planning::Planning;
use commissioning::compensate::prediction::TestMotion;
use files::log::Log;
use plant::instruments::Instruments;
use shared::compensate::CompensationSettings;
use std::f64::consts::TAU;
use trace::{Identification, trace};

/// A motor whose field holds the rotor as a spring, and the screw behind it.
struct Axis {
    /// Angular frequency of the rotor in its field, 1/s.
    omega: f64,
    /// Friction of the rotor as a displacement in the field, mm.
    friction_mm: f64,
    /// Amplitude and period of the microstep error, mm.
    microstep_mm: [f64; 2],
    /// Gap of the nut, mm, and relative error of the lead.
    gap_mm: f64,
    slope: f64,
}

const AXIS: Axis = Axis { omega: 900.0, friction_mm: 0.0, microstep_mm: [0.0, 0.1], gap_mm: 0.0, slope: 0.0 };

/// Relative to the command u, the rotor d = x − u in its field: d" + 2ζω·d' + ω²·d = −u" − friction·sign(v), with ζ = 0.5.
fn simulated(axis: &Axis, command: impl Fn(f64) -> f64, seconds: u32) -> Simulated {
    let h = SAMPLE_S / f64::from(STEPS);
    let (mut d, mut rate) = (0.0, 0.0);
    let [mut commands, mut motor] = [const { Vec::<f64>::new() }; 2];
    let [amplitude_mm, period_mm] = axis.microstep_mm;
    for i in 0..1000 * seconds {
        let t = SAMPLE_S * f64::from(i);
        let u = command(t);
        commands.push(u);
        motor.push(u + amplitude_mm * (TAU * u / period_mm + 0.7).sin() + d);
        for step in 0..STEPS {
            let now = t + h * f64::from(step);
            let [u, acceleration] = command_and_acceleration(&command, now);
            let velocity = (command(now + h) - u) / h + rate;
            let friction = axis.omega * axis.omega * axis.friction_mm * (velocity / 0.05).tanh();
            rate += h * (-acceleration - friction - axis.omega * rate - axis.omega * axis.omega * d);
            d += h * rate;
        }
    }
    let scaled: Vec<f64> = motor.iter().map(|x| (1.0 + axis.slope) * x).collect();
    let table = behind_gap(&scaled, axis.gap_mm);
    Simulated { command: commands, motor, table }
}

fn logs(axis: &Axis, has_encoder: bool, seed: u64) -> [Log; 3] {
    // At 15 mm/s, four full steps are passed 150 times a second.
    [
        log("swing.csv", seed, simulated(axis, |t| swinging(0.15 * t), 30), has_encoder),
        log("step.csv", seed + 100, simulated(axis, |t| 0.4 * stepping(0.7 * t), 20), has_encoder),
        log("held.csv", seed + 200, simulated(axis, |t| swinging(0.15 * t + 3.0), 20), has_encoder),
    ]
}

fn traced(axis: &Axis, has_encoder: bool, seed: u64) -> Identification {
    let logs = logs(axis, has_encoder, seed);
    let machine = machine("drive = \"stepper\"\nlead_mm = 5.0\n");
    trace(&machine, &logs[..2], &logs[2..], &|_| {}).unwrap()
}

/// Logs without an encoder.
pub fn usual_logs() -> [Log; 3] {
    logs(&AXIS, false, 1)
}

#[test]
fn a_stepper_that_follows_its_command_has_no_effect_but_its_inertia() {
    for has_encoder in [false, true] {
        let trace = traced(&AXIS, has_encoder, 1);
        // Under 0.1 m/s² the rotor lags by a/ω², 0.1 µm.
        let others: Vec<&str> =
            names(&trace).into_iter().filter(|name| !["windup", "load_angle"].contains(name)).collect();
        assert_eq!(others, [""; 0], "{has_encoder}");
    }
}

/// A gap of 5 µm and 2 µm of friction in the field either way are 9 µm of lost motion: one quantity without an encoder. The microsteps
/// have 1.6 µm with a period of four full steps, 5 mm / 50.
#[test]
fn a_stepper_without_an_encoder_shows_lost_motion_and_microsteps() {
    let axis = Axis { friction_mm: 2e-3, gap_mm: 5e-3, microstep_mm: [1.6e-3, 0.1], slope: 200e-6, ..AXIS };
    let trace = traced(&axis, false, 2);
    let (lost, width_um, half) =
        found(&trace, "lost_motion").unwrap_or_else(|| panic!("{:?}", names(&trace)));
    // The rotor swings in its field at reversals, which the model does not have: it leaves some tenths of a micrometre.
    assert!((width_um - 9.0).abs() < 0.4 && half < 0.5, "{width_um} ± {half}");
    let rivals = lost.rival_names();
    assert!(["backlash", "windup", "load_angle"].iter().all(|part| rivals.contains(part)), "{rivals:?}");
    let (_, amplitude_um, half) =
        found(&trace, "microstep_error").unwrap_or_else(|| panic!("{:?}", names(&trace)));
    assert!((amplitude_um - 1.6).abs() < half.max(0.05) && half < 0.2, "{amplitude_um} ± {half}");
    let (_, slope, half) =
        found(&trace, "pitch_progressive").unwrap_or_else(|| panic!("{:?}", names(&trace)));
    // The scale, whose gain nothing shows, may be off by 40 µm/m.
    assert!((slope - 200.0).abs() < 5.0 && (40.0..45.0).contains(&half), "{slope} ± {half}");
}

/// A command with the table and the reversal of a compensation, as controls apply them: half of the width in the direction of motion.
fn compensated(command: Command, settings: &CompensationSettings) -> impl Fn(f64) -> f64 {
    let table = settings.pitch.as_ref().unwrap().forward.clone();
    let half_mm = 500.0 * settings.backlash_width_m.unwrap();
    move |t: f64| {
        let x = command(t);
        let at = (1e-3 * x - table.start_m) / table.spacing_m;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index of the table")]
        let k = (at.floor().max(0.0) as usize).min(table.values.len() - 2);
        let error_m = table.values[k] + (at - k as f64) * (table.values[k + 1] - table.values[k]);
        let speed = (command(t + 1e-4) - command(t - 1e-4)) / 2e-4;
        x - 1e3 * error_m + half_mm * (speed / 0.05).tanh()
    }
}

/// Table − command, µm rms without the mean, of an axis that is given another command.
fn deviation_um(axis: &Axis, command: Command, given: impl Fn(f64) -> f64) -> f64 {
    let simulated = simulated(axis, given, 30);
    let error = |(i, table): (usize, &f64)| 1e3 * (table - command(SAMPLE_S * i as f64));
    let errors: Vec<f64> = simulated.table.iter().enumerate().map(error).collect();
    let mean = numerics::mean(errors.iter().copied());
    numerics::rms(errors.iter().map(|um| um - mean))
}

/// Neither masses nor gains are known: the screw and the lost motion are compensated all the same, for a simulator that shares no code
/// with the plant. 200 µm/m at 28.6 mm rms, and 4.5 µm on each side, are 7.3 µm rms.
#[test]
fn what_is_found_is_compensated_without_masses() {
    let axis = Axis { friction_mm: 2e-3, gap_mm: 5e-3, slope: 200e-6, ..AXIS };
    let model = traced(&axis, false, 5).better_machine();
    let motion = "name = \"there and back\"\nfeed_mm_per_min = 1200.0\nacceleration_m_per_s2 = 0.5\nstart_mm = { x = -46.0 }\n\
                  [[block]]\nline_to_mm = { x = 46.0 }\n[[block]]\nline_to_mm = { x = -46.0 }\n";
    let test = TestMotion::parse(motion, "motion.toml", 0.0).unwrap();
    let planning = Planning {
        model: &model,
        model_file: "machine.toml",
        tests: &[test],
        watched: &[],
        instruments: Instruments::default(),
        set_at_s: 0.0,
    };
    let plan = planning.plan().unwrap();
    assert!(plan.assumed.is_empty(), "{:?}", plan.assumed);
    let settings = &plan.file.axis["x"].compensation;
    assert!(settings.force.is_none());
    let slow: Command = |t| swinging(0.15 * t);
    let before_um = deviation_um(&axis, slow, slow);
    let after_um = deviation_um(&axis, slow, compensated(slow, settings));
    assert!((6.8..7.8).contains(&before_um) && after_um < 0.15 * before_um, "{before_um} {after_um}");
}

/// With an encoder, the load angle is that of the motor and the lost motion that behind it.
#[test]
fn an_encoder_parts_the_load_angle_from_the_lost_motion() {
    let axis = Axis { friction_mm: 2e-3, gap_mm: 5e-3, microstep_mm: [1.6e-3, 0.1], ..AXIS };
    let trace = traced(&axis, true, 3);
    let (_, friction_um, half) = found(&trace, "load_angle").unwrap_or_else(|| panic!("{:?}", names(&trace)));
    assert!((friction_um - 2.0).abs() < half.max(0.1) && half < 0.3, "{friction_um} ± {half}");
    let (_, width_um, half) = found(&trace, "lost_motion").unwrap_or_else(|| panic!("{:?}", names(&trace)));
    assert!((width_um - 5.0).abs() < half.max(0.1) && half < 0.3, "{width_um} ± {half}");
    let (_, amplitude_um, half) =
        found(&trace, "microstep_error").unwrap_or_else(|| panic!("{:?}", names(&trace)));
    assert!((amplitude_um - 1.6).abs() < half.max(0.05) && half < 0.2, "{amplitude_um} ± {half}");
}
