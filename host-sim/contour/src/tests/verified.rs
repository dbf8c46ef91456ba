//! Pairs of logs and predictions.

use super::{SAMPLE_S, assert_near};
use crate::verification::{Change, Commanded, Found, Prediction, Predictions, VerifiedMotion, pairs};
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
    Log::new(source, 0.0, SAMPLE_S, [axis("x", 0), axis("y", 1)])
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
        ..Prediction::default()
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
    let found = |name: &str, length_mm| {
        let command = Commanded { length_mm, ..Commanded::default() };
        matches!(predictions.of_motion([name, "other.csv"], &command), Found::Comparable(_))
    };
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

/// White noise of a probe along both axes of a log, µm.
fn with_noise(mut log: Log, sigma_um: f64, seed: u64) -> Log {
    use rand::SeedableRng;
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    for axis in &mut log.axes {
        for mm in axis.tool.iter_mut().flatten() {
            *mm += 1e-3 * sigma_um * numerics::noise::box_muller(&mut random);
        }
    }
    log
}

/// An offset of 2.5 µm with a probe of 10 µm before: of 20,000 samples the mean square less the noise, 6.25 µm², has a standard
/// error of √((4·6.25·100 + 2.62·10⁴)/20000) = 1.2 µm². The same offset is unchanged whatever the probe after; 60 % more, 16 µm²,
/// are 9.75 µm² more, five standard errors of the difference with the same probe. With its noise, the machine that is the same
/// would have 10.3 µm before and 2.5 µm after, and one that is 60 % worse 10.8 µm, 4.5 % more.
#[test]
fn the_noise_of_the_probe_is_neither_a_gain_nor_a_cover() {
    let change = |after_um, sigma_um: [f64; 2], seed| {
        let log = |name, um, sigma_um, seed| with_noise(line(name, 20_000, [0.6, 0.8], um), sigma_um, seed);
        let (before, after) = (log("a", 2.5, sigma_um[0], seed), log("b", after_um, sigma_um[1], 100 + seed));
        VerifiedMotion::new(&before, &after, &Predictions::default()).unwrap()
    };
    // Of 20 seeds, one or two are beyond two standard errors by chance if nothing changed.
    let count = |after_um, sigma_um, wanted| {
        (0..20).filter(|seed| change(after_um, sigma_um, *seed).change() == wanted).count()
    };
    for sigma_um in [[10.0, 10.0], [10.0, 0.08], [0.08, 10.0]] {
        let unchanged = count(2.5, sigma_um, Change::Unchanged);
        assert!(unchanged >= 17, "{sigma_um:?}: {unchanged} of 20");
        let worse = count(4.0, sigma_um, Change::Worse);
        assert!(worse == 20, "{sigma_um:?}: {worse} of 20");
    }
    // The figures are those of the machine. Two standard errors of 2.5 µm: √(6.25 ± 2.4) µm.
    let verified = change(2.5, [10.0, 0.08], 3);
    let json = verified.json();
    let figure = |pointer: &str| json.pointer(pointer).and_then(serde_json::Value::as_f64).unwrap();
    assert_near(figure("/contour_error_um/before/rms"), 2.5, 0.55);
    assert_near(figure("/contour_error_um/after/rms"), 2.5, 0.01);
    assert_near(figure("/rms_with_noise_um/before"), 10.3, 0.3);
    assert_near(figure("/noise_um/before"), 10.0, 0.3);
}

/// Predicted without noise, measured with probes of other noise: 2 µm, once with 3 µm of noise, which is √13 = 3.6 µm together.
#[test]
fn a_prediction_holds_with_every_probe() {
    let before = line("some_line_before", 20_000, [0.6, 0.8], 6.0);
    for (after_um, sigma_um, holds) in
        [(2.0, 0.0, true), (2.0, 3.0, true), (3.0, 3.0, false), (1.0, 3.0, false)]
    {
        let after = with_noise(line("b", 20_000, [0.6, 0.8], after_um), sigma_um, 5);
        let verified = VerifiedMotion::new(&before, &after, &some_line()).unwrap();
        assert_eq!(verified.is_as_predicted(), Some(holds), "{after_um} {sigma_um}: {:?}", verified.rms_um());
    }
}

