//! Regression tests on measured logs: the effects that are found, and the held-out error before and after.

use std::fs;
use std::path::{Path, PathBuf};

use crate::traces;
use files::log::{Log, Unit};
use friction_map::{FrictionMap, explain};
use model::effects::Stage;
use model::machine::Machine;
use tests::data::data_folder;
use tests::tables::{self, half_digit};
use trace::AxisIdentification;

/// The entries of a folder, sorted.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    entries
}

/// EMPS, the ball-screw axis of Janot, Gautier and Brunot (2019): the figures of `docs/results.md`.
///
/// The bounds are ±1 % of the figures: the fit is deterministic, and a larger change is one of the model, which must be
/// examined.
#[test]
fn the_trace_of_emps_matches_the_readme() {
    let Some(data) = data_folder("data/emps") else { return };
    let traced = traces::of_measured(&data, "train.csv");
    let trace = &traced.trace;
    let axis = &trace.axes()[0];
    let names: Vec<&str> = axis.found.iter().map(|found| found.effect.name()).collect();
    let expected = [
        "friction_asymmetry",
        "latency",
        "shear_thinning",
        "torque_ripple",
        "friction_map",
        "presliding",
        "position_load",
        "friction_ripple",
        "friction_memory",
        "torque_ripple",
        "velocity_lag",
    ];
    assert_eq!(names, expected);
    let first = |name: &str| {
        axis.found.iter().find(|found| found.effect.name() == name).unwrap().effect.parameters()[0].1
    };
    // The controller of this machine differentiates the mean of two samples, which is half a sample late: 0.5 ms. It
    // logs the force of the next sample, one sample early, to which the latency of the drive is added.
    assert!((0.4..0.65).contains(&first("velocity_lag")), "{}", first("velocity_lag"));
    assert!((-1.3..-1.0).contains(&first("latency")), "{}", first("latency"));

    let error = |stage| axis.residuals.iter().find(|error| error.stage == stage).unwrap();
    let near = |value: f64, figure: f64| (value / figure - 1.0).abs() < 0.01;
    let force = error(Stage::Force);
    assert!(near(force.before.validate, 2.596) && near(force.after.validate, 0.877), "{force:?}");
    let motor = error(Stage::Motor);
    assert!(near(motor.before.validate, 1.594) && near(motor.after.validate, 0.494), "{motor:?}");
    // The part that differs from lap to lap, which no model explains.
    let repeats = |stage| axis.repeats.iter().find(|part| part.stage == stage).unwrap();
    assert!((repeats(Stage::Force).period_s - 6.24).abs() < 1e-9);
    assert!(near(repeats(Stage::Force).non_repeatable, 0.522), "{:?}", axis.repeats);
    assert!(near(repeats(Stage::Motor).non_repeatable, 0.222), "{:?}", axis.repeats);
    assert_free_runs(axis);
    // The held-out error is that of the fit within 4 %: no over-fitting.
    for error in [force, motor] {
        assert!((error.after.validate / error.after.fit - 1.0).abs() < 0.04, "{error:?}");
    }
}

/// Without feedback: the figures of `docs/results.md`, ±1 % and half of their last digit.
fn assert_free_runs(axis: &AxisIdentification) {
    let rows = ["within 0.1 s", "within 0.5 s", "within 2 s", "over the whole lap"];
    assert_eq!(axis.free_runs.iter().map(|run| run.seconds).collect::<Vec<_>>(), [0.1, 0.5, 2.0, 6.0]);
    for (run, row) in axis.free_runs.iter().zip(rows) {
        for (found_um, (figure_um, half_digit_um)) in
            [run.declared, run.after].into_iter().zip(printed_um(row))
        {
            let within_um = 0.01 * figure_um + half_digit_um;
            assert!(
                (found_um - figure_um).abs() < within_um,
                "{row}: {found_um} µm, {figure_um} ± {within_um} µm in docs/results.md"
            );
        }
    }
}

/// The two figures of a row of the table of free runs in `docs/results.md`, and half of the last digit of each, µm.
fn printed_um(row: &str) -> [(f64, f64); 2] {
    let rows = tables::rows("results.md", "| | declared model | with the effects found |");
    let rows: Vec<&Vec<String>> = rows.iter().filter(|cells| cells[0].contains(row)).collect();
    let [cells] = rows[..] else { panic!("{row}: {rows:?}") };
    let um = |cell: &str| {
        let (number, unit) = cell.split_once(' ').unwrap();
        let factor = match unit {
            "µm" => 1.0,
            "mm" => 1000.0,
            _ => panic!("{cells:?}"),
        };
        (factor * number.parse::<f64>().unwrap(), factor * half_digit(number))
    };
    [um(&cells[1]), um(&cells[2])]
}

