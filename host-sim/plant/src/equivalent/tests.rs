//! The simulated axes against the steady state of their loops, and what is assumed.

use super::*;
use crate::instruments::Instruments;
use crate::simulate::{self, Run};
use files::log::Log;
use motion::{PathBlock, PathShape};
use shared::scalar::Format;

fn machine(keys: &str) -> Machine {
    Machine::parse(&format!("name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\n{keys}"), "m.toml").unwrap()
}

/// 60 mm there and back at 100 mm/s, with 0.5 m/s²: 0.2 s of acceleration, 0.4 s of steady motion.
fn run(machine: &Machine) -> Log {
    let (machine, _) = of(machine);
    let block = |to_m: f64| PathBlock::new(PathShape::Line { to_m: vec![to_m] }, 0.1, 0.5);
    let blocks = [block(0.06), block(0.0)];
    let mut controller = simulate::controller(&machine, Format::F64, &[0.0]).unwrap();
    let instruments = Instruments::default();
    let run = Run { machine: &machine, instruments, start_m: &[0.0], blocks: &blocks, start_s: 0.0 };
    run.log(controller.as_mut(), |_, _, _| ()).unwrap()
}

/// Difference of two channels at a time, µm.
fn difference_um(log: &Log, channels: [&Option<Vec<f64>>; 2], at_s: f64) -> f64 {
    let [a, b] = channels.map(|channel| channel.as_ref().unwrap());
    let mean = |values: &[f64], i: usize| numerics::mean(values[i - 5..i + 5].iter().copied());
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a sample")]
    let i = (at_s / log.sample_time_s) as usize;
    1e3 * (mean(a, i) - mean(b, i))
}

/// With Kp = 50 1/s and τ = 4 ms the loop x/c = Kp/(τs² + s + Kp) lags by v/Kp + a·(τ/Kp − 1/Kp²): 2 mm at 100 mm/s; at 75 mm/s under
/// 0.5 m/s² 1.5 mm − 0.16 mm. The velocity difference and the held output are late by about a tick of 1 ms: 0.5 m/s²·1 ms/50 1/s = 10 µm.
#[test]
fn a_velocity_drive_lags_as_its_loop() {
    let keys = "drive = \"velocity\"\nposition_gain_per_s = 50.0\n[axis.x.log_offsets]\nvelocity_time_constant_ms = 4.0\n";
    let machine = machine(keys);
    assert_eq!(of(&machine).1, []);
    let log = run(&machine);
    let x = &log.axes[0];
    let lag_um = |at_s: f64| difference_um(&log, [&x.command, &x.motor], at_s);
    assert!((lag_um(0.5) - 2000.0).abs() < 5.0, "{}", lag_um(0.5));
    assert!((lag_um(0.15) - 1340.0).abs() < 20.0, "{}", lag_um(0.15));
}

/// The motor is where its command is, at the corners of the motion, too: what is left is the resolution of the controller, 1 nm/s of velocity
/// and 1/16 nm of position. The table turns late by 4 µm of gap and twice 3 µm of the rotor.
#[test]
fn a_stepper_motor_follows_its_command_and_its_table_turns_late() {
    let effects = "[[axis.x.effect]]\nname = \"lost_motion\"\nwidth_um = 4.0\n\
                   [[axis.x.effect]]\nname = \"load_angle\"\nfriction_um = 3.0\num_s2_per_m = 0.0\n";
    let machine = machine(&format!("drive = \"stepper\"\nlead_mm = 5.0\n{effects}"));
    assert_eq!(of(&machine).1, []);
    let log = run(&machine);
    let x = &log.axes[0];
    let [there_s, back_s] = [0.4, 1.2];
    // The first sample has no command before it that could be logged.
    let both = x.command.iter().flatten().zip(x.motor.iter().flatten()).skip(1);
    let worst_um = numerics::max(both.map(|(command, motor)| 1e3 * (command - motor).abs()));
    assert!(worst_um < 1e-3, "{worst_um}");
    let behind_um = |at_s: f64| difference_um(&log, [&x.motor, &x.table], at_s);
    let width_um = behind_um(there_s) - behind_um(back_s);
    assert!((width_um - 10.0).abs() < 0.2, "{width_um}");
}

/// Beside an axis with a loop, a stepper motor is not late either: at 100 mm/s by less than 1 µm, in its acceleration of 0.5 m/s² by 1 ms/1000 1/s
/// of it, 0.5 µm.
#[test]
fn a_stepper_motor_beside_another_axis_is_not_late() {
    let text = "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ndrive = \"stepper\"\n\
                [axis.y]\ndrive = \"velocity\"\nposition_gain_per_s = 50.0\n";
    let machine = Machine::parse(text, "m.toml").unwrap();
    let (machine, _) = of(&machine);
    let blocks = [PathBlock::new(PathShape::Line { to_m: vec![0.06, 0.0] }, 0.1, 0.5)];
    let mut controller = simulate::controller(&machine, Format::F64, &[0.0, 0.0]).unwrap();
    let instruments = Instruments::default();
    let run = Run { machine: &machine, instruments, start_m: &[0.0, 0.0], blocks: &blocks, start_s: 0.0 };
    let log = run.log(controller.as_mut(), |_, _, _| ()).unwrap();
    let x = &log.axes[0];
    let late_um = |at_s: f64| difference_um(&log, [&x.command, &x.motor], at_s);
    assert!(late_um(0.4).abs() < 0.01, "{}", late_um(0.4));
    assert!((late_um(0.1).abs() - 0.5).abs() < 0.05, "{}", late_um(0.1));
}

/// Of a lost motion of 1 µm beside a stretch of 0.3 µm per m/s², all is stretch under a friction of 1/0.6 m/s², if that is not known: a greater
/// one would add to the 1 µm.
#[test]
fn an_assumed_friction_does_not_widen_the_lost_motion() {
    let effects = "[[axis.x.effect]]\nname = \"lost_motion\"\nwidth_um = 1.0\n\
                   [[axis.x.effect]]\nname = \"windup\"\num_s2_per_m = 0.3\n";
    let log = run(&machine(&format!("drive = \"stepper\"\n{effects}")));
    let behind_um = |at_s: f64| difference_um(&log, [&log.axes[0].motor, &log.axes[0].table], at_s);
    let width_um = behind_um(0.4) - behind_um(1.2);
    assert!((width_um - 1.0).abs() < 0.02, "{width_um}");
}

/// What is declared is simulated as it is.
#[test]
fn a_machine_of_which_all_is_known_is_itself() {
    let machine = Machine::parse(model::examples::VMC_MACHINE, "vmc.toml").unwrap();
    let (equivalent, assumed) = of(&machine);
    assert!(matches!(equivalent, Cow::Borrowed(_)) && assumed.is_empty());
}

#[test]
fn what_is_assumed_is_said() {
    let words = |keys: &str| {
        let (_, assumed) = of(&machine(keys));
        assumed.iter().map(Assumed::sentence).collect::<Vec<String>>().join("\n")
    };
    assert!(words("drive = \"velocity\"\nposition_gain_per_s = 50.0\n").contains("5 ms"));
    assert!(words("lead_mm = 5.0\n").contains("position gain is not known"));
    assert!(
        words("controller = \"p\"\nposition_gain_per_s = 50.0\n").contains("masses or gains are not known")
    );
    let pid = "drive = \"velocity\"\nposition_gain_per_s = 50.0\npid_i_per_s2 = 10.0\n";
    assert!(words(pid).contains("pid_"), "{}", words(pid));
    assert_eq!(words("drive = \"stepper\"\n"), "");
}
