//! Channels that all logs lack, or some of them.

use std::collections::BTreeSet;

use files::log::Channel;
use trace::judge::found_effect::FoundEffect;
use trace::trace;

use super::case::{Case, certain};

/// The residuals of force and motor are fitted together where there is no table. The tool is no part of that fit: its effects
/// have intervals of their own. Once a trace of such logs with an effect of the tool panicked.
#[test]
fn an_effect_of_the_tool_is_found_with_force_and_without_table() {
    let case =
        Case::simulated_with(&[("x", "squareness", "um_per_m = 60.0")]).without(Channel::Table, |_| true);
    let [fit, validate] = &case.logs;
    let trace = trace(&case.machine(), fit, validate, &|_| {}).unwrap();
    let is_squareness = |found: &&FoundEffect| found.effect.name() == "squareness";
    let Some(found) = trace.axes()[0].found.iter().find(is_squareness) else {
        panic!("{:?}", trace.found_names())
    };
    let (um_per_m, half_width) = (found.effect.values()[0], found.half_widths[0]);
    // Without the table, the stretch of the drive is part of the tool's residual: 180 N/(200 N/µm) either way over 140 mm of y,
    // 13 µm/m if it followed y. A tenth of the angle is determined by the noise alone.
    assert!(
        (um_per_m - 60.0).abs() < 13.0 && half_width > 0.0 && half_width < 6.0,
        "{um_per_m} ± {half_width}"
    );
}

/// One of three fit logs lacks the table. Once the table of the other two was not used either.
#[test]
fn a_table_that_one_log_lacks_is_used_in_the_others() {
    let Some(case) = Case::blind_named("case-2") else { return };
    let lacking = 1;
    let part = case.clone().without(Channel::Table, |number| number == lacking);
    // The validation logs keep theirs.
    let [fit, validate] = [&part.logs[0], &case.logs[1]];
    let trace = trace(&case.machine(), fit, validate, &|_| {}).unwrap();
    let json = trace::json::Document::of(&trace, &[], false).value();
    assert_eq!(certain(&json), case.truth, "{:#}", json["effects"]);
    let note = format!("{}: has no x table, y table", fit[lacking].source);
    assert!(trace.notes().iter().any(|said| said.starts_with(&note)), "{:?}", trace.notes());
    // 0.15 µm of interval in the case with all channels; two of three logs have √1.5 times that.
    let width = &json["effects"][0]["parameters"]["width_um"];
    assert!((width["value"].as_f64().unwrap() - 10.3646).abs() < 0.2, "{width}");
}

/// A log without the scale says nothing of the tool where the other logs predict it from the scale.
#[test]
fn the_tool_of_a_log_without_table_is_not_used_beside_others() {
    let case = Case::simulated().without(Channel::Table, |number| number == 0);
    let [fit, validate] = &case.logs;
    let trace = trace(&case.machine(), fit, validate, &|_| {}).unwrap();
    let unused = |log: &files::log::Log| {
        let note = format!("{}: x tool is not used, as there is no x table to predict it from.", log.source);
        trace.notes().contains(&note)
    };
    assert!(fit.len() > 1 && unused(&fit[0]) && validate.iter().all(unused), "{:?}", trace.notes());
    assert!(!unused(&fit[1]), "{:?}", trace.notes());
    let found: BTreeSet<_> = trace.found_names().into_iter().collect();
    assert!(found.contains("y: latency"), "{found:?}");
}
