//! The last fit: all that was found, without the trace's own error, until that error is the fitted model's own.

use super::axis::again;
use super::axis_model::AxisModel;
use super::fit::{self, Fitted};
use super::own_error::{self, size};
use super::residual::{Evidence, Part};
use super::scope::{Mechanics, Scope};
use super::search::Explained;

/// Most fits, each with the error of the fit before. One is enough where the error hardly depends on the model; behind
/// a backlash, where each time that the gap closes depends on it, four or five are.
const MOST_ROUNDS: usize = 10;

/// A fit that lowers the residuals, each without its model's own error, by less than this share in all is not worth
/// another one.
const WORTH: f64 = 2e-3;

/// Another fit of a file that a trace has written must lower the residuals by this share in all to be taken: from another
/// start a fit ends elsewhere along what hardly shows, where a motor stage at its noise differs by up to 4 %.
const MOVES: f64 = 0.05;

/// A model fitted without the trace's own error.
struct Settled {
    model: AxisModel,
    explained: Vec<Explained>,
    /// Its own error on the fit logs, which was taken out.
    own: Vec<Part>,
}

/// What the search found, as it is reported.
pub struct Finished {
    /// The model.
    pub model: AxisModel,
    /// Its scopes.
    pub explained: Vec<Explained>,
    /// The trace's own error that is taken out of the fit logs and of the validation logs; none where it is not known.
    pub own: [Vec<Part>; 2],
}

/// Settles what the search found. A file of an earlier trace, `written`, stays as it is where nothing is found and these
/// logs are explained no better by another fit of it.
#[must_use]
pub fn finish(
    [fit_logs, validate]: [&Evidence<'_>; 2],
    written: &AxisModel,
    model: AxisModel,
    explained: Vec<Explained>,
    scopes: &[Scope],
    say: &(dyn Fn(&str) + Sync),
) -> Finished {
    let mut finished = match settle(fit_logs, &model, &explained, scopes, say) {
        Some(Settled { model, explained, own }) => Finished { model, explained, own: [own, Vec::new()] },
        None => Finished { model, explained, own: [Vec::new(), Vec::new()] },
    };
    let has_nothing_new = finished.model.found().is_empty();
    let unmoved = has_nothing_new.then(|| unmoved(fit_logs, written, &finished.model, scopes)).flatten();
    if let Some((model, own)) = unmoved {
        (finished.model, finished.own[0]) = (model, own);
    }
    if let Some(driven) = driven(scopes).filter(|_| !finished.own[0].is_empty()) {
        finished.own[1] = own_error::of(validate, &finished.model, driven);
    }
    finished
}

/// The scope of the stages that a measured motor drives.
fn driven(scopes: &[Scope]) -> Option<&Scope> {
    scopes.iter().find(|scope| scope.mechanics == Mechanics::All)
}

/// Fits all that was found once more without the trace's own error, and again without that of the new model while this
/// leaves less. `None` where there is no such error, or where the fit logs are explained better with it.
fn settle(
    evidence: &Evidence<'_>,
    model: &AxisModel,
    explained: &[Explained],
    scopes: &[Scope],
    say: &(dyn Fn(&str) + Sync),
) -> Option<Settled> {
    let driven = driven(scopes)?;
    let with = size(evidence, &evidence.residuals(model, driven), driven);
    let first = of(evidence, model.clone(), explained.to_vec(), driven)?;
    let mut best: Option<(Settled, f64)> = None;
    for _ in 0..MOST_ROUNDS {
        say(&format!("{}: fitting once more without the trace's own error", evidence.names[evidence.axis]));
        let last = best.as_ref().map_or(&first, |(settled, _)| settled);
        let seen = Evidence { own: &last.own, ..*evidence };
        let (model, explained) = again(&seen, &last.model, &last.explained, scopes, say);
        let with_last = left(evidence, &model, &last.own, scopes);
        let Some(next) = of(evidence, model, explained, driven) else { break };
        let left = left(evidence, &next.model, &next.own, scopes);
        if best.as_ref().is_some_and(|(_, least)| left > least - WORTH) {
            break;
        }
        best = Some((next, left));
        if (left - with_last).abs() < WORTH {
            break;
        }
    }
    let (settled, _) = best?;
    let seen = Evidence { own: &settled.own, ..*evidence };
    (size(&seen, &seen.residuals(&settled.model, driven), driven) < with).then_some(settled)
}

/// What a model leaves in all stages without the trace's own error: the sum of the logarithms of the residuals.
fn left(evidence: &Evidence<'_>, model: &AxisModel, own: &[Part], scopes: &[Scope]) -> f64 {
    let seen = Evidence { own, ..*evidence };
    scopes.iter().map(|scope| size(&seen, &seen.residuals(model, scope), scope)).sum()
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
    let driven = driven(scopes).filter(|_| written.was_fitted())?;
    let [own, own_of_fitted] = [written, fitted].map(|model| own_error::known(evidence, model, driven));
    let stood = left(evidence, written, &own, scopes);
    let moved = left(evidence, fitted, &own_of_fitted, scopes);
    let mut model = written.clone();
    model.weigh(driven);
    (moved > stood - MOVES).then_some((model, own))
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
