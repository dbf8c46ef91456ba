//! Pairs of logs and predictions.

use super::{SAMPLE_S, assert_near};
use crate::verification::{Change, Prediction, Predictions, VerifiedMotion, pairs};
use files::log::{AxisLog, Channel, Log, Unit};

/// A log of a line of 40 mm with a constant offset of the tool across it, after 0.4 s of standstill. `steps` is its
/// duration in ms.
fn line(source: &str, steps: u32, direction: [f64; 2], offset_um: f64) -> Log {
    let fractions = (0..400).map(|_| 0.0).chain((0..=steps).map(|k| f64::from(k) / f64::from(steps)));
    let fractions: Vec<f64> = fractions.collect();
    let axis = |name: &str, i: usize| {
        let across = [-direction[1], direction[0]][i];
        let command: Vec<f64> = fractions.iter().map(|f| 40.0 * f * direction[i]).collect();
        let mut axis = AxisLog::new(name, Unit::Millimetre);
        axis.tool = Some(command.iter().map(|mm| mm + 1e-3 * offset_um * across).collect());
        axis.command = Some(command);
        axis
    };
    Log {
        source: source.to_owned(),
        start_s: 0.0,
        sample_time_s: SAMPLE_S,
        axes: vec![axis("x", 0), axis("y", 1)],
    }
}

fn some_line() -> Predictions {
    Predictions(vec![Prediction {
        motion: "some line".to_owned(),
        before_um: 6.0,
        after_um: 2.0,
        max_before_um: None,
        max_after_um: Some(3.0),
        circular_before_um: None,
        circular_after_um: None,
        bound_percent: 10.0,
        path_length_mm: Some(40.0),
    }])
}

fn verified(after_um: f64) -> VerifiedMotion {
    let predictions = some_line();
    let before = line("logs/some_line_before.csv", 2000, [0.6, 0.8], 6.0);
    let after = line("some-line-after.csv.gz", 2000, [0.6, 0.8], after_um);
    VerifiedMotion::new(&before, &after, &predictions).unwrap()
}

#[test]
fn a_change_and_its_prediction_are_judged() {
    // Within 5 % nothing is said; the bound is 10 % of the predicted 2 µm, as there is no noise.
    for (after_um, change, is_as_predicted) in [
        (2.19, Change::Better, true),
        (1.81, Change::Better, true),
        (2.21, Change::Better, false),
        (1.79, Change::Better, false),
        (5.75, Change::Unchanged, false),
        (6.25, Change::Unchanged, false),
        (6.35, Change::Worse, false),
    ] {
        let verified = verified(after_um);
        assert_eq!(
            (verified.change(), verified.is_as_predicted()),
            (change, Some(is_as_predicted)),
            "{after_um}"
        );
    }
}

#[test]
fn the_json_has_the_keys_of_the_contract() {
    let json = verified(2.0).json();
    assert_eq!(json["name"], "some line");
    let figure = |pointer: &str| json.pointer(pointer).and_then(serde_json::Value::as_f64).unwrap();
    for (pointer, expected) in [
        ("/contour_error_um/before/max", 6.0),
        ("/contour_error_um/before/rms", 6.0),
        ("/contour_error_um/predicted/max", 3.0),
        ("/contour_error_um/predicted/rms", 2.0),
        ("/contour_error_um/after/rms", 2.0),
    ] {
        assert_near(figure(pointer), expected, 1e-6);
    }
    assert!(json.get("circular_deviation_um").is_none(), "a line has none");
}

#[test]
fn a_prediction_belongs_to_its_motion_only() {
    let predictions = some_line();
    let found = |name: &str, length_mm| predictions.of_motion([name, "other.csv"], length_mm).is_some();
    for name in ["some line", "some_line.csv", "dir/before_some_line.csv.gz", "Some-Line.csv"] {
        assert!(found(name, 40.0), "{name}");
        assert!(!found(name, 41.0), "{name}: another path");
    }
    for name in ["line.csv", "awesome_line.csv", "some_line_2.csv"] {
        assert!(!found(name, 40.0), "{name}");
    }
}

#[test]
fn numbers_below_0_are_refused() {
    let Predictions(mut predictions) = some_line();
    assert_eq!(predictions[0].refused(), None);
    predictions[0].max_after_um = Some(-1e-9);
    assert_eq!(predictions[0].refused(), Some(("max_after_um", "a number of at least 0")));
    predictions[0].after_um = f64::NAN;
    assert_eq!(predictions[0].refused(), Some(("after_um", "a number of at least 0")));
}

#[test]
fn logs_are_paired_by_their_command() {
    let before = |name: &str, steps, direction| line(name, steps, direction, 1.0);
    let after = |name: &str, steps, direction| line(name, steps, direction, 2.0);
    let before =
        [before("a", 2000, [1.0, 0.0]), before("b", 2000, [0.6, 0.8]), before("c", 3000, [1.0, 0.0])];
    let after = [after("c2", 3000, [1.0, 0.0]), after("a2", 2000, [1.0, 0.0]), after("b2", 2000, [0.6, 0.8])];
    assert_eq!(pairs(&before, &after).unwrap(), [1, 2, 0]);
    let message = pairs(&before, &after[..2]).unwrap_err().to_string();
    assert!(message.starts_with("b: expected a log of the same motion"), "{message}");
    assert!(message.contains("c2, a2"), "{message}");
    let message = pairs(&before[..1], &after[..2]).unwrap_err().to_string();
    assert!(message.starts_with("c2: ") && message.ends_with("other motions in a"), "{message}");
    let again = line("a3", 2000, [1.0, 0.0], 3.0);
    let message = pairs(&before[..1], &[after[1].clone(), again]).unwrap_err().to_string();
    assert_eq!(
        message,
        "a3: expected one log before the change for each log of this motion, found only a, which another log is compared with"
    );
    let copy = Log { source: "copy".to_owned(), ..before[0].clone() };
    let message = pairs(&before[..1], &[copy]).unwrap_err().to_string();
    assert_eq!(message, "copy: expected another run of the motion, after the change, found the samples of a");
}

#[test]
fn what_a_log_lacks_is_named() {
    let before = line("a.csv", 2000, [1.0, 0.0], 1.0);
    let none = Predictions::default();
    let mut after = line("b.csv", 2000, [1.0, 0.0], 1.0);
    after.axes[1].command = None;
    let message = pairs(std::slice::from_ref(&before), std::slice::from_ref(&after)).unwrap_err().to_string();
    assert!(message.starts_with("b.csv: expected the command of each axis"), "{message}");
    let mut after = line("b.csv", 2000, [1.0, 0.0], 1.0);
    for axis in &mut after.axes {
        axis.motor = axis.tool.take();
    }
    let message = VerifiedMotion::new(&before, &after, &none).unwrap_err().to_string();
    assert!(
        message.starts_with("b.csv: expected a measured position of each axis that a.csv has"),
        "{message}"
    );
    after.axes[0].motor = None;
    let message = VerifiedMotion::new(&before, &after, &none).unwrap_err().to_string();
    assert!(
        message.starts_with("b.csv: expected a measured position of each axis (NAME_tool_mm"),
        "{message}"
    );
    let both_motors = |mut log: Log| {
        log.axes.iter_mut().for_each(|axis| axis.motor = axis.tool.clone());
        log
    };
    let (before, after) = (both_motors(before), both_motors(line("b.csv", 2000, [1.0, 0.0], 1.0)));
    assert_eq!(VerifiedMotion::new(&before, &after, &none).unwrap().channel, Channel::Tool);
}
