//! A trace that starts from the model of another one, on the same logs, has the residuals that the first one reported
//! and finds nothing new.

use std::path::Path;

use crate::traces::{self, Traced};
use files::log::Log;
use model::machine::Machine;
use tests::cases;
use tests::data::data_folder;
use trace::fit::fit_data::FitAndValidationRms;
use trace::judge::StageResidual;
use trace::{Identification, trace};

/// Relative tolerance of a residual: fits end when a step reduces Σr² by less than 1e-4, and the bias of the model is
/// known to two per mille of the residual.
const TOLERANCE: f64 = 0.02;

/// All residuals of a trace, by name.
fn residuals(trace: &Identification, of: fn(&StageResidual) -> FitAndValidationRms) -> Vec<(String, f64)> {
    let of_axis = |axis: &trace::AxisIdentification| {
        let of_stage = |error: &StageResidual| {
            let FitAndValidationRms { fit, validate } = of(error);
            [("fit", fit), ("validate", validate)]
                .map(|(logs, value)| (format!("{} {:?} {logs}", axis.axis, error.stage), value))
        };
        axis.residuals.iter().flat_map(of_stage).collect::<Vec<_>>()
    };
    trace.axes().iter().flat_map(of_axis).collect()
}

/// Asserts that a second and a third trace, each from the model of the one before, change nothing.
fn assert_is_stable(name: &str, first: &Identification, fit: &[Log], validate: &[Log]) {
    let mut last: Option<Identification> = None;
    for round in ["second", "third"] {
        let previous = last.as_ref().unwrap_or(first);
        let text = previous.better_machine().to_toml();
        let again = Machine::parse(&text, "better.toml").unwrap();
        assert_eq!(again, previous.better_machine(), "{name}: the file is the model");
        let next = trace(&again, fit, validate, &|_| {}).unwrap();
        let found: Vec<_> = next.axes().iter().flat_map(|axis| &axis.found).collect();
        assert!(found.is_empty(), "{name}, {round}: {found:?}");
        let reported = residuals(previous, |error| error.after);
        let given = residuals(&next, |error| error.before);
        assert_eq!(reported.len(), given.len());
        for ((what, reported), (_, given)) in reported.iter().zip(&given) {
            assert!(
                (given / reported - 1.0).abs() < TOLERANCE,
                "{name}, {round}: {what}: {reported} -> {given}"
            );
        }
        last = Some(next);
    }
}

/// Machines with one effect each, among them backlash, to which a loop is most sensitive.
#[test]
fn a_model_of_the_demo_is_stable() {
    let mut names = Vec::new();
    for seed in [2, 3, 8, 16] {
        let declared = Machine::parse(demo::MACHINE, "demo.toml").unwrap();
        let drawn = demo::draw(&declared, seed);
        names.push(drawn.effect.name());
        let [fit, validate] = demo::logs(&drawn.truth, seed).unwrap();
        let first = trace(&declared, &fit, &validate, &|_| {}).unwrap();
        assert_is_stable(&format!("seed {seed}"), &first, &fit, &validate);
    }
    assert!(names.contains(&"backlash"), "{names:?}");
}

fn assert_is_stable_on(folder: &Path, traced: &Traced) {
    assert_is_stable(&folder.display().to_string(), &traced.trace, &traced.fit, &traced.validate);
}

#[test]
fn a_model_of_a_case_is_stable() {
    let Some(folders) = cases::folders() else { return };
    for folder in folders {
        assert_is_stable_on(&folder, &traces::of_case(&folder));
    }
}

#[test]
fn a_model_of_measured_data_is_stable() {
    let (Some(emps), Some(kuka)) = (data_folder("data/emps"), data_folder("data/kuka")) else { return };
    for (folder, log) in [(emps, "train.csv"), (kuka, "recording_a.csv")] {
        assert_is_stable_on(&folder, &traces::of_measured(&folder, log));
    }
}