/// A prediction made for this command, for half of its feed, for its mirror image, and for the tool where only the motor is measured.
#[test]
fn a_prediction_of_another_motion_or_channel_is_not_compared() {
    let command = |steps, direction| {
        Commanded::of(&crate::LoggedMotion::of(&line("l", steps, direction, 0.0)).unwrap())
    };
    let predicted = |command: &Commanded| {
        Predictions(vec![Prediction {
            motion: "some line".to_owned(),
            after_um: 2.0,
            bound_percent: 10.0,
            path_length_mm: Some(command.length_mm),
            duration_s: Some(command.duration_s),
            points_mm: command.points_mm.clone(),
            ..Prediction::default()
        }])
    };
    let logs = || [6.0, 2.0].map(|um| line("some_line", 2000, [0.6, 0.8], um));
    let judged = |predictions: &Predictions, [before, after]: [Log; 2]| {
        let verified = VerifiedMotion::new(&before, &after, predictions).unwrap();
        (verified.is_as_predicted(), verified.not_comparable.unwrap_or_default())
    };
    assert_eq!(judged(&predicted(&command(2000, [0.6, 0.8])), logs()), (Some(true), String::new()));
    for (other, wanted) in [
        (
            command(4000, [0.6, 0.8]),
            "a path of 40.000 mm in 4.000 s, and the logs are of a path of 40.000 mm in 2.000 s",
        ),
        (command(2000, [0.8, 0.6]), "with other points, and the logs"),
    ] {
        let (is_as_predicted, why) = judged(&predicted(&other), logs());
        assert!(is_as_predicted.is_none() && why.contains(wanted), "{why}");
    }
    let at_motor = logs().map(|mut log| {
        log.axes.iter_mut().for_each(|axis| axis.motor = axis.tool.take());
        log
    });
    let (is_as_predicted, why) = judged(&predicted(&command(2000, [0.6, 0.8])), at_motor);
    assert_eq!((is_as_predicted, why.as_str()), (None, "it is of the tool, and the logs have the motor"));
    // Beyond the travel that the compensation is made for, nothing is known.
    let mut beyond = predicted(&command(2000, [0.6, 0.8]));
    beyond.0[0].beyond_mapped = vec!["x".to_owned()];
    assert_eq!(judged(&beyond, logs()), (None, String::new()));
}

/// Before the change the tool is 6 µm off the line, of which 4 µm are predicted; the other 2 µm are in the measured error after
/// the change, too: 1 + 2 = 3 µm, where 1 µm is predicted.
#[test]
fn a_displacement_that_no_model_has_is_in_the_prediction_as_in_the_measured_error() {
    let left_um = |um: f64| [("x", -0.8 * um), ("y", 0.6 * um)];
    let both = left_um(4.0).into_iter().zip(left_um(1.0));
    let displacement_um =
        both.map(|((axis, before), (_, after))| (axis.to_owned(), [before, after])).collect();
    let prediction = Prediction { after_um: 1.0, displacement_um, ..some_line().0.remove(0) };
    for (after_um, holds) in [(3.0, true), (1.0, false)] {
        let [before, after] =
            [("some_line", 6.0), ("b", after_um)].map(|(name, um)| line(name, 2000, [0.6, 0.8], um));
        let predictions = Predictions(vec![prediction.clone()]);
        let verified = VerifiedMotion::new(&before, &after, &predictions).unwrap();
        assert_near(verified.rms_um()[1].unwrap(), 3.0, 0.02);
        assert_eq!(verified.is_as_predicted(), Some(holds));
    }
}

/// With 2 µm predicted and 3 µm unexplained, ±10 %: from 0.9·2 = 1.8 µm to 1.1·√(2² + 3²) = 3.97 µm.
#[test]
fn what_a_trace_left_unexplained_may_be_in_the_error() {
    let prediction = Prediction { after_um: 2.0, unexplained_um: 3.0, ..some_line().0.remove(0) };
    let predictions = Predictions(vec![prediction]);
    for (after_um, holds) in [(1.7, false), (1.9, true), (3.9, true), (4.1, false)] {
        let [before, after] =
            [("some_line", 6.0), ("b", after_um)].map(|(name, um)| line(name, 2000, [0.6, 0.8], um));
        let verified = VerifiedMotion::new(&before, &after, &predictions).unwrap();
        assert_eq!(verified.is_as_predicted(), Some(holds), "{after_um}");
    }
}

/// A full circle with the tool of x and y exchanged, or turned by 90°: the tool is on the circle, at another place. A lag of a sixth of
/// a turn, whose difference is as large as the radius, is the largest that passes.
#[test]
fn a_tool_that_does_not_follow_its_command_is_refused() {
    let log = |source: &str, of_tool: &dyn Fn(f64) -> [f64; 2]| {
        let angles: Vec<f64> =
            (0..4000).map(|i| std::f64::consts::TAU * f64::from(i - 500).max(0.0) / 3499.0).collect();
        let axis = |name: &str, i: usize| {
            let mut axis = AxisLog::new(name, Unit::Millimetre);
            axis.command = Some(angles.iter().map(|angle| 30.0 * [angle.cos(), angle.sin()][i]).collect());
            axis.tool = Some(angles.iter().map(|angle| 30.0 * of_tool(*angle)[i]).collect());
            axis
        };
        let axes = vec![axis("x", 0), axis("y", 1)];
        Log::new(source, 0.0, SAMPLE_S, axes)
    };
    let before = log("before", &|angle| [angle.cos(), angle.sin()]);
    let verified = |of_tool: &dyn Fn(f64) -> [f64; 2]| {
        VerifiedMotion::new(&before, &log("after", of_tool), &Predictions::default())
    };
    for wrong in [
        verified(&|angle| [angle.sin(), angle.cos()]),
        verified(&|angle| [-angle.sin(), angle.cos()]),
        verified(&|angle| [-angle.cos(), -angle.sin()]),
    ] {
        let message = wrong.unwrap_err().to_string();
        assert!(
            message.starts_with("after: expected the tool of x near its command, found a deviation of"),
            "{message}"
        );
    }
    assert!(verified(&|angle| [(angle - 0.9).cos(), (angle - 0.9).sin()]).is_ok());
}