/// Samples of a lap of the reference, 6.24 s.
const LAP: usize = 6240;

/// Mean of the force of a lap minus that of the other laps, N, and the position error that this difference makes in a rigid axis of the published
/// mass and friction, µm rms: m·v' + b·v = ΔF from rest. The motor repeats the lap within 0.3 µm, so that its own difference needs no force.
fn difference_of_lap(force_n: &[f64], lap: usize) -> [f64; 2] {
    let of_lap = |lap: usize, i: usize| force_n[lap * LAP + i];
    // The last lap lacks 119 samples.
    let difference = |i: usize| {
        of_lap(lap, i) - (0..4).filter(|&other| other != lap).map(|other| of_lap(other, i)).sum::<f64>() / 3.0
    };
    let samples = force_n.len() - 3 * LAP;
    let (mut v, mut x) = (0.0, 0.0);
    let step = |i: usize| {
        v += 1e-3 * (difference(i) - 203.5 * v) / 95.1;
        x += 1e-3 * v;
        1e6 * x
    };
    let rms_um = numerics::rms((0..samples).map(step));
    [(0..samples).map(difference).sum::<f64>() / samples as f64, rms_um]
}

/// No model of the motion alone can predict the last lap without feedback to a third of the declared model's error: `docs/results.md`.
#[test]
fn the_force_of_emps_changes_from_lap_to_lap_by_more_than_a_free_run_allows() {
    let Some(data) = data_folder("data/emps") else { return };
    let log = Log::read(&data.join("train.csv")).unwrap();
    let force_n = log.axes[0].force.as_ref().unwrap();
    let rows = tables::rows(
        "results.md",
        "| lap | its force minus that of the other three laps, mean over the lap | the same, integrated: position error, rms |",
    );
    assert_eq!(rows.len(), 4);
    for (lap, cells) in rows.iter().enumerate() {
        let [mean_n, rms_um] = difference_of_lap(force_n, lap);
        let printed = |cell: &str| cell.split_once(' ').unwrap().0.replace('−', "-").parse::<f64>().unwrap();
        assert!((mean_n - printed(&cells[1])).abs() < 0.005, "lap {lap}: {mean_n} N");
        assert!((1e-3 * rms_um - printed(&cells[2])).abs() < 0.05, "lap {lap}: {rms_um} µm");
        // A third of 2.9 mm.
        assert!(rms_um > 970.0, "lap {lap}: {rms_um} µm");
    }
}

/// With the correct latency of the force no Stribeck effect is found: friction falls towards standstill.
#[test]
fn emps_has_no_stribeck_effect() {
    let Some(data) = data_folder("data/emps") else { return };
    let traced = traces::of_measured(&data, "train.csv");
    let trace = &traced.trace;
    let tried = trace.axes()[0].rounds.iter().flat_map(|round| &round.candidates);
    let stribeck: Vec<_> = tried.filter(|c| c.effect.name() == "stribeck" && c.fitted.is_some()).collect();
    assert!(!stribeck.is_empty(), "expected the Stribeck effect among the candidates");
    let options = &trace.options().search;
    assert!(stribeck.iter().all(|c| !c.is_consistent(options)), "{stribeck:?}");
}

/// A robot without a declared controller or mass: the stages that cannot be tested are listed.
#[test]
fn stages_that_cannot_be_tested_are_listed() {
    let Some(data) = data_folder("data/kuka") else { return };
    let traced = traces::of_measured(&data, "recording_a.csv");
    let trace = &traced.trace;
    for axis in trace.axes() {
        let stages: Vec<Stage> = axis.not_testable.iter().map(|n| n.stage).collect();
        assert_eq!(stages, [Stage::Motor, Stage::Tool, Stage::Force], "{}", axis.axis);
        assert_eq!(axis.residuals.len(), 1);
    }
}

