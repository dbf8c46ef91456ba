//! The machines that ship run the motions that ship: stably, near their path, to a standstill.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

use files::log::{AxisLog, Log};
use link::controller::{Format, PathBlock};
use model::axis::Settings;
use model::machine::Machine;
use model::motion::{Block, Motion};
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::simulate::{Run, controller};

/// Standstill after the motion, s: the slowest machine has Kp = 33 1/s, and e^(−33·0.5) = 7e-8.
const REST_S: f64 = 0.5;

/// The part of it that is looked at, in samples at 1 kHz.
const AT_REST: usize = 200;

/// Files of a folder of `host-sim`.
fn shipped(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("host-sim").join(folder);
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// The log of a motion and of a rest behind it, and the greatest feed on the way, mm/s.
fn run(machine: &Machine, motion: &Path) -> (Log, f64) {
    let source = motion.display().to_string();
    let motion = Motion::read(motion).unwrap();
    let mut path = MachinePath::new(&motion, machine, &source).unwrap();
    path.blocks.push(PathBlock::dwell(REST_S));
    let run = Run {
        machine,
        instruments: Instruments::typical(1),
        start_m: &path.start_m,
        blocks: &path.blocks,
        start_s: 0.0,
    };
    let mut controller = controller(machine, Format::Fixed, &path.start_m).unwrap();
    let feed = |block: &Block| match block {
        Block::Dwell { .. } => 0.0,
        Block::Line { pace, .. } | Block::Arc { pace, .. } => pace.feed_mm_per_min / 60.0,
    };
    let greatest_feed = motion.blocks.iter().map(feed).fold(0.0, f64::max);
    (run.log(controller.as_mut(), |_, _, _| {}).unwrap(), greatest_feed)
}

fn greatest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

/// Bounds of the following error, mm, and of the force, N.
fn assert_good(axis: &Settings, log: &AxisLog, feed_mm_s: f64, context: &str) {
    let [command, motor, force] = [&log.command, &log.motor, &log.force].map(|c| c.as_deref().unwrap());
    let following: Vec<f64> = command.iter().zip(motor).map(|(command, motor)| command - motor).collect();

    // At a steady speed P control is behind by v/Kp, of which the feed-forward makes up its share.
    let lag_s = (1.0 - axis.controller.feedforward_percent.unwrap_or(0.0) / 100.0)
        / axis.controller.position_gain_per_s.unwrap();
    let most = greatest(following.iter().copied());
    assert!(most < 1.15 * lag_s * feed_mm_s, "{context}: behind by {most} mm at {feed_mm_s} mm/s");

    let most = greatest(force.iter().copied());
    let limit = axis.controller.force_limit_n.unwrap();
    assert!(most < 0.5 * limit, "{context}: {most} N of {limit} N");

    // What is left is what the guideway's bristles hold: they bend by Coulomb over σ0, some µm. Without bristles it is
    // what friction keeps from moving on, until the integral part has grown: 1 µm of command is Kv·Kp·1 µm.
    let rest = following.len() - AT_REST;
    let bend_mm = axis
        .mechanics
        .presliding_stiffness_n_per_um
        .map_or(1e-3, |stiffness| 1e-3 * axis.mechanics.coulomb_n.unwrap() / stiffness);
    let left = greatest(following[rest..].iter().copied());
    assert!(left < bend_mm, "{context}: {left} mm from the end, bristles bend {bend_mm} mm");
    let travelled = greatest(motor[rest..].iter().map(|place| place - motor[rest]));
    assert!(travelled < 0.5e-3, "{context}: still moved by {travelled} mm at rest");
}

#[test]
fn every_machine_runs_every_motion_and_settles() {
    let (machines, motions) = (shipped("machines"), shipped("motions"));
    assert!(machines.len() >= 3 && motions.len() >= 5, "{machines:?} {motions:?}");
    for file in &machines {
        let machine = Machine::read(file).unwrap();
        for motion in &motions {
            let (log, feed_mm_s) = run(&machine, motion);
            for (name, axis) in &machine.axis {
                let context = format!("{}, {}, {name}", file.display(), motion.display());
                assert_good(&axis.settings, log.axis(name).unwrap(), feed_mm_s, &context);
            }
        }
    }
}
