//! The measured axis of `LOST_MOTION_DATA`, if that is set.

#![expect(clippy::unwrap_used, reason = "in a test, a value that is not there is the failure")]

use std::io::Write;

use positions::columns::Request;
use positions::measured::Test;
use positions::source::Feedback;
use positions::{Analysis, Options, analyse, readings};

/// The runs of x.csv of which the number is in a text; `None` where the data are not there.
fn runs(numbers: &str) -> Option<Test> {
    let Some(root) = std::env::var_os("LOST_MOTION_DATA") else {
        let _ = writeln!(
            std::io::stderr(),
            "SKIPPED: LOST_MOTION_DATA does not name the folder that holds data/positioning"
        );
        return None;
    };
    let path = std::path::Path::new(&root).join("data/positioning/x.csv");
    let all = std::fs::read_to_string(path).unwrap();
    let is =
        |line: &&str| line.starts_with("run") || line.chars().next().is_some_and(|run| numbers.contains(run));
    let lines: Vec<&str> = all.lines().filter(is).collect();
    Some(readings::of_text(&lines.join("\n"), "x.csv", &Request::default(), Vec::new()).unwrap())
}

fn analysed(fit: &str, validate: &str) -> Option<Analysis> {
    let options = Options { axis: "x".to_owned(), feedback: Feedback::Motor };
    Some(analyse(runs(fit)?, vec![runs(validate)?], &options).unwrap())
}

/// The report of the source prints B 33.58, M 93.65 and A 135.26 µm, and R 28.31 and E 90.65 µm, which are the R↑ and E↑ of the definitions.
#[test]
fn figures_are_those_of_the_definitions() {
    let Some(test) = runs("12345") else { return };
    let (found, notes) = positions::iso::figures(&positions::iso::positions(&test));
    for (value, expected) in [
        (found.accuracy, 135.26),
        (found.mean_range, 93.65),
        (found.reversal, 33.58),
        (found.repeatability, 55.16),
        (found.systematic, 122.85),
        (found.repeatability_positive, 28.31),
        (found.systematic_positive, 90.65),
    ] {
        assert!((value.unwrap() - expected).abs() < 0.006, "{value:?} {expected}");
    }
    assert!(notes.is_empty(), "{notes:?}");
}

/// Fitted on runs 1 to 3, runs 4 and 5: 33.2 µm as measured, 4.8 by a table.
#[test]
fn runs_that_were_not_fitted_are_predicted() {
    let Some(analysis) = analysed("123", "45") else { return };
    let residual = analysis.residual;
    let [before, table, after] =
        [residual.before, residual.table, residual.after].map(|of| of.validate.unwrap());
    assert!((before - 33.2).abs() < 0.05 && (table - 4.82).abs() < 0.05, "{residual:?}");
    assert!(after < 2.6, "{after} {:?} {:?} {residual:?}", analysis.fit.variant, analysis.grid.course);
    let names: Vec<&str> = analysis.effects.iter().map(|effect| effect.name).collect();
    for name in ["pitch_map", "backlash", "drift_map", "thermal_drift"] {
        assert!(names.contains(&name), "{names:?}");
    }
}
