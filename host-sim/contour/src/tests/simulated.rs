//! Runs of the demo machine on the simulated plant.

use super::assert_near;
use crate::evaluation::ContourError;
use crate::logged::LoggedMotion;
use crate::path::NominalPath;
use crate::verification::{is_better, is_worse};
use files::log::Log;
use model::examples::DEMO_MACHINE;
use model::machine::Machine;
use motion::Motion;
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::simulate::{Run, controller};
use shared::scalar::Format;

const CIRCLE: &str = include_str!("../../../motions/demo_ballbar.toml");
const CORNER: &str = include_str!("../../../motions/demo_corner.toml");

const BACKLASH: &str = "\n[[axis.x.effect]]\nname = \"backlash\"\nwidth_um = 12.0\n";

/// The log of a motion, and its path by the blocks.
fn run(effects: &str, motion: &str, seed: u64) -> (Log, NominalPath) {
    let machine = Machine::parse(&format!("{DEMO_MACHINE}{effects}"), "demo.toml").unwrap();
    let path =
        MachinePath::new(&Motion::parse(motion, "motion.toml").unwrap(), &machine, "motion.toml").unwrap();
    let mut controller = controller(&machine, Format::Fixed, &path.start_m).unwrap();
    let run = Run {
        machine: &machine,
        instruments: Instruments::of(&machine, seed),
        start_m: &path.start_m,
        blocks: &path.blocks,
        start_s: 0.0,
    };
    let log = run.log(controller.as_mut(), |_, _, _| {}).unwrap();
    (log, NominalPath::of_blocks(&path.start_m, &path.blocks))
}

fn error(effects: &str, motion: &str, seed: u64) -> ContourError {
    LoggedMotion::of(&run(effects, motion, seed).0).unwrap().contour_error().unwrap()
}

/// The command follows the blocks to its resolution, 1 nm, if they end with an exact stop; the path through its samples
/// leaves out points nearer than 0.1 µm.
#[test]
fn both_kinds_of_path_give_the_same_error() {
    for motion in [CIRCLE, CORNER] {
        let (log, path) = run(BACKLASH, motion, 3);
        let logged = LoggedMotion::of(&log).unwrap();
        let by_blocks = logged.contour_error_on(&path).unwrap();
        let by_command = logged.contour_error().unwrap();
        assert_near(by_blocks.rms_um, by_command.rms_um, 0.02);
        assert_near(by_blocks.max_um, by_command.max_um, 0.1);
        assert_eq!(by_blocks.circles.len(), by_command.circles.len());
        for (one, other) in by_blocks.circles.iter().zip(&by_command.circles) {
            assert_near(one.circular_um(), other.circular_um(), 0.05);
        }
        let turns = |error: &ContourError| error.corners.len();
        assert_eq!(turns(&by_blocks), turns(&by_command));
    }
}

/// Without friction the loop reduces the radius R at the angular frequency ω by R·(1 − Kf²)·ω²/(2·Kp²), with Kf as a
/// fraction: 30 mm · 0.64 · (1.11/s)²/(2·(50/s)²) = 4.74 µm. Between the reversals, where friction is constant, that is the
/// smallest radial deviation, and backlash of width w lowers it by w/2 at the angles at which x approaches its reversal.
#[test]
fn radial_deviations_follow_loop_and_backlash() {
    let (without, with) = (error("", CIRCLE, 1), error(BACKLASH, CIRCLE, 1));
    for (lap, lap_with) in without.circles[0].laps.iter().zip(&with.circles[0].laps) {
        // The velocity loop and the filter of 0.25° add some tenths of a µm.
        assert_near(lap.radial_um[0], -4.74, 0.6);
        assert_near(lap_with.radial_um[0] - lap.radial_um[0], -6.0, 0.6);
        // G is the range of a linear function of the deviation; that of the backlash alone is its width.
        assert_near(lap_with.circular_um, lap.circular_um, 12.0);
        // Friction of 210 N on x and 185 N on y reverses: the velocity loop's integral changes by twice that, and the
        // command runs ahead by up to 2·F·Ti/Kv, 112 and 108 µm, less what the position loop makes up.
        assert!(lap.spikes_um.iter().all(|um| (5.0..112.0).contains(um)), "{:?}", lap.spikes_um);
    }
    assert!(is_worse(&without, &with) && is_better(&with, &without));
    assert!(without.corners.iter().all(|corner| corner.overshoot_um < 6.0));
}

#[test]
fn another_seed_of_the_noise_is_no_change() {
    for effects in ["", BACKLASH] {
        let (one, other) = (error(effects, CIRCLE, 1), error(effects, CIRCLE, 2));
        assert!(!is_worse(&one, &other) && !is_better(&one, &other), "{} {}", one.rms_um, other.rms_um);
    }
}
