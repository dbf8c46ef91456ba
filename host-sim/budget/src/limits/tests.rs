use contour::ContourError;
use contour::across::Across;
use contour::log_error::LogError;
use files::log::Channel;

use super::*;
use crate::of_motion::MotionBudget;
use crate::sizes::Sizes;

fn log(name: &str, channel: Channel, [rms_um, max_um, noise_um]: [f64; 3]) -> LogError {
    let error = ContourError {
        max_um,
        rms_um,
        samples: 10_000,
        noise_um,
        across: Across::default(),
        blocks: Vec::new(),
        corners: Vec::new(),
        circles: Vec::new(),
        is_along_axis: false,
    };
    LogError { log: name.to_owned(), axes: vec!["x".to_owned(), "y".to_owned()], channel, error }
}

fn motion(name: &str, rms: f64, circular: Option<f64>) -> MotionBudget {
    let whole = Sizes { rms, max: 2.0 * rms, circular, corner: None };
    MotionBudget {
        name: name.to_owned(),
        whole,
        compensated: None,
        not_compensated: None,
        circle: None,
        causes: Vec::new(),
        shared_in_proportion: 0.0,
    }
}

fn outcome(limit: &str, by: &Judged<'_>) -> (Outcome, Basis, Option<f64>) {
    let judgement = judged(&[limit.parse().unwrap()], by).remove(0);
    assert_eq!(judgement.result == Outcome::Unknown, !judgement.why.is_empty(), "{judgement}");
    (judgement.result, judgement.basis, judgement.value_um)
}

#[test]
fn a_limit_is_a_figure_and_its_micrometres() {
    assert_eq!("G=8".parse(), Ok(Limit { figure: Figure::Circular, um: 8.0 }));
    for figure in Figure::ALL {
        assert_eq!(format!("{}=0.5", figure.name()).parse(), Ok(Limit { figure, um: 0.5 }));
    }
    for bad in ["", "G", "G=", "g=8", "H=8", "G=0", "G=-1", "G=NaN", "G=inf", "G=8µm", "=8"] {
        let message = bad.parse::<Limit>().unwrap_err();
        assert!(
            message.contains("expected NAME=µm") && message.contains("G, rms, greatest, corner"),
            "{bad}"
        );
    }
}

#[test]
fn the_worst_log_of_the_tool_decides() {
    let logs = [
        log("a", Channel::Tool, [2.0, 6.0, 0.0]),
        log("b", Channel::Tool, [3.0, 5.0, 0.0]),
        log("c", Channel::Motor, [90.0; 3]),
    ];
    let by =
        Judged { logs: &logs, faulty: &[], motions: &[motion("circle", 50.0, None)], trust: Trust::Whole };
    assert_eq!(outcome("rms=3", &by), (Outcome::Pass, Basis::Measured, Some(3.0)));
    assert_eq!(outcome("rms=2.5", &by), (Outcome::Fail, Basis::Measured, Some(3.0)));
    assert_eq!(outcome("greatest=5.5", &by), (Outcome::Fail, Basis::Measured, Some(6.0)));
    assert_eq!(outcome("corner=1", &by), (Outcome::Unknown, Basis::None, None));
    // A fault of the log makes its figure worth nothing, also where it would be a pass.
    let faulty = ["b".to_owned()];
    assert_eq!(outcome("rms=3", &Judged { faulty: &faulty, ..by.clone() }).0, Outcome::Unknown);
    // The other log is sound, and beyond the limit.
    assert_eq!(
        outcome("rms=1", &Judged { faulty: &faulty, ..by }),
        (Outcome::Fail, Basis::Measured, Some(2.0))
    );
}

#[test]
fn noise_makes_no_failure() {
    // Without its noise, the rms is 3 µm.
    let logs = [log("a", Channel::Tool, [5.0, 20.0, 4.0])];
    let by = Judged { logs: &logs, faulty: &[], motions: &[], trust: Trust::Whole };
    assert_eq!(outcome("rms=2.9", &by).0, Outcome::Fail);
    assert_eq!(outcome("rms=3.1", &by).0, Outcome::Unknown);
    assert_eq!(outcome("rms=5", &by).0, Outcome::Pass);
    assert_eq!(outcome("greatest=3", &by).0, Outcome::Fail);
    assert_eq!(outcome("greatest=5", &by).0, Outcome::Unknown);
}

#[test]
fn an_axis_alone_has_no_contour() {
    let mut logs = [log("a", Channel::Tool, [2.0, 6.0, 0.0])];
    logs[0].error.is_along_axis = true;
    let by = Judged { logs: &logs, faulty: &[], motions: &[], trust: Trust::Whole };
    assert_eq!(outcome("rms=100", &by).0, Outcome::Unknown);
}

#[test]
fn a_prediction_passes_only_if_nothing_can_come_on_top() {
    let motions = [motion("circle", 10.0, Some(20.0)), motion("part", 12.0, None)];
    let by = |trust: Trust| Judged { logs: &[], faulty: &[], motions: &motions, trust };
    let why = || "because".to_owned();
    // The interval of the simulation alone: 5 %.
    for (limit, whole, at_least) in [
        ("G=21.1", Outcome::Pass, Outcome::Unknown),
        ("G=20.9", Outcome::Unknown, Outcome::Unknown),
        ("G=19.1", Outcome::Unknown, Outcome::Unknown),
        ("G=18.9", Outcome::Fail, Outcome::Fail),
    ] {
        assert_eq!(outcome(limit, &by(Trust::Whole)), (whole, Basis::Predicted, Some(20.0)), "{limit}");
        assert_eq!(outcome(limit, &by(Trust::AtLeast(why()))).0, at_least, "{limit}");
        assert_eq!(outcome(limit, &by(Trust::None(why()))).0, Outcome::Unknown, "{limit}");
    }
    assert_eq!(outcome("rms=11", &by(Trust::Whole)), (Outcome::Fail, Basis::Predicted, Some(12.0)));
}

#[test]
fn a_limit_says_what_it_is_judged_by() {
    let logs = [log("a", Channel::Tool, [3.0, 6.0, 0.0])];
    let motions = [motion("circle", 10.0, Some(20.0))];
    let by = Judged { logs: &logs, faulty: &[], motions: &motions, trust: Trust::Whole };
    let limits = ["rms=2", "G=30", "corner=5"].map(|text| text.parse().unwrap());
    let judgements = judged(&limits, &by);
    let said: Vec<String> = judgements.iter().map(ToString::to_string).collect();
    assert_eq!(said[0], "Limit rms 2.00 µm: fail; 3.00 µm, measured at the tool in a.");
    assert_eq!(
        said[1],
        "Limit G 30.0 µm: pass; 20.0 ± 1.0 µm, predicted by the model for the standard motion circle."
    );
    assert_eq!(
        said[2],
        "Limit corner 5.00 µm: unknown; no log of the tool has a corner, and no budget predicts it."
    );
    assert_eq!(
        summary(&judgements).as_deref(),
        Some("beyond the limit: rms; not known whether within the limit: corner; within the limit: G")
    );
    assert_eq!(summary(&[]), None);
}
