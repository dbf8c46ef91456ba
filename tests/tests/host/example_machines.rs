//! The shipped machines run the shipped motions: stable, near their path, to a standstill.

use std::path::{Path, PathBuf};

use files::log::{AxisLog, Log};
use model::axis::Settings;
use model::machine::{Axis, Machine};
use motion::PathBlock;
use motion::{Block, MAX_AXES, Motion};
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::simulate::{Run, controller};
use shared::scalar::Format;

/// Standstill after the motion, s: the slowest machine has Kp = 33 1/s, and e^(−33·0.5) = 7e-8.
const STANDSTILL_S: f64 = 1.0;

/// The last part of it, which is examined, in samples at 1 kHz.
const EXAMINED: usize = 200;

/// The files of a folder of `host-sim`, sorted.
fn shipped(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("host-sim").join(folder);
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// The log of a motion and of a standstill after it, with the greatest speed (mm/s) and acceleration (m/s²). `None`: the motion is
/// faster than the machine may be, or of axes that it has not.
fn run(machine: &Machine, motion: &Path) -> Option<(Log, [f64; 2])> {
    let source = motion.display().to_string();
    let motion = Motion::read(motion).unwrap();
    let pace = |block: &Block| match block {
        Block::Dwell { .. } => [0.0; 2],
        Block::Line { pace, .. } | Block::Arc { pace, .. } => {
            [pace.feed_mm_per_min / 60.0, pace.acceleration_m_per_s2]
        }
    };
    let greatest = |of: usize| motion.blocks.iter().map(|block| pace(block)[of]).fold(0.0, f64::max);
    let pace = [greatest(0), greatest(1)];
    let is_too_fast =
        |axis: &Axis| axis.settings.limits.fastest_mm_per_s.is_some_and(|fastest| pace[0] > 0.9 * fastest);
    if machine.axis.values().any(is_too_fast) {
        return None;
    }
    if motion.start_mm.keys().any(|name| !machine.axis.contains_key(name)) {
        return None;
    }
    let mut path = MachinePath::new(&motion, machine, &source).unwrap();
    path.blocks.push(PathBlock::dwell(STANDSTILL_S));
    let run = Run {
        machine,
        instruments: Instruments::typical(1),
        start_m: &path.start_m,
        blocks: &path.blocks,
        start_s: 0.0,
    };
    let mut controller = controller(machine, Format::Fixed, &path.start_m).unwrap();
    Some((run.log(controller.as_mut(), |_, _, _| {}).unwrap(), pace))
}

fn max_abs(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

/// Asserts bounds of the following error and of the force, and standstill at the end.
fn assert_good(axis: &Settings, log: &AxisLog, [feed_mm_s, acceleration_m_per_s2]: [f64; 2], context: &str) {
    let [command, motor, force] = [&log.command, &log.motor, &log.force].map(|c| c.as_deref().unwrap());
    let following: Vec<f64> = command.iter().zip(motor).map(|(command, motor)| command - motor).collect();

    // At a constant velocity P control lags by v/Kp, less the feed-forward. Until the integral part has grown, a force F needs an
    // error of F/(Kv·Kp): that of acceleration and friction.
    let (controller, mechanics) = (&axis.controller, &axis.mechanics);
    let mass_kg = mechanics.motor_mass_kg.unwrap() + mechanics.table_mass_kg.unwrap();
    let force_n = mass_kg * acceleration_m_per_s2
        + mechanics.coulomb_n.unwrap_or(0.0)
        + mechanics.viscous_n_s_per_m.unwrap_or(0.0) * 1e-3 * feed_mm_s;
    let gains = controller.velocity_gain_n_s_per_m.unwrap() * controller.position_gain_per_s.unwrap();
    let force_mm = 1e3 * force_n / gains;
    let lag_s = (1.0 - axis.controller.feedforward_percent.unwrap_or(0.0) / 100.0)
        / axis.controller.position_gain_per_s.unwrap();
    let max = max_abs(following.iter().copied());
    assert!(max < 1.15 * lag_s * feed_mm_s + force_mm, "{context}: lags by {max} mm at {feed_mm_s} mm/s");

    let max = max_abs(force.iter().copied());
    let limit = axis.controller.force_limit_n.unwrap();
    // Where the acceleration jumps, the loops overshoot, by less than the step itself.
    assert!(max < (2.0 * force_n).min(0.9 * limit), "{context}: {max} N of {force_n} N, limit {limit} N");

    // At standstill the bristles of the guideway may hold the table by their deflection, Coulomb friction over σ0, some
    // µm. Without bristles Coulomb friction holds an error e until Kv·Kp·e·(1 + t/Ti) overcomes it.
    let first = following.len() - EXAMINED;
    let integral = 1.0 + STANDSTILL_S / controller.velocity_integral_time_s.unwrap_or(f64::INFINITY);
    let bend_mm = mechanics.presliding_stiffness_n_per_um.map_or_else(
        || 1e-3f64.max(1e3 * mechanics.coulomb_n.unwrap_or(0.0) / (gains * integral)),
        |stiffness| 1e-3 * mechanics.coulomb_n.unwrap() / stiffness,
    );
    let error = max_abs(following[first..].iter().copied());
    assert!(error < bend_mm, "{context}: {error} mm from the end, bristles bend by {bend_mm} mm");
    let travelled = max_abs(motor[first..].iter().map(|mm| mm - motor[first]));
    assert!(travelled < 0.5e-3, "{context}: moves by {travelled} mm at standstill");
}

#[test]
fn every_machine_runs_every_motion_to_a_standstill() {
    let (machines, motions) = (shipped("machines"), shipped("motions"));
    assert!(machines.len() >= 3 && motions.len() >= 5, "{machines:?} {motions:?}");
    let all = machines.iter().map(|file| (file, Machine::read(file).unwrap()));
    let (simulated, others): (Vec<_>, Vec<_>) = all.partition(|(_, machine)| machine.axis.len() <= MAX_AXES);
    // A contour has at most three axes. A servo board moves a fourth one beside it.
    let of_four = ["bench_four.toml", "bench_gantry.toml"];
    assert!(others.iter().all(|(file, _)| of_four.iter().any(|name| file.ends_with(name))), "{others:?}");
    for (file, machine) in simulated {
        let mut count = 0;
        for motion in &motions {
            let Some((log, pace)) = run(&machine, motion) else { continue };
            count += 1;
            for (name, axis) in &machine.axis {
                let context = format!("{}, {}, {name}", file.display(), motion.display());
                assert_good(&axis.settings, log.axis(name).unwrap(), pace, &context);
            }
        }
        assert!(count >= 5, "{}: {count} motions", file.display());
    }
}
