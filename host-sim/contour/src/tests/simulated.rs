//! Runs of the demo machine on the simulated plant.

use super::assert_near;
use crate::evaluation::ContourError;
use crate::logged::LoggedMotion;
use crate::path::NominalPath;
use crate::verification::{is_better, is_worse};
use files::log::Log;
use link::controller::Format;
use model::examples::DEMO_MACHINE;
use model::machine::Machine;
use model::motion::Motion;
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::simulate::{Run, controller};

const CIRCLE: &str = include_str!("../../../motions/demo_ballbar.toml");
const CORNER: &str = include_str!("../../../motions/demo_corner.toml");

const BACKLASH: &str = "\n[[axis.x.effect]]\nname = \"backlash\"\nwidth_um = 12.0\n";

/// The log of a motion, and its path by the blocks.
fn run(effects: &str, motion: &str, seed: u64) -> (Log, NominalPath) {
    let machine = Machine::parse(&format!("{DEMO_MACHINE}{effects}"), "demo.toml").unwrap();
    let path = MachinePath::new(&Motion::parse(motion, "motion.toml").unwrap(), &machine, "motion.toml").unwrap();
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

/// Backlash of width w alone has G = w (see `lost_motion_is_a_step_without_peaks`). G is the range of a linear function of
/// the deviation, so that G of both is within w ± that of the machine without it; 0.5 µm for what the loop makes of it.
#[test]
fn backlash_adds_its_width_to_the_circular_deviation() {
    let (without, with) = (error("", CIRCLE, 1), error(BACKLASH, CIRCLE, 1));
    let [g, g_with] = [&without, &with].map(|error| error.circles[0].circular_um());
    eprintln!("{}", crate::text::of(&without, files::log::Channel::Tool, &["x".into(),"y".into()]));
    eprintln!("{}", crate::text::of(&with, files::log::Channel::Tool, &["x".into(),"y".into()]));
    assert!(g < 6.0, "{g}");
    assert_near(g_with, 12.0, g + 0.5);
    assert!(is_worse(&without, &with) && is_better(&with, &without));
    // Half of it is on either side, and the mean of cos² over a circle is 1/2.
    let added = (with.rms_um.powi(2) - without.rms_um.powi(2)).sqrt();
    assert_near(added, 6.0 / f64::sqrt(2.0), 1.5);
}

#[test]
fn another_seed_of_the_noise_is_no_change() {
    for effects in ["", BACKLASH] {
        let (one, other) = (error(effects, CIRCLE, 1), error(effects, CIRCLE, 2));
        assert!(!is_worse(&one, &other) && !is_better(&one, &other), "{} {}", one.rms_um, other.rms_um);
    }
}
