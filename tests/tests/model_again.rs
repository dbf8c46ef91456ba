//! The machine file that a trace writes gives, traced again on the same logs, the residual that the trace promised, and
//! stays where it is.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;

use files::log::Log;
use model::machine::Machine;
use studies::demo;
use tests::{cases, data};
use trace::fit::fit_data::Pair;
use trace::outcome::StageError;
use trace::{Trace, trace};

/// Share by which a residual may differ: the fits end when a step brings less than a ten-thousandth of Σr², and the
/// trace's own error is known to two per mille of the residual.
const SAME: f64 = 0.02;

/// All residuals of a trace with their names.
fn residuals(trace: &Trace, of: fn(&StageError) -> Pair) -> Vec<(String, f64)> {
    let of_axis = |axis: &trace::outcome::AxisTrace| {
        let of_stage = |error: &StageError| {
            let Pair { fit, validate } = of(error);
            [("fit", fit), ("validate", validate)]
                .map(|(logs, value)| (format!("{} {:?} {logs}", axis.axis, error.stage), value))
        };
        axis.errors.iter().flat_map(of_stage).collect::<Vec<_>>()
    };
    trace.axes.iter().flat_map(of_axis).collect()
}

/// Traces, writes the model, traces from there, and once more.
fn assert_stays(name: &str, machine: &Machine, fit: &[Log], validate: &[Log]) {
    let mut last = trace(machine, fit, validate, &|_| {}).unwrap();
    for round in ["second", "third"] {
        let text = last.better_machine().to_toml();
        let again = Machine::parse(&text, "better.toml").unwrap();
        assert_eq!(again, last.better_machine(), "{name}: the file is the model");
        let next = trace(&again, fit, validate, &|_| {}).unwrap();
        let found: Vec<_> = next.axes.iter().flat_map(|axis| &axis.found).collect();
        assert!(found.is_empty(), "{name}, {round}: {found:?}");
        let promised = residuals(&last, |error| error.after);
        let given = residuals(&next, |error| error.before);
        assert_eq!(promised.len(), given.len());
        for ((what, promised), (_, given)) in promised.iter().zip(&given) {
            assert!((given / promised - 1.0).abs() < SAME, "{name}, {round}: {what}: {promised} -> {given}");
        }
        last = next;
    }
}

/// Machines with one effect each, a backlash among them: no loop is as sensitive as one with a gap.
#[test]
fn a_model_of_the_demo_stays_where_it_is() {
    let mut names = Vec::new();
    for seed in [2, 3, 8, 16] {
        let declared = Machine::parse(demo::MACHINE, "demo.toml").unwrap();
        let drawn = demo::draw(&declared, seed);
        names.push(drawn.effect.name());
        let [fit, validate] = demo::logs(&drawn.truth, seed).unwrap();
        assert_stays(&format!("seed {seed}"), &declared, &fit, &validate);
    }
    assert!(names.contains(&"backlash"), "{names:?}");
}

fn logs(folder: &Path, kind: &str) -> Vec<Log> {
    cases::logs(folder, kind).iter().map(|path| Log::read(path).unwrap()).collect()
}

#[test]
fn a_model_of_a_case_stays_where_it_is() {
    let Some(folders) = cases::folders() else { return };
    for folder in folders {
        let machine = Machine::read(&folder.join("machine.toml")).unwrap();
        let name = folder.display().to_string();
        assert_stays(&name, &machine, &logs(&folder, "fit_"), &logs(&folder, "validate_"));
    }
}

#[test]
fn a_model_of_measured_data_stays_where_it_is() {
    let (Some(emps), Some(kuka)) = (data("data/emps"), data("data/kuka")) else { return };
    for (folder, log) in [(emps, "train.csv"), (kuka, "recording_a.csv")] {
        let machine = Machine::read(&folder.join("machine.toml")).unwrap();
        let log = Log::read(&folder.join(log)).unwrap();
        assert_stays(&folder.display().to_string(), &machine, &[log], &[]);
    }
}
