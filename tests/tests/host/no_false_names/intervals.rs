//! Once, 95 % intervals contained 73 % of the true values.

use self_test::case::Case;
use self_test::kind::Kind;
use self_test::score::Estimate;
use self_test::trace_and_score;

/// Cases of the textbook kind with 32 parameters.
const SEED: u64 = 3;
const CASES: u64 = 18;

#[test]
fn intervals_contain_the_true_values_and_are_narrow() {
    let mut estimates: Vec<Estimate> = Vec::new();
    for number in 1..=CASES {
        let case = Case::draw(SEED, number).unwrap();
        let outcome = trace_and_score(&case, &|_| {}).unwrap();
        // The period of an order follows from the lead.
        estimates.extend(outcome.estimates.into_iter().filter(|estimate| !estimate.is_declared()));
    }
    let count = estimates.len();
    assert!(count >= 30, "{estimates:?}");
    let missed: Vec<&Estimate> = estimates.iter().filter(|estimate| !estimate.is_covered()).collect();
    // Of 32 intervals of 95 %, five or more miss the truth in 2 of 100 such tests; of intervals of 73 %, in 96.
    assert!(missed.len() < 5, "{} of {count}: {missed:?}", missed.len());
    // Wide intervals contain everything: the median half width is a thousandth to a hundredth of the value.
    let relative = |estimate: &Estimate| 0.5 * (estimate.ci95[1] - estimate.ci95[0]) / estimate.truth.abs();
    let mut half_widths: Vec<f64> = estimates.iter().map(relative).collect();
    half_widths.sort_by(f64::total_cmp);
    assert!(half_widths[count / 2] < 0.01, "{half_widths:?}");
}

/// The tool's dependence on an acceleration is corrected by simulated loops ([`trace::fit::tool_bias`]). With those of the declared file, that of the
/// axis that accelerates lacked its drive lag of 0.4 ms, and a cross-talk of 1.306 µm per m/s² was 1.4 % too large, with an interval of
/// 0.9 %. The limit is four standard deviations of the noise, of which the interval has two: 0.33 %.
#[test]
fn a_crosstalk_of_an_axis_with_a_lag_is_not_too_large() {
    let case = Case::draw_kind(Kind::Coarse, 20_261_501, 23).unwrap();
    let outcome = trace_and_score(&case, &|_| {}).unwrap();
    let of_crosstalk = |estimate: &&Estimate| estimate.effect == "crosstalk";
    let estimate = outcome.estimates.iter().find(of_crosstalk).unwrap();
    let half_width = 0.5 * (estimate.ci95[1] - estimate.ci95[0]);
    assert!(half_width < 0.004 * estimate.truth.abs(), "{estimate:?}");
    assert!((estimate.value - estimate.truth).abs() < 2.0 * half_width, "{estimate:?}");
}
