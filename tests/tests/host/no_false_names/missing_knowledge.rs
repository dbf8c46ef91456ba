//! Logs without some channels and machine files without some keys: nothing is reported as a fact that they do not determine.

use files::log::{AxisLog, Log};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use self_test::gap::CONTROLLER_KEYS;
use self_test::plant::Mechanics;
use trace::certainty::is_certain;
use trace::judge::found_effect::FoundEffect;

use super::machine::{TestMachine, wave_um};
use super::reported::{beyond_tolerance, certain, context, found, named};

/// A machine with P control.
const P: u64 = 1;

/// Lines of a machine file without some keys.
fn without_keys(text: &str, keys: &[&str]) -> String {
    let is_left = |line: &&str| !keys.iter().any(|key| line.starts_with(&format!("{key} = ")));
    text.lines().filter(is_left).map(|line| format!("{line}\n")).collect()
}

/// The log without some channels.
fn without(log: &mut Log, remove: impl Fn(&mut AxisLog)) {
    log.axes.iter_mut().for_each(remove);
}

/// Once: backlash 15.9 ± 0.1 µm, certain, where 12 is backlash and the rest 2·F/k; and 2.9 µm on an axis that has none, as here.
#[test]
fn lost_motion_without_a_declared_stiffness_is_not_certainly_backlash() {
    let mut machine = TestMachine::new(P);
    let mechanics = [
        "motor_mass_kg",
        "table_mass_kg",
        "stiffness_n_per_um",
        "damping_n_s_per_m",
        "coulomb_n",
        "viscous_n_s_per_m",
        "motor_coulomb_n",
        "presliding_stiffness_n_per_um",
        "presliding_damping_n_s_per_m",
    ];
    for axis in &mut machine.drawn.declared {
        axis.text = without_keys(&axis.text, &mechanics);
    }
    let trace = machine.trace_of(|log| without(log, |axis| axis.force = None));
    let lost = found(&trace, 1, "lost_motion");
    // The stretch by friction, 2·F/k. That by acceleration is told apart; viscous friction adds some percent.
    let Mechanics { stiffness_n_per_m, coulomb_n, .. } = machine.drawn.axes[1].mechanics;
    let lost_um = 2e6 * coulomb_n / stiffness_n_per_m;
    let width_um = lost.effect.values()[0];
    assert!((0.95..1.15).contains(&(width_um / lost_um)), "{lost_um}: {}", context(&trace));
    let rivals = lost.rival_names();
    assert!(["backlash", "windup"].iter().all(|part| rivals.contains(part)), "{}", context(&trace));
    let is_either = |name: &str| ["backlash", "lost_motion"].contains(&name);
    assert!(!certain(&trace).iter().any(|(_, name)| is_either(name)), "{}", context(&trace));
}

/// The case of the first report: 12 µm of backlash with the stiffness alone left out: "backlash 15.9 ± 0.1 µm", certain.
#[test]
fn a_backlash_beside_an_undeclared_stiffness_is_ambiguous_with_windup() {
    let width_um = 12.0;
    let mut machine = TestMachine::new(P).with_mechanics(1, |y| y.backlash_m = 1e-6 * width_um);
    for axis in &mut machine.drawn.declared {
        axis.text = without_keys(&axis.text, &["stiffness_n_per_um"]);
    }
    let trace = machine.trace();
    let backlash = found(&trace, 1, "backlash");
    assert!(!is_certain(&trace.axes()[1], backlash), "{}", context(&trace));
    assert!(backlash.rival_names().contains(&"windup"), "{}", context(&trace));
    // The backlash, and at most twice the stretch by Coulomb friction, as viscous friction and acceleration add to it.
    let Mechanics { stiffness_n_per_m, coulomb_n, .. } = machine.drawn.axes[1].mechanics;
    let lost_um = 2e6 * coulomb_n / stiffness_n_per_m;
    let found_um = backlash.effect.values()[0];
    assert!((width_um - 0.5..width_um + 2.0 * lost_um).contains(&found_um), "{lost_um}: {}", context(&trace));
    assert!(!certain(&trace).iter().any(|(_, name)| *name == "backlash"), "{}", context(&trace));
}

/// Once: `motor_stribeck` on both axes, certain. An absent value is unknown, not zero.
#[test]
fn a_motor_friction_that_is_not_declared_is_unknown() {
    let mut machine = TestMachine::new(P);
    for axis in &mut machine.drawn.declared {
        axis.text = without_keys(&axis.text, &["motor_coulomb_n"]);
    }
    let trace = machine.trace();
    assert_eq!(named(&trace), [], "{}", context(&trace));
    for (traced, true_axis) in trace.axes().iter().zip(&machine.drawn.axes) {
        let fitted_n = traced.model.axis.settings.mechanics.motor_coulomb_n.unwrap();
        let true_n = true_axis.mechanics.motor_coulomb_n;
        assert!((fitted_n / true_n - 1.0).abs() < 0.05, "{fitted_n} {true_n}");
    }
}

