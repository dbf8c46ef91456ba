//! The last fit: all that was found, without the trace's own error, until that error is the fitted model's own.

use super::axis::again;
use super::model::AxisModel;
use super::own_error;
use super::residual::{Evidence, Part, rms};
use super::scope::{Mechanics, Scope};
use super::search::Explained;

/// Most fits, each with the error of the fit before. One is enough where the error hardly depends on the model; behind
/// a backlash, where each time that the gap closes depends on it, seven to nine are.
const MOST_ROUNDS: usize = 10;

/// The error is the model's own if taking it anew changes the residual of no stage by more than this share.
const SAME: f64 = 2e-3;

/// A model fitted without the trace's own error.
pub struct Settled {
    /// The model.
    pub model: AxisModel,
    /// Its scopes.
    pub explained: Vec<Explained>,
    /// The error on the fit logs that was taken out.
    pub own: Vec<Part>,
    /// The model whose error that is: the same but for what [`MOST_ROUNDS`] left.
    pub of: AxisModel,
}

/// Fits all that was found once more without the trace's own error. `None` where there is no such error, or where the
/// fit logs are explained better with it.
#[must_use]
pub fn settle(
    evidence: &Evidence<'_>,
    model: &AxisModel,
    explained: &[Explained],
    scopes: &[Scope],
    say: &(dyn Fn(&str) + Sync),
) -> Option<Settled> {
    let driven = scopes.iter().find(|scope| scope.mechanics == Mechanics::All)?;
    let own = |model: &AxisModel| Some(own_error::of(evidence, model, driven)).filter(|own| !own.is_empty());
    let mut next = Some(own(model)?);
    let mut settled =
        Settled { model: model.clone(), explained: explained.to_vec(), own: Vec::new(), of: model.clone() };
    for _ in 0..MOST_ROUNDS {
        let Some(own_error) = next else { break };
        say(&format!("{}: fitting once more without the trace's own error", evidence.names[evidence.axis]));
        settled.of = settled.model;
        settled.own = own_error;
        let seen = Evidence { own: &settled.own, ..*evidence };
        (settled.model, settled.explained) = again(&seen, &settled.of, &settled.explained, scopes, say);
        let parts = seen.residuals(&settled.model, driven);
        next = own(&settled.model).filter(|own| {
            let anew = Evidence { own, ..*evidence }.residuals(&settled.model, driven);
            !is_same(evidence, [&parts, &anew], driven)
        });
    }
    let with = evidence.residuals(model, driven);
    let without = Evidence { own: &settled.own, ..*evidence }.residuals(&settled.model, driven);
    own_error::is_less(evidence, [&with, &without], driven).then_some(settled)
}

/// Whether no stage's residual differs by more than [`SAME`].
fn is_same(evidence: &Evidence<'_>, residuals: [&[Part]; 2], scope: &Scope) -> bool {
    scope.stages.iter().all(|&stage| {
        let [first, second] = residuals.map(|parts| rms(parts, stage, evidence).max(1e-12));
        (second / first).ln().abs() < SAME
    })
}
