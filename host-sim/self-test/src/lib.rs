//! Tests the tracer on machines that are generated at random and simulated by a second, independent simulator.
//!
//! [`plant`], [`machine`], [`servo`] and [`simulation`] are this simulator, in plain f64. They share no code with the crate `plant`,
//! the effects of `model` and the controller in `shared`, none of which this crate depends on. The tracer is thus tested
//! on data that its own model did not generate.
//!
//! | step | module |
//! |---|---|
//! | generate a machine, its motions and its undeclared effects | [`kind`], [`draw`], [`motion`], [`truth`], [`effect`], [`effect_draw`], [`extra`], [`chain`], [`gap`], [`joint`] |
//! | simulate it | [`simulation`], [`machine`], [`plant`], [`servo`], [`sensors`], [`pickup`], [`scale`], [`recording`], [`fault`] |
//! | one machine with its logs | [`case`] |
//! | compare a trace with the true effects | [`score`], [`outside`], [`judgement`] |
//! | statistics of all cases | [`summary`], [`confusion`] |
//! | how often an effect of a given size is found | [`detection`], [`detection_curve`], [`detection_text`], `detection_plot` |
//! | a log that is too short, and whether a planned motion decides | [`plan_case`], [`plan_summary`] |
//! | a law that no effect describes, and whether it is found | [`law`], [`law_case`], [`law_intervals`] |
//! | text and page | [`text_summary`], [`page`], `kind_table`, `confusion_plot`, `parameter_plot` |

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod accepted;
pub mod case;
pub mod chain;
mod chain_size;
pub mod confusion;
mod confusion_plot;
mod delay_line;
pub mod detection;
pub mod detection_curve;
mod detection_plot;
pub mod detection_text;
pub mod draw;
mod drive;
pub mod effect;
pub mod effect_draw;
pub mod extra;
pub mod fault;
pub mod gap;
pub mod joint;
pub mod judgement;
mod judgement_text;
pub mod kind;
mod kind_table;
pub mod law;
pub mod law_case;
pub mod law_intervals;
pub mod machine;
mod mode;
pub mod motion;
mod naming;
pub mod outside;
pub mod page;
mod parameter_plot;
pub mod pickup;
pub mod plan_case;
pub mod plan_summary;
pub mod plant;
pub mod recording;
pub mod scale;
pub mod score;
pub mod sensors;
pub mod servo;
pub mod simulation;
pub mod summary;
pub mod text_summary;
pub mod truth;
pub mod warming;

use serde_json::{Value, json};

use case::Case;
use files::error::InputError;
use score::Outcome;
use summary::Summary;
use trace::TraceOptions;

/// Traces a case without its true effects, then scores the trace. `progress` receives the name of each step.
///
/// # Errors
/// When the tracer refuses a log.
pub fn trace_and_score(case: &Case, progress: &(dyn Fn(&str) + Sync)) -> Result<Outcome, InputError> {
    trace_and_score_with(&TraceOptions::default(), case, progress)
}

/// The JSON of a trace of a case, without its true effects.
///
/// # Errors
/// When the tracer refuses a log.
pub fn traced(case: &Case, progress: &(dyn Fn(&str) + Sync)) -> Result<Value, InputError> {
    traced_with(&TraceOptions::default(), case, progress)
}

fn traced_with(
    options: &TraceOptions,
    case: &Case,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Value, InputError> {
    let trace = trace::trace_with(options, &case.machine, [&case.fit, &case.validate], progress)?;
    Ok(trace::json::Document::of(&trace, &[], false).value())
}

/// As [`trace_and_score`], with other thresholds of the tracer.
///
/// # Errors
/// As [`trace_and_score`].
pub fn trace_and_score_with(
    options: &TraceOptions,
    case: &Case,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Outcome, InputError> {
    Ok(Outcome::of(case, &traced_with(options, case, progress)?))
}

/// The JSON of `self-test --json`.
#[must_use]
pub fn json(seed: u64, asked: u64, outcomes: &[Outcome], summary: &Summary) -> Value {
    json!({
        "seed": seed,
        "asked": asked,
        "summary": summary.json(),
        "kinds": summary::kinds_json(outcomes),
        "cases": outcomes.iter().map(Outcome::json).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod chain_tests;
#[cfg(test)]
mod kind_tests;
#[cfg(test)]
mod mechanism_tests;
#[cfg(test)]
mod tests;
