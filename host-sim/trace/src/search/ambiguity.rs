//! Effects that the logs do not distinguish.
//!
//! If another candidate explains the residual as well as the one that was added, both are reported, with the motion that
//! distinguishes them best ([`crate::result::distinguishing_motion`]).

use super::candidates::Candidate;
use super::held_out::{Comparison, compare, scores};
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{self, Fitted};
use crate::fit::scope::Scope;
use crate::options::SearchOptions;
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
}

/// The candidates that are, in every stage, not significantly worse than the added one, or worse by less than the minimum reduction
/// of an effect; they are supported by held-out data or gain [enough](SearchOptions::min_rival_gain). A parameter at a limit
/// is no objection: what is not measured may still be the cause.
#[must_use]
pub fn rivals(data: &FitData<'_>, candidates: &[Candidate], added: usize, scope: &Scope) -> Vec<Ambiguity> {
    let options = &data.options.search;
    let added = &candidates[added];
    let gain_over = gain_of(added, scope, options);
    let is_rival = |other: &&Candidate| {
        let gains_enough = other.exceeds_tolerance && other.gain >= options.min_rival_gain * added.gain;
        let contains_added = other.effect.kind().contains.contains(&added.effect.name());
        !std::ptr::eq(*other, added)
            && !contains_added
            && (other.passes_significance(options) || gains_enough)
            && gain_over(other).is_some_and(|stages| stages.iter().all(|stage| is_as_good(stage, options)))
    };
    let ambiguity = |rival: &Candidate| {
        Some(Ambiguity {
            added: added.effect.clone(),
            rival: rival.effect.clone(),
            with_rival: rival.fitted.as_ref()?.model.clone(),
        })
    };
    candidates.iter().filter(is_rival).filter_map(ambiguity).collect()
}

/// The effects that were dropped although they explain the logs as well as the one that was added after them: the drop does not decide between the
/// two.
#[must_use]
pub fn dropped_rivals(
    data: &FitData<'_>,
    (base, added): (&Fitted, &Fitted),
    dropped: &[Effect],
    scope: &Scope,
) -> Vec<Ambiguity> {
    let Some(effect) = added.model.found().last() else { return Vec::new() };
    let may_be = |dropped: &&Effect| {
        let is_searched = scope.holds(dropped) && !dropped.is_same(effect);
        is_searched && !base.model.axis.effect.iter().any(|other| other.is_same(dropped))
    };
    let ambiguity = |dropped: &Effect| {
        let start = base.model.with(dropped.clone());
        let fitted = least_squares::fit(data, &start, scope, least_squares::STEPS);
        let rival = rival(data, [added, &fitted], dropped, scope)?;
        Some(Ambiguity { added: effect.clone(), rival, with_rival: fitted.model })
    };
    dropped.iter().filter(may_be).filter_map(ambiguity).collect()
}

/// An effect as another fit has it, if it is more than its tolerance and the logs do not speak for the first fit. A mode far above the frequencies
/// of the motion is, with another damping ratio and a late reading, the same.
#[must_use]
pub fn rival(
    data: &FitData<'_>,
    [fitted, other]: [&Fitted; 2],
    effect: &Effect,
    scope: &Scope,
) -> Option<Effect> {
    let rival = other.model.found().iter().find(|found| found.is_same(effect))?;
    let settings = &other.model.nominal().settings;
    let options = &data.options.search;
    let stages = compare(&scores(other), &scores(fitted), &scope.stages, options);
    let is_rival = rival.exceeds_tolerance(settings, data.rates)
        && stages.iter().all(|stage| is_as_good(stage, options));
    is_rival.then(|| rival.clone())
}

/// Whether what an effect gains over a rival in a stage is chance, or less than the minimum reduction of an effect.
#[must_use]
pub fn is_as_good(gain: &Comparison, options: &SearchOptions) -> bool {
    gain.t < options.chance_t || gain.reduction < options.min_reduction
}

/// Moves the candidate with the fewest parameters to the front, among those that do not differ significantly from the best one. An
/// additional parameter also follows the noise: of two effects that explain the same, the one with more parameters often gains
/// slightly more.
pub fn prefer_fewer_parameters(candidates: &mut [Candidate], scope: &Scope, options: &SearchOptions) {
    if let Some(index) = simplest_equal(candidates, scope, options) {
        candidates[..=index].rotate_right(1);
    }
}

/// The candidate with the fewest parameters, by its index, if it is simpler than the first one, or its ordinary
/// form, and does not differ significantly.
fn simplest_equal(candidates: &[Candidate], scope: &Scope, options: &SearchOptions) -> Option<usize> {
    let (best, others) = candidates.split_first()?;
    let is_chance =
        |stage: &Comparison| stage.t < options.chance_t && stage.reduction < options.min_reduction;
    // A special form must gain as much over the ordinary one as an effect must.
    let is_no_gain = |stage: &Comparison| stage.reduction < options.min_reduction;
    let parameters = |candidate: &Candidate| candidate.effect.coordinates().len();
    let gain_over = gain_of(best, scope, options);
    let is_equal = |other: &Candidate| {
        if !other.is_supported(options) {
            return false;
        }
        let is_ordinary = is_special_form(&best.effect, &other.effect);
        let is_simpler = parameters(other) < parameters(best);
        gain_over(other).is_some_and(|stages| {
            is_simpler && stages.iter().all(is_chance) || is_ordinary && stages.iter().all(is_no_gain)
        })
    };
    let equals = (1..).zip(others).filter(|(_, other)| is_equal(other));
    equals.min_by_key(|(_, other)| parameters(other)).map(|(index, _)| index)
}

/// Whether the first effect is a special form of the second one, and both are not the same kind.
#[must_use]
pub fn is_special_form(special: &Effect, ordinary: &Effect) -> bool {
    special.kind().special_form_of == Some(ordinary.name()) && ordinary.kind().special_form_of.is_none()
}

/// Whether an effect is no substitute for one at a limit of a parameter, but another form of it: a special form goes on beyond the limit of
/// its ordinary one, and what an effect contains is what it becomes at the limit.
#[must_use]
pub fn is_other_form(effect: &Effect, limited: &Effect) -> bool {
    is_special_form(effect, limited)
        || limited.kind().contains.contains(&effect.name())
        || effect.is_same(limited)
}

/// What a candidate gains over another one, stage by stage; `None` if one of them was not fitted.
fn gain_of(
    candidate: &Candidate,
    scope: &Scope,
    options: &SearchOptions,
) -> impl Fn(&Candidate) -> Option<Vec<Comparison>> {
    let of_candidate = candidate.fitted.as_ref().map(scores);
    move |other| {
        let of_other = scores(other.fitted.as_ref()?);
        Some(compare(&of_other, of_candidate.as_ref()?, &scope.stages, options))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::{Backlash, GrowingPart, PitchProgressive, ThermalGrowth};

    /// A screw that has grown within the shortest time that is searched has another lead; a gap it is not.
    #[test]
    fn a_slope_is_a_growth_at_the_limit_of_its_time() {
        let (part, um_per_m, time_constant_s) = (GrowingPart::Screw, 390.0, 0.5);
        let growth = Effect::ThermalGrowth(ThermalGrowth { part, um_per_m, time_constant_s });
        let slope = Effect::PitchProgressive(PitchProgressive { slope_um_per_m: 390.0 });
        assert!(is_other_form(&slope, &growth) && !is_other_form(&growth, &slope));
        assert!(!is_other_form(&Effect::Backlash(Backlash { width_um: 10.0 }), &growth));
    }
}
