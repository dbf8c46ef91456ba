//! Found effects in their other form.
//!
//! A form differs in what no coordinate of the fit describes
//! ([`EffectModel::other_form`](model::effects::EffectModel::other_form)), such as where the damper of a mode acts. Once all effects are
//! found, each is held against its other form.

use super::ambiguity::{Ambiguity, is_as_good};
use super::held_out::{compare, is_better, scores};
use super::round::Round;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{self, Fitted};
use crate::fit::scope::Scope;
use model::effects::Effect;

/// Largest number of times that all effects are tried in their other form: a form may only fit once that of another effect is right.
const PASSES: usize = 2;

/// The fit in which each found effect has the form that explains the logs better, or as well without another effect that is found. A form that explains
/// them as well as the one that was taken is its rival in the last round.
#[must_use]
pub fn with_better_forms(
    data: &FitData<'_>,
    mut base: Fitted,
    rounds: &mut [Round],
    scope: &Scope,
) -> Fitted {
    for _ in 0..PASSES {
        let mut is_changed = false;
        for index in 0..base.model.found().len() {
            let effect = base.model.found()[index].clone();
            let start = base.model.in_other_form(index).filter(|_| scope.holds(&effect));
            let Some(start) = start else { continue };
            let mut other = least_squares::fit(data, &start, scope, least_squares::STEPS);
            if is_better([&base, &other], scope, &data.options.search)
                || is_simpler(data, &base, &other, scope)
            {
                std::mem::swap(&mut base, &mut other);
                is_changed = true;
            }
            for round in &mut *rounds {
                let is_of_form =
                    |one: &Ambiguity| one.added.is_same(&effect) && is_form_of(&one.rival, &one.added);
                round.ambiguities.retain(|one| !is_of_form(one));
            }
            let rival = explains_as_well(data, &base, &other, scope).then(|| ambiguity(&base, other, index));
            if let (Some(rival), Some(round)) = (rival, rounds.last_mut()) {
                round.ambiguities.push(rival);
            }
        }
        if !is_changed {
            break;
        }
    }
    base
}

/// Whether an effect is another one in another form: its rival is no effect of its own.
#[must_use]
pub fn is_form_of(rival: &Effect, effect: &Effect) -> bool {
    effect.other_form().is_some_and(|form| rival.is_same_kind(&form) && rival.is_same(effect))
}

/// The effect at an index in the form of one fit, with that of the other fit as its rival.
fn ambiguity(base: &Fitted, other: Fitted, index: usize) -> Ambiguity {
    let [added, rival] = [base, &other].map(|fitted| fitted.model.found()[index].clone());
    Ambiguity { added, rival, with_rival: other.model }
}

/// Whether what a fit gains over another one is, in every stage, chance or less than an effect has to gain.
fn explains_as_well(data: &FitData<'_>, base: &Fitted, other: &Fitted, scope: &Scope) -> bool {
    let options = &data.options.search;
    let stages = compare(&scores(other), &scores(base), &scope.stages, options);
    stages.iter().all(|stage| is_as_good(stage, options))
}

/// Whether another fit explains the logs as well with fewer effects: more of them are within the tolerance of the declared model there, and
/// are dropped later.
fn is_simpler(data: &FitData<'_>, base: &Fitted, other: &Fitted, scope: &Scope) -> bool {
    let needless = |fitted: &Fitted| {
        let settings = &fitted.model.nominal().settings;
        let is_needless = |effect: &&Effect| !effect.exceeds_tolerance(settings, data.rates);
        fitted.model.found().iter().filter(is_needless).count()
    };
    needless(other) > needless(base) && explains_as_well(data, base, other, scope)
}
