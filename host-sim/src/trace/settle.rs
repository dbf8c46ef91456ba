//! The last fit: all that was found, without the trace's own error, until that error is the fitted model's own.

use super::axis::again;
use super::fit::{self, Fitted};
use super::model::AxisModel;
use super::own_error;
use super::residual::{Evidence, Part, rms};
use super::scope::{Mechanics, Scope};
use super::search::Explained;

/// Most fits, each with the error of the fit before. One is enough where the error hardly depends on the model; behind
/// a backlash, where each time that the gap closes depends on it, four or five are.
const MOST_ROUNDS: usize = 10;

/// A fit that lowers the residuals, each without its model's own error, by less than this share in all is not worth
/// another one.
const WORTH: f64 = 2e-3;

/// A model fitted without the trace's own error.
pub struct Settled {
    /// The model.
    pub model: AxisModel,
    /// Its scopes.
    pub explained: Vec<Explained>,
    /// Its own error on the fit logs, which was taken out.
    pub own: Vec<Part>,
}

/// Fits all that was found once more without the trace's own error, and again without that of the new model while this
/// leaves less. `None` where there is no such error, or where the fit logs are explained better with it.
#[must_use]
pub fn settle(
    evidence: &Evidence<'_>,
    model: &AxisModel,
    explained: &[Explained],
    scopes: &[Scope],
    say: &(dyn Fn(&str) + Sync),
) -> Option<Settled> {
    let driven = scopes.iter().find(|scope| scope.mechanics == Mechanics::All)?;
    let with = size(evidence, &evidence.residuals(model, driven), driven);
    let mut next = of(evidence, model.clone(), explained.to_vec(), driven)?;
    let mut best: Option<(Settled, f64)> = None;
    for _ in 0..MOST_ROUNDS {
        let without = Evidence { own: &next.own, ..*evidence }.residuals(&next.model, driven);
        let left = size(evidence, &without, driven);
        if best.as_ref().is_some_and(|(_, least)| left > least - WORTH) {
            break;
        }
        say(&format!("{}: fitting once more without the trace's own error", evidence.names[evidence.axis]));
        let seen = Evidence { own: &next.own, ..*evidence };
        let (model, explained) = again(&seen, &next.model, &next.explained, scopes, say);
        best = Some((next, left));
        let Some(fitted) = of(evidence, model, explained, driven) else { break };
        next = fitted;
    }
    best.filter(|(_, left)| *left < with).map(|(settled, _)| settled)
}

/// Fits a scope's slots before any search; gives what was taken out as the trace's own error, too.
#[must_use]
pub fn first_fit(evidence: &Evidence<'_>, start: &AxisModel, scope: &Scope) -> (Fitted, Vec<Part>) {
    let own = own_error::known(evidence, start, scope);
    (fit::fit(&Evidence { own: &own, ..*evidence }, start, scope, fit::STEPS), own)
}

/// The model of a file that an earlier trace has written, with its own error, where these logs are explained no better by
/// another fit of it: else each trace would move a little what hardly shows. `None` for a model that was declared.
#[must_use]
pub fn unmoved(
    evidence: &Evidence<'_>,
    written: &AxisModel,
    fitted: &AxisModel,
    scopes: &[Scope],
) -> Option<(AxisModel, Vec<Part>)> {
    let driven = scopes.iter().find(|scope| scope.mechanics == Mechanics::All)?;
    if !written.was_fitted() {
        return None;
    }
    let left = |model: &AxisModel| {
        let own = own_error::known(evidence, model, driven);
        let seen = Evidence { own: &own, ..*evidence };
        let sizes = scopes.iter().map(|scope| size(&seen, &seen.residuals(model, scope), scope));
        (sizes.sum::<f64>(), own)
    };
    let ((stood, own), (moved, _)) = (left(written), left(fitted));
    let mut model = written.clone();
    model.weigh(driven);
    (moved > stood - WORTH).then_some((model, own))
}

/// A model with its own error, if it has one.
fn of(
    evidence: &Evidence<'_>,
    model: AxisModel,
    explained: Vec<Explained>,
    driven: &Scope,
) -> Option<Settled> {
    let own = own_error::of(evidence, &model, driven);
    (!own.is_empty()).then_some(Settled { model, explained, own })
}

/// Sum of the logarithms of the residuals of a scope's stages.
fn size(evidence: &Evidence<'_>, parts: &[Part], scope: &Scope) -> f64 {
    scope.stages.iter().map(|&stage| rms(parts, stage, evidence).max(1e-12).ln()).sum()
}