/// Once: "velocity gain 5.13 ± 0.01 % below", certain: without a force, a factor of masses, friction and Kv is not observable.
#[test]
fn without_a_force_the_velocity_gain_is_not_certain() {
    let machine = TestMachine::new(P).with_declared(0, "velocity_gain_n_s_per_m", |kv| 1.3 * kv);
    let trace = machine.trace_of(|log| without(log, |axis| axis.force = None));
    assert!(
        !certain(&trace).iter().any(|(_, name)| *name == "velocity_gain_mismatch"),
        "{}",
        context(&trace)
    );
}

/// Once: in-talk 1.728 ± 0.008 (true 2.041) and a mode of 175.6 Hz that does not exist: the stretch of the drive.
#[test]
fn without_a_table_the_stretch_of_the_drive_is_no_certain_effect_of_the_tool() {
    let trace = TestMachine::new(P).trace_of(|log| without(log, |axis| axis.table = None));
    assert_eq!(certain(&trace), [], "{}", context(&trace));
}

/// Once: "table mass 22.39 ± 0.03 % below", "motor mass 31.4 ± 0.1 % above" on machines declared exactly, with an encoder of 0.5 or
/// 1 µm and with motor and force alone: the sum of the masses is known.
#[test]
fn motor_and_force_alone_do_not_divide_the_masses() {
    for step_mm in [0.5e-3, 1e-3] {
        let trace = TestMachine::new(P).trace_of(|log| {
            without(log, |axis| (axis.table, axis.tool) = (None, None));
            let motors = log.axes.iter_mut().filter_map(|axis| axis.motor.as_mut()).flatten();
            motors.for_each(|mm| *mm = (*mm / step_mm).round() * step_mm);
        });
        assert_eq!((certain(&trace), beyond_tolerance(&trace)), (vec![], vec![]), "{}", context(&trace));
    }
}

/// Once: "motor mass 31.4 ± 0.1 % above" on a machine declared exactly, with a log that is noisier than the loop: noise of 1 µm that the
/// controller does not see, with motor and force alone.
#[test]
fn noise_of_the_log_that_the_loop_does_not_have_is_no_mass() {
    let mut random = ChaCha8Rng::seed_from_u64(25);
    let trace = TestMachine::new(P).trace_of(|log| {
        without(log, |axis| (axis.table, axis.tool) = (None, None));
        let motors = log.axes.iter_mut().filter_map(|axis| axis.motor.as_mut()).flatten();
        // Uniform, of 1 µm rms.
        motors.for_each(|mm| *mm += 3.0_f64.sqrt() * 1e-3 * random.random_range(-1.0..=1.0));
    });
    assert_eq!((certain(&trace), beyond_tolerance(&trace)), (vec![], vec![]), "{}", context(&trace));
}

/// Once: a torque ripple of 1.0 ± 0.2 N, certain. At a speed v, a wave of the screw with amplitude A and period p accelerates the table by
/// A·(2πv/p)², which needs a force of the same period.
#[test]
fn without_a_table_a_wave_of_the_screw_is_no_certain_torque_ripple() {
    let lead_mm = TestMachine::new(P).declared(0, "lead_mm");
    let machine =
        TestMachine::new(P).with_mechanics(0, |x| x.screw_waves = vec![wave_um(10.0, lead_mm, 1.0)]);
    let trace = machine.trace_of(|log| without(log, |axis| (axis.table, axis.tool) = (None, None)));
    let ripples = trace.axes()[0].found.iter().filter(|found| found.effect.name() == "torque_ripple");
    let rivals: Vec<_> = ripples.map(FoundEffect::rival_names).collect();
    assert!(!rivals.is_empty() && rivals.iter().all(|names| names.contains(&"pitch_cyclic")));
    assert_eq!(certain(&trace), [], "{}", context(&trace));
}

/// Once: "motor mass 17.0 ± 0.4 % below", on 9 of 9 machines without the gains of their loop: between two rows of the log, the force
/// changes in a way that is then not known.
#[test]
fn without_the_gains_of_the_loop_the_masses_are_not_divided() {
    for seed in [P, 2] {
        let mut machine = TestMachine::new(seed);
        for axis in &mut machine.drawn.declared {
            axis.text = without_keys(&axis.text, &CONTROLLER_KEYS);
        }
        let trace = machine.trace();
        assert_eq!((certain(&trace), beyond_tolerance(&trace)), (vec![], vec![]), "{}", context(&trace));
    }
}
