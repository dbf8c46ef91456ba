//! Motions that turn, stop and creep do not become worse with a compensation that is planned on others.

use commissioning::compensate::controller_host::ControllerHost;
use commissioning::compensate::planning::Planning;
use commissioning::compensate::prediction::{self, TestMotion};
use commissioning::compensate::{CompensationFile, Plan, standard_motions};
use contour::LoggedMotion;
use model::machine::Machine;
use plant::instruments::Instruments;

use super::runs::{circle, machine, motion, with};

const DEMO: &str = include_str!("../../../../host-sim/machines/demo.toml");
const CENTRE: &str = include_str!("../../../../host-sim/machines/vmc.toml");
const REVERSALS: &str = include_str!("../../../../host-sim/motions/reversals.toml");
const STEPS: &str = include_str!("../../../../host-sim/motions/steps.toml");
const POCKET: &str = include_str!("../../../../host-sim/motions/pocket.toml");

/// The compensation of a machine for motions, with typical instruments and the standard motions.
fn planned(model: &Machine, tests: &[TestMotion]) -> Plan {
    let watched = standard_motions::all(model, tests, 0.0).unwrap();
    let instruments = Instruments::of(model, 1);
    let planning =
        Planning { model, model_file: "machine.toml", tests, watched: &watched, instruments, set_at_s: 0.0 };
    planning.plan().unwrap()
}

/// Contour error without noise, µm rms, with a seed that the plan has not seen.
fn error_um(machine: &Machine, file: &CompensationFile, text: &str) -> f64 {
    let instruments = Instruments::of(machine, 77);
    let log =
        prediction::log(machine, file, &motion(text, 0.0), (instruments, ControllerHost::Host)).unwrap();
    LoggedMotion::of(&log).unwrap().contour_error().unwrap().rms_without_noise_um()
}

/// Planned on a circle and corners alone, the reversals of these machines went from 0.17 to 0.47 and from 0.36 to 0.56 µm, as a
/// velocity feed-forward of 100 % overshoots the stops, and the stretch that friction causes falls at rest. With the standard
/// motions, the shipped ones, which are others, become at most 5 % worse, as `verify` permits; the circle keeps most of its gain
/// (4.5 and 8.2 µm before: friction peaks and the lag of the loops).
#[test]
fn reversals_and_steps_do_not_become_worse_and_the_circle_better() {
    let of = |name: &str| {
        let folder =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("host-sim").join("motions");
        std::fs::read_to_string(folder.join(name)).unwrap()
    };
    let (large, corner) = (of("circle.toml"), of("corner.toml"));
    for text in [DEMO, CENTRE] {
        let machine = machine(text);
        let plan = planned(&machine, &[motion(&large, 0.0), motion(&corner, 0.0)]);
        let none = CompensationFile::none(&machine);
        for watched in [REVERSALS, STEPS, POCKET] {
            let [before, after] = [&none, &plan.file].map(|file| error_um(&machine, file, watched));
            assert!(before > 0.1 && after < 1.05 * before, "{}: {before} {after}", machine.name);
        }
        let [before, after] = [&none, &plan.file].map(|file| error_um(&machine, file, &large));
        assert!(before > 4.0 && after < 0.12 * before, "{}: {before} {after}", machine.name);
        assert!(
            plan.watched.len() == 6 && plan.watched.iter().all(|watched| !watched.is_worse),
            "{:?}",
            plan.watched
        );
    }
}

/// A tool that is displaced by 8 µm per m/s²: planned on a circle with limited jerk, the correction helps, but at the ramps of the
/// standard motions, whose acceleration jumps, it is a step itself. What a plan cannot do without most of its gain, it says: the
/// circle, 42 µm, becomes better by far more than the other motions become worse.
#[test]
fn the_planned_motions_keep_most_of_their_gain_and_what_is_worse_is_named() {
    let ramps = "acceleration_m_per_s2 = 1.0\nramps = \"s-curve\"\njerk_m_per_s3 = 10.0";
    let test = motion(&circle(100.0, ramps, 0.0), 0.0);
    let machine = machine(&with(DEMO, "name = \"intalk\"\num_s2_per_m = 8.0"));
    let plan = planned(&machine, std::slice::from_ref(&test));
    let planned = &plan.file.predicted[0];
    // At most a quarter of the gain is given up.
    assert!(planned.before_um > 20.0 && planned.after_um < 0.3 * planned.before_um, "{planned:?}");
    for watched in &plan.watched {
        let is_worse = watched.after_um > 1.02 * watched.before_um;
        assert_eq!(watched.is_worse, is_worse, "{watched:?}");
    }
    let text = commissioning::compensate::text::of(&plan);
    assert_eq!(
        text.matches("worse: not planned for").count(),
        plan.watched.iter().filter(|w| w.is_worse).count()
    );
}
