//! Effects in the place of others that were taken for them.
//!
//! In the round in which an effect is added, another kind may explain the residual nearly as well, and what decides between both is
//! hidden by effects that are found later. Once all are found, each is held against the kinds that declare themselves its alternative
//! ([`EffectModel::in_place_of`](model::effects::EffectModel::in_place_of)).

use super::ambiguity::{Ambiguity, is_as_good, rival};
use super::held_out::{compare, is_better, scores};
use super::round::Round;
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{self, Fitted};
use crate::fit::scope::Scope;
use model::effects::{Effect, Found, KINDS, Substitute};

/// The fit in which each found effect, or an alternative of it, explains the logs better. Rivals that the rounds have of an effect in
/// another form remain if they explain the logs as well as the form that was taken. An alternative that explains them as well as the found
/// effect, which stays beside it in another form, becomes a rival.
#[must_use]
pub fn with_better_alternatives(
    data: &FitData<'_>,
    mut base: Fitted,
    rounds: &mut [Round],
    scope: &Scope,
) -> Fitted {
    for effect in base.model.found().to_vec() {
        for substitute in substitutes(data, &base.model, &effect) {
            let index = base.model.found().iter().position(|found| *found == effect);
            let Some(index) = index.filter(|_| scope.holds(&effect)) else { break };
            let (taken, is_alone) = (substitute.effect.clone(), substitute.beside.is_none());
            let Some(start) = replaced(&base.model, index, substitute) else { continue };
            let other = least_squares::fit(data, &start, scope, least_squares::STEPS);
            if !is_better([&base, &other], scope, &data.options.search) {
                let rival = (!is_alone).then(|| rival(data, [&base, &other], &taken, scope)).flatten();
                if let (Some(rival), Some(round)) = (rival, rounds.last_mut()) {
                    round.ambiguities.push(Ambiguity {
                        added: effect.clone(),
                        rival,
                        with_rival: other.model,
                    });
                }
                continue;
            }
            if is_alone && has_needless(data, &other.model) && !has_needless(data, &base.model) {
                continue;
            }
            base = other;
            for round in &mut *rounds {
                let is_of_other = |ambiguity: &Ambiguity| !ambiguity.added.is_same(&taken);
                round.ambiguities.retain(|one| is_of_other(one) || is_still_as_good(data, &base, one, scope));
            }
        }
    }
    base
}

/// What may be tried in place of an effect.
fn substitutes(data: &FitData<'_>, model: &AxisModel, effect: &Effect) -> Vec<Substitute<Effect>> {
    let [lowest_mm, highest_mm] = data.travel_mm();
    let found = Found {
        name: effect.name(),
        parameters: effect.parameters(),
        coordinates: effect.coordinates_at(data.rates),
        mode: effect.mode(),
        axis: &model.axis.settings,
        rates: data.rates,
        travel_mm: highest_mm - lowest_mm,
    };
    KINDS.iter().filter_map(|kind| (kind.in_place_of)(&found)).collect()
}

/// The model with a substitute for a found effect; `None` if it has the same effect already.
fn replaced(model: &AxisModel, index: usize, substitute: Substitute<Effect>) -> Option<AxisModel> {
    let Substitute { effect, beside } = substitute;
    let without = model.without(index);
    if without.axis.effect.iter().any(|other| other.is_same(&effect)) {
        return None;
    }
    let with = without.with(effect);
    Some(match beside {
        Some(coordinates) => with.with(model.found()[index].at(&coordinates)),
        None => with,
    })
}

/// Whether the rival of an effect explains the logs as well as the form of the effect that replaced the one of the round.
fn is_still_as_good(data: &FitData<'_>, base: &Fitted, ambiguity: &Ambiguity, scope: &Scope) -> bool {
    let index = base.model.found().iter().position(|found| found.is_same(&ambiguity.added));
    let Some(index) = index else { return true };
    let start = base.model.without(index).with(ambiguity.rival.clone());
    let rival = least_squares::fit(data, &start, scope, least_squares::STEPS);
    let options = &data.options.search;
    let stages = compare(&scores(&rival), &scores(base), &scope.stages, options);
    stages.iter().all(|stage| is_as_good(stage, options))
}

/// Whether a found effect is within the tolerance of the declared model, which is no explanation. Beside another one it is dropped later.
fn has_needless(data: &FitData<'_>, model: &AxisModel) -> bool {
    let settings = &model.nominal().settings;
    model.found().iter().any(|effect| !effect.exceeds_tolerance(settings, data.rates))
}
