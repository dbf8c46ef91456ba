//! Machines drawn at random and simulated by a second, separate program: is what they lack found?
//!
//! [`plant`], [`servo`] and [`mod@bench`] are that program, in plain f64; they share no code with the crate `plant`,
//! the effects of `model` and the controller in `shared`: what made the data must not be the only judge of what explains
//! them. [`draw`], [`truth`] and [`motion`] say what it is given; [`case`] is one machine with its logs. [`score`]
//! holds a trace against the truth, [`summary`] all of them together, with [`confusion`].

pub mod bench;
pub mod case;
pub mod confusion;
mod confusion_table;
pub mod draw;
pub mod motion;
pub mod page;
pub mod plant;
pub mod score;
pub mod servo;
mod strip;
pub mod summary;
pub mod truth;
pub mod words;

use serde_json::{Value, json};

use case::Case;
use files::error::InputError;
use score::Outcome;
use summary::Summary;

/// Traces a case without a look at its truth, then scores it.
///
/// # Errors
/// When the tracer refuses a log.
pub fn judge(case: &Case, say: &(dyn Fn(&str) + Sync)) -> Result<Outcome, InputError> {
    let trace = trace::trace(&case.machine, &case.fit, &case.validate, say)?;
    Ok(Outcome::new(case.number, &case.truths, &trace::json::of(&trace, false)))
}

/// The JSON of `self-test --json`.
#[must_use]
pub fn json(seed: u64, asked: u64, outcomes: &[Outcome], summary: &Summary) -> Value {
    json!({
        "seed": seed,
        "asked": asked,
        "summary": summary.json(),
        "cases": outcomes.iter().map(Outcome::json).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests;