#[test]
fn measured_logs_and_cases_can_be_read() {
    let (Some(data), Some(cases)) = (data_folder("data"), data_folder("cases")) else { return };
    let emps = Log::read(&data.join("emps/train.csv")).unwrap();
    assert_eq!((emps.len(), emps.axes.len()), (24_841, 1));
    assert!((emps.sample_time_s - 1e-3).abs() < 1e-12);
    let kuka = Log::read(&data.join("kuka/recording_a.csv")).unwrap();
    assert_eq!((kuka.axes.len(), kuka.axes[2].unit), (3, Unit::Degree));
    assert!((kuka.sample_time_s - 4e-3).abs() < 1e-12);
    let mut count = 0;
    for file in entries(&cases).iter().flat_map(|folder| entries(folder)) {
        if file.extension().is_some_and(|suffix| suffix == "gz") {
            let log = Log::read(&file).unwrap();
            assert_eq!(log.axes.len(), 2);
            assert!((log.sample_time_s - 1e-3).abs() < 1e-9, "{}", file.display());
            count += 1;
        }
    }
    assert!(count > 0, "no log in {}", cases.display());
}

#[test]
fn declared_machines_survive_writing_and_reading() {
    let (Some(data), Some(cases)) = (data_folder("data"), data_folder("cases")) else { return };
    let folders = [entries(&data), entries(&cases)].concat();
    let files = folders.iter().map(|folder| folder.join("machine.toml"));
    let files: Vec<PathBuf> = files.filter(|file| file.exists()).collect();
    assert!(files.len() >= 11, "EMPS, KUKA and nine cases at least: {files:?}");
    for file in files {
        let machine = Machine::read(&file).unwrap();
        assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
    }
}

/// The friction map of a lead screw (Mablekos-Alexiou, da Cruz and Bergeles, 2021), of which Coulomb and viscous
/// friction are declared. The bounds are ±2 % of the figures; the fit is deterministic.
#[test]
fn the_lead_screw_has_a_load_and_stribeck_friction() {
    let Some(data) = data_folder("data/leadscrew") else { return };
    let map = FrictionMap::read(&data.join("friction_drive1.csv")).unwrap();
    let explained = explain(&map).unwrap();
    let names: Vec<&str> = explained.selection.fitted.law.terms.iter().map(|term| term.name()).collect();
    assert_eq!(names, ["constant_load", "stribeck"]);
    let near = |value: f64, figure: f64| (value / figure - 1.0).abs() < 0.02;
    let (before, after) = (explained.before, explained.after);
    assert!(near(before.left_out, 0.4110) && near(after.left_out, 0.0459), "{before:?} {after:?}");
    assert!(
        near(before.ranges_left_out, 0.4913) && near(after.ranges_left_out, 0.0974),
        "{before:?} {after:?}"
    );
    assert!(near(map.standard_error().unwrap(), 0.01529));
    // Friction in the slowest runs of the map, the sum of Coulomb and Stribeck friction, is (3.56 + 2.77)/2 mN·m.
    let sizes = &explained.selection.fitted.law.sizes;
    assert!((sizes[0] + sizes[3] - 3.16).abs() < 0.1, "{sizes:?}");
    // Half of the difference between the directions there: (2.77 − 3.56)/2.
    assert!((sizes[2] + 0.39).abs() < 0.06, "{sizes:?}");
}

/// A robot with two encoders per axis (TU Kaiserslautern): latency, ratio and wind-up in a short recording. The bounds
/// are ±1 % of the figures, which `docs/tracing.md` prints: the fit is deterministic.
#[test]
fn the_robot_has_latency_and_windup() {
    let Some(data) = data_folder("data/kuka") else { return };
    let traced = traces::of_measured(&data, "recording_a.csv");
    let trace = &traced.trace;
    let names = |i: usize| trace.axes()[i].found.iter().map(|found| found.effect.name()).collect::<Vec<_>>();
    assert_eq!(names(0), ["latency", "pitch_progressive", "windup"]);
    assert_eq!(names(1), ["latency"]);
    assert_eq!(names(2), ["latency", "windup"]);
    let near = |value: f64, figure: f64| (value / figure - 1.0).abs() < 0.01;
    let held_out = [(9.996, 2.554), (14.552, 5.052), (8.073, 2.394)];
    for (axis, (before, after)) in trace.axes().iter().zip(held_out) {
        let error = &axis.residuals[0];
        assert!(near(error.before.validate, before) && near(error.after.validate, after), "{error:?}");
        // One bus reads all three axes: the same latency of 3 ms, within the uncertainty from wind-up.
        let latency_ms = axis.found[0].effect.parameters()[0].1;
        assert!((2.8..3.2).contains(&latency_ms), "{latency_ms}");
    }
}
