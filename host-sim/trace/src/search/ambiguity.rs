//! Effects that the logs do not distinguish.
//!
//! If another candidate explains the residual as well as the one that was added, both are reported, with the motion that
//! distinguishes them best ([`super::distinguishing_motion`]).

use super::candidates::Candidate;
use super::distinguishing_motion::Proposal;
use super::held_out::{compare, scores};
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::scope::Scope;
use model::effects::Effect;

/// Two effects of which the logs show one but do not determine which.
#[derive(Clone, Debug)]
pub struct Ambiguity {
    /// The effect that was added.
    pub added: Effect,
    /// The effect that explains the logs as well.
    pub rival: Effect,
    /// The model with the rival in place of the added effect.
    pub with_rival: AxisModel,
    /// A motion that distinguishes both; `None` if the machine file does not suffice to simulate it.
    pub proposal: Option<Proposal>,
}

/// The supported candidates that are, in every stage, not significantly worse than the added one, or worse by less than the
/// minimum reduction of an effect.
#[must_use]
pub fn rivals(data: &FitData<'_>, candidates: &[Candidate], added: usize, scope: &Scope) -> Vec<Ambiguity> {
    let options = &data.options.search;
    let Some(best) = candidates[added].fitted.as_ref() else { return Vec::new() };
    let of_best = scores(best);
    let is_as_good = |candidate: &Candidate| {
        let Some(fitted) = candidate.fitted.as_ref().filter(|_| candidate.is_supported(options)) else {
            return false;
        };
        let comparison = compare(&scores(fitted), &of_best, &scope.stages, options);
        comparison.iter().all(|stage| stage.t < options.chance_t || stage.reduction < options.min_reduction)
    };
    let others = candidates.iter().enumerate().filter(|(index, _)| *index != added);
    let rivals = others.filter(|(_, candidate)| is_as_good(candidate));
    rivals
        .filter_map(|(_, candidate)| {
            Some(Ambiguity {
                added: candidates[added].effect.clone(),
                rival: candidate.effect.clone(),
                with_rival: candidate.fitted.as_ref()?.model.clone(),
                proposal: None,
            })
        })
        .collect()
}
