//! Effects that are added provisionally, because each hides the others.
//!
//! Of several large effects of similar size none may be supported alone: beside what the others leave, it improves some folds
//! and not others, makes a log worse in which two of them compensate each other, or resembles a candidate at its limit. The
//! candidate that gains most is then added provisionally, and the search goes on. All that follows is kept only if in the end
//! the residual is that of the noise and every effect is supported beside the others; otherwise the search ends where it was
//! before.
//!
//! Two effects of the tool may cancel in one log: on a diagonal, in-talk and cross-talk are proportional to the same
//! acceleration. That log has a small residual and therefore a large weight, so that neither effect alone gains anything. The
//! candidate that leaves least together with another one is then added.
//!
//! No setting of the controller is added in this way. They compensate each other: with enough of them any controller would
//! describe any motion.

use super::candidates::Candidate;
use super::mass_check::takes_place_of_mass;
use super::round::Round;
use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::least_squares::{self, Fitted};
use crate::fit::model_bias::log_rms;
use crate::fit::scope::Scope;
use model::effects::Stage;

/// A search before its first provisional effect.
#[derive(Clone, Debug)]
pub struct Before {
    /// The fit.
    pub fitted: Fitted,
    /// The error of the tracer's own simulation.
    pub bias: Vec<ResidualSeries>,
    /// The rounds so far; the last one added nothing.
    pub rounds: Vec<Round>,
}

/// The candidate of a round that is to be added although it is not supported, by its index, with its fit: the one that gains most,
/// or else the one that does so together with another one. `None` if the model describes the logs without it, or no
/// candidate gains as much as a supported one has to.
#[must_use]
pub fn candidate(data: &FitData<'_>, base: &Fitted, round: &Round, scope: &Scope) -> Option<(usize, Fitted)> {
    if scope.stages.contains(&Stage::Motor) || !is_gross(data, base, scope) {
        return None;
    }
    let possible = |&(index, start): &(usize, &Fitted)| {
        let fitted = least_squares::fit_from(data, &start.model, scope, least_squares::STEPS, &start.columns);
        let is_limited = fitted.model.at_limit(fitted.model.found().len() - 1).is_some();
        (!is_limited && !takes_place_of_mass(data, base, &fitted, scope)).then_some((index, fitted))
    };
    let options = &data.options.search;
    let may_be_added = |c: &Candidate| c.exceeds_tolerance && c.limit.is_none();
    let all = round.candidates.iter().enumerate().filter(|(_, candidate)| may_be_added(candidate));
    let candidates: Vec<(usize, &Fitted)> =
        all.filter_map(|(index, candidate)| Some((index, candidate.fitted.as_ref()?))).collect();
    let gains = |&&(index, _): &&(usize, &Fitted)| round.candidates[index].gain >= options.min_gain();
    let alone = candidates.iter().filter(gains).find_map(possible);
    alone.or_else(|| possible(&candidates[of_best_pair(data, base, &candidates, scope)?]))
}

/// The first of the two candidates that leave least together; `None` if no two gain as much as a supported one has to. Of the tool
/// alone, whose fits need no simulation of the drive.
fn of_best_pair(
    data: &FitData<'_>,
    base: &Fitted,
    candidates: &[(usize, &Fitted)],
    scope: &Scope,
) -> Option<usize> {
    if scope.stages != [Stage::Tool] {
        return None;
    }
    let left = |fitted: &Fitted| log_rms(data, &fitted.residuals, scope);
    let left_by_both = |first: usize, second: usize| {
        let [(_, first), (_, second)] = [candidates[first], candidates[second]];
        let both = first.model.with(second.model.axis.effect.last()?.clone());
        Some(left(&least_squares::fit_from(data, &both, scope, least_squares::STEPS, &first.columns)))
    };
    let count = candidates.len();
    let pairs = (0..count).flat_map(|first| (first + 1..count).map(move |second| (first, second)));
    let (best, after) = pairs
        .filter_map(|(first, second)| Some((first, left_by_both(first, second)?)))
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    (after < left(base) - data.options.search.min_gain()).then_some(best)
}

/// Whether a fit with effects that were added provisionally leaves no more than the noise. One effect alone must be supported
/// by itself.
#[must_use]
pub fn is_complete(data: &FitData<'_>, fitted: &Fitted, scope: &Scope) -> bool {
    let ratio = data.options.search.max_provisional_ratio;
    let is_noise =
        |&stage: &Stage| data.rms(&fitted.residuals, stage) <= ratio * data.noise(&fitted.model, stage);
    let effects = fitted.model.found().iter().filter(|effect| scope.holds(effect)).count();
    effects > 1 && scope.stages.iter().all(is_noise)
}

/// Whether a fit does not describe a stage of its scope.
#[must_use]
pub fn is_gross(data: &FitData<'_>, fitted: &Fitted, scope: &Scope) -> bool {
    let is_gross =
        |&stage: &Stage| data.rms(&fitted.residuals, stage) > data.max_described(&fitted.model, stage);
    scope.stages.iter().any(is_gross)
}
