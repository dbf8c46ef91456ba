//! The cases of planned motions in sentences.

use serde_json::Value;

use super::plan_case::PlanOutcome;
use super::text_summary::counted;

/// The summary of the cases: sentences.
#[must_use]
pub fn summary(seed: u64, drawn: usize, outcomes: &[PlanOutcome]) -> String {
    let count = |is: &dyn Fn(&PlanOutcome) -> bool| outcomes.iter().filter(|outcome| is(outcome)).count();
    let n = outcomes.len();
    let durations: Vec<f64> = outcomes.iter().filter_map(|outcome| outcome.duration_s).collect();
    let sessions: Vec<f64> = outcomes.iter().map(|outcome| outcome.session_s).collect();
    let widths: Vec<f64> = outcomes.iter().flat_map(|outcome| outcome.widths.iter().copied()).collect();
    let promised = count(&|outcome| outcome.is_promised);
    let kept = count(&|outcome| outcome.is_promised && outcome.is_decided);
    let wrong = count(&|outcome| !outcome.false_names.is_empty());
    let intervals = outcomes.iter().flat_map(|outcome| &outcome.is_within_promise);
    let within = intervals.clone().filter(|is| **is).count();
    let mut lines = vec![
        format!(
            "{drawn} machines drawn from seed {seed}, each with 3 s of a circle; {n} of them leave a question."
        ),
        format!(
            "One planned motion decides {} of {n}, rightly; of {} that it was to decide by the plan, {kept}.",
            count(&|outcome| outcome.is_decided),
            counted(promised, "machine"),
        ),
        format!("A false effect is stated as certain on {wrong}."),
        format!("{within} of {} promised intervals contain the true value.", intervals.count()),
        format!(
            "The planned motions last {:.1} s in the median, at most {:.1} s; the three motions of a session {:.1} s.",
            numerics::quantile(&durations, 0.5),
            numerics::quantile(&durations, 1.0),
            numerics::quantile(&sessions, 0.5),
        ),
        format!(
            "Those of a session, without a plan, decide {}. With the planned motion the intervals of {} are {:.2} times as wide in the median.",
            count(&|outcome| outcome.is_session_right),
            counted(widths.len(), "value"),
            numerics::quantile(&widths, 0.5),
        ),
    ];
    for outcome in outcomes.iter().filter(|outcome| !outcome.is_decided) {
        let questions: Vec<String> = outcome.questions.iter().map(Value::to_string).collect();
        lines.push(format!(
            "case {}: true {}; asked {}; {}{}",
            outcome.number,
            if outcome.truths.is_empty() { "nothing".to_owned() } else { outcome.truths.join(", ") },
            questions.join(", "),
            if outcome.is_promised { "promised" } else { "not promised" },
            outcome.false_names.iter().map(|name| format!("; false and certain: {name}")).collect::<String>(),
        ));
    }
    lines.join("\n")
}
