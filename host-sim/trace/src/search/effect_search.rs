//! The search for effects that a model lacks, scope by scope. Effects that held-out data support are added one after the
//! other, and dropped again if later ones make them unnecessary.

use super::alternatives::with_better_alternatives;
use super::ambiguity::{dropped_rivals, is_other_form, prefer_fewer_parameters, rivals};
use super::candidates::{Candidate, Reference, rank};
use super::companion::{is_companion, is_remainder};
use super::held_out::{compare, scores};
use super::local_defect::local_defect;
use super::loop_check::LoopCheck;
use super::mass_check::takes_place_of_mass;
use super::missing_effects::missing_effects;
use super::other_form::with_better_forms;
use super::provisional::{self, is_gross};
use super::refinement::refined;
use super::round::Round;
use super::scale_noise_check::removes_only_noise;
use crate::analysis::residual_analysis::unexplained;
use crate::analysis::variable::Variable;
use crate::dropped::{Dropped, Reason};
use crate::fit::axis_model::AxisModel;
use crate::fit::exclusion::{ExcludedPart, Exclusion};
use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::intervals::{covariance, half_widths, has_unknown_shape, may_be_zero};
use crate::fit::least_squares::{self, Fitted};
use crate::fit::model_bias::{self, first_fit};
use crate::fit::scope::{Mechanics, Scope};
use crate::fit::scope_fit::ScopeFit;
use crate::stages::stage_names;
use crate::task::Progress;
use model::effects::{Effect, Stage};

/// The search for effects that the model of an axis lacks.
pub struct EffectSearch<'a> {
    /// The logs.
    pub data: &'a FitData<'a>,
    /// Called with a message for each step.
    pub progress: &'a Progress<'a>,
    /// The scope of the motor stage, if it can be evaluated.
    pub servo: Option<Scope>,
    /// The rounds so far.
    pub rounds: Vec<Round>,
    /// Effects of the scope that were added and dropped again.
    pub dropped: Vec<Effect>,
}

impl EffectSearch<'_> {
    /// Adds effects to one scope. The declared values of `start` are fitted.
    ///
    /// Without an effect, a fit may move the declared values out of their tolerance in its place, from where the effect gains
    /// too little. In this case the search is repeated with the tolerance as a bound, unless the effects of the first search
    /// brought the values back and left nothing that another effect could describe. The result of the second search is taken if,
    /// without the bound, and without the effects that the bound alone made necessary, it leaves less.
    #[must_use]
    pub fn search(&mut self, start: &AxisModel, scope: &Scope) -> ScopeFit {
        let first_round = self.rounds.len();
        let free = self.search_from(start, scope);
        let is_beyond = |model: &AxisModel| scope.mechanics == Mechanics::All && model.is_beyond_tolerance();
        if !is_beyond(&free.fitted.model) && (!is_beyond(start) || self.leaves_nothing(&free)) {
            return free;
        }
        let rounds_of_free = self.rounds.split_off(first_round);
        let mut bounded = self.search_from(&start.all_within_tolerance(), scope);
        let data = FitData { exclusions: &bounded.exclusions, ..*self.data };
        let unbounded = bounded.fitted.model.without_bounds();
        let unbounded = least_squares::fit(&data, &unbounded, scope, least_squares::STEPS);
        bounded.fitted = self.without_idle(&data, unbounded, scope);
        let left = |fit: &ScopeFit| {
            left_by(&FitData { exclusions: &fit.exclusions, ..*self.data }, &fit.fitted, scope)
        };
        if left(&bounded) < left(&free) - self.data.options.search.min_gain() {
            return bounded;
        }
        self.rounds.truncate(first_round);
        self.rounds.extend(rounds_of_free);
        free
    }

    /// Whether the residuals of a fit without exclusions depend on nothing that could show an effect.
    fn leaves_nothing(&self, fit: &ScopeFit) -> bool {
        let Fitted { model, residuals, .. } = &fit.fitted;
        let is_left = |&stage: &Stage| {
            let left = unexplained(self.data, residuals, stage, self.data.noise(model, stage));
            left.is_some_and(|left| left.variable != Variable::None)
        };
        fit.exclusions.is_empty() && !fit.scope.stages.iter().any(is_left)
    }

    /// Adds effects to one scope. If a part of the remaining residual must be excluded, the search is repeated with this
    /// exclusion.
    fn search_from(&mut self, start: &AxisModel, scope: &Scope) -> ScopeFit {
        let mut exclusions: Vec<Exclusion> = Vec::new();
        loop {
            let first_round = self.rounds.len();
            let data = FitData { exclusions: &exclusions, ..*self.data };
            let (mut fitted, bias) = self.add_effects(&data, start, scope);
            let data = FitData { bias: &bias, ..data };
            let mut new = new_exclusions(&data, &fitted, scope);
            let refused = self.rounds.last().and_then(|round| round.candidates.get(round.refused()?));
            if let (true, Some(refused)) = (new.is_empty(), refused.and_then(|c| c.fitted.as_ref())) {
                // A candidate may have been refused because of a part of the residual that is to be excluded.
                new = new_exclusions(&data, refused, scope);
            }
            let is_full = exclusions.len() >= self.data.options.exclusion.max_count;
            if new.is_empty() && !is_full {
                new.extend(local_defect(&data, &fitted, scope));
            }
            if new.is_empty() || is_full {
                if !exclusions.is_empty() {
                    fitted = self.drop_remains_of_exclusions(&data, fitted, scope);
                }
                return ScopeFit { scope: scope.clone(), fitted_scope: scope.clone(), fitted, exclusions };
            }
            self.rounds.truncate(first_round);
            exclusions.extend(new);
        }
    }

    /// Adds effects until none is supported, then drops those that became unnecessary. Also returns the error of the tracer's
    /// own simulation.
    fn add_effects(
        &mut self,
        data: &FitData<'_>,
        start: &AxisModel,
        scope: &Scope,
    ) -> (Fitted, Vec<ResidualSeries>) {
        let (mut base, mut bias) = first_fit(data, start, scope);
        self.dropped.clear();
        loop {
            let before;
            (base, bias, before) = self.add_until_none(data, base, bias, scope);
            let mut added = base.model.found().to_vec();
            base = self.drop_from(&FitData { bias: &bias, ..*data }, base, scope);
            if let Some(before) = before.filter(|_| !provisional::is_complete(data, &base, scope)) {
                (base, bias, self.rounds) = (before.fitted, before.bias, before.rounds);
                added = base.model.found().to_vec();
                base = self.drop_from(&FitData { bias: &bias, ..*data }, base, scope);
            }
            let is_left = |effect: &Effect| base.model.found().iter().any(|found| found.is_same(effect));
            let dropped: Vec<Effect> = added.into_iter().filter(|effect| !is_left(effect)).collect();
            // What was dropped may have hidden another effect. The search goes on once, without it.
            if dropped.is_empty() || !self.dropped.is_empty() {
                return (base, bias);
            }
            self.dropped = dropped;
        }
    }

    /// Adds effects until no further one is supported. Also returns the search before effects that are [`provisional`].
    fn add_until_none(
        &mut self,
        data: &FitData<'_>,
        mut base: Fitted,
        mut bias: Vec<ResidualSeries>,
        scope: &Scope,
    ) -> (Fitted, Vec<ResidualSeries>, Option<provisional::Before>) {
        let in_scope = |model: &AxisModel| model.found().iter().filter(|effect| scope.holds(effect)).count();
        let mut added = in_scope(&base.model);
        let mut before: Option<provisional::Before> = None;
        while added < data.options.search.max_effects {
            (base, bias) = without_bias(data, base, bias, scope);
            let data = &FitData { bias: &bias, ..*data };
            let origin = origin(data, &base, scope, added);
            let fitted = self
                .round(data, Reference { base: &base, origin: &origin }, scope)
                .or_else(|| self.add_provisionally(data, (&base, &bias), scope, &mut before));
            let Some(fitted) = fitted else { break };
            base = fitted;
            added += 1;
        }
        (base, bias, before)
    }

    /// Adds an effect that is not supported alone. The search before the first such effect is kept in `before`.
    fn add_provisionally(
        &mut self,
        data: &FitData<'_>,
        (base, bias): (&Fitted, &[ResidualSeries]),
        scope: &Scope,
        before: &mut Option<provisional::Before>,
    ) -> Option<Fitted> {
        let (index, fitted) = provisional::candidate(data, base, self.rounds.last()?, scope)?;
        before.get_or_insert_with(|| provisional::Before {
            fitted: base.clone(),
            bias: bias.to_vec(),
            rounds: self.rounds.clone(),
        });
        self.rounds.last_mut()?.added = Some(index);
        Some(fitted)
    }

    /// The fit with finer resolutions, and without effects that are unnecessary or uncertain.
    fn drop_from(&mut self, data: &FitData<'_>, mut base: Fitted, scope: &Scope) -> Fitted {
        let count = base.model.found().iter().filter(|effect| scope.holds(effect)).count();
        if count == 0 {
            return base;
        }
        // The derivatives of the search are in part those of earlier points.
        base = least_squares::fit(data, &base.model, scope, least_squares::STEPS);
        base = refined(data, base, scope);
        base = with_better_alternatives(data, base, &mut self.rounds, scope);
        base = with_better_forms(data, base, &mut self.rounds, scope);
        if count > 1 {
            base = self.drop_unnecessary(data, base, scope);
        }
        self.drop_uncertain(data, base, scope)
    }

    /// One round: tries all candidates and returns the fit with the best, if one is supported.
    fn round(&mut self, data: &FitData<'_>, reference: Reference<'_>, scope: &Scope) -> Option<Fitted> {
        let name = data.name();
        (self.progress)(&format!("{name}: trying the catalogue on {}", stage_names(&scope.stages)));
        let mut initial_guesses =
            missing_effects(data, (&reference.base.model, &reference.base.residuals), scope);
        initial_guesses.retain(|effect| !self.dropped.iter().any(|dropped| dropped.is_same(effect)));
        let mut candidates = rank(data, reference, scope, initial_guesses);
        prefer_fewer_parameters(&mut candidates, scope, &data.options.search);
        let best = self.best(data, reference.base, &mut candidates, scope);
        let added = best.as_ref().map(|(index, _)| *index);
        let ambiguities = best.as_ref().map_or_else(Vec::new, |(added, fitted)| {
            let dropped = dropped_rivals(data, (reference.base, fitted), &self.dropped, scope);
            [rivals(data, &candidates, *added, scope), dropped].concat()
        });
        if let Some(added) = added {
            (self.progress)(&format!("{name}: added {}", candidates[added].effect.name()));
        }
        let stages = scope.stages.clone();
        // Of earlier rounds only the effects and their comparisons are needed.
        self.rounds.iter_mut().for_each(Round::forget_data);
        let (dropped, options) = (Vec::new(), data.options.search);
        self.rounds.push(Round { stages, candidates, added, ambiguities, dropped, options });
        best.map(|(_, fitted)| fitted)
    }

    /// The best supported candidate whose fit to the optimum does not end at a limit of a parameter's range, with this fit.
    fn best(
        &self,
        data: &FitData<'_>,
        base: &Fitted,
        candidates: &mut [Candidate],
        scope: &Scope,
    ) -> Option<(usize, Fitted)> {
        let check = LoopCheck { data: self.data, servo: self.servo.as_ref(), scope };
        let at_limit = |candidate: &Candidate| {
            let passes_significance =
                candidate.limit.is_some() && candidate.passes_significance(&data.options.search);
            passes_significance.then(|| candidate.effect.clone())
        };
        let all_limited: Vec<Effect> = candidates.iter().filter_map(at_limit).collect();
        let mut limited: Vec<Effect> = Vec::new();
        for (index, candidate) in candidates.iter_mut().enumerate() {
            if !check.supports(&base.model, candidate) {
                limited.extend(at_limit(candidate));
                continue;
            }
            let Some(start) = &candidate.fitted else { continue };
            let steps = least_squares::STEPS;
            let fitted = least_squares::fit_from(data, &start.model, scope, steps, &start.columns);
            let last = fitted.model.found().len() - 1;
            candidate.limit = fitted.model.at_limit(last);
            // If a candidate ended at its limit, the true value may be beyond it, and this candidate may compensate a part of
            // the same deviation. Settings of one controller compensate each other.
            let may_replace =
                |limited: &[Effect]| limited.iter().any(|limited| !is_other_form(&candidate.effect, limited));
            let is_substitute = may_replace(&limited) && scope.stages == [Stage::Motor]
                || may_replace(&all_limited) && is_gross(data, &fitted, scope);
            let is_substitute = is_substitute
                || takes_place_of_mass(data, base, &fitted, scope)
                || removes_only_noise(data, base, &fitted, scope);
            if candidate.limit.is_none() && !is_substitute {
                return Some((index, fitted));
            }
            if candidate.limit.is_some() {
                limited.push(candidate.effect.clone());
            }
        }
        None
    }

    /// Drops effects that are small compared with the excluded parts: they describe remnants of these.
    fn drop_remains_of_exclusions(&mut self, data: &FitData<'_>, full: Fitted, scope: &Scope) -> Fitted {
        let min_effect = data.options.exclusion.min_effect;
        let with_excluded = self.data;
        let whole = with_excluded.residuals(&full.model, scope);
        let is_large = |without: &Fitted, with: &Fitted, stage: Stage| {
            let [before, after] = [without, with].map(|fit| data.rms(&fit.residuals, stage).powi(2));
            before - after > min_effect * with_excluded.rms(&whole, stage).powi(2)
        };
        self.dropping(full, scope, Reason::RemnantOfExclusion, |full, index| {
            let without = least_squares::fit_without(data, full, scope, index);
            let stages = &mut scope.stages.iter();
            (!stages.any(|&stage| is_large(&without, full, stage))).then_some(without)
        })
    }

    /// Drops effects whose size or shape is too uncertain, see [`may_be_zero`], [`has_unknown_shape`] and
    /// [`is_remainder`].
    fn drop_uncertain(&mut self, data: &FitData<'_>, full: Fitted, scope: &Scope) -> Fitted {
        self.dropping(full, scope, Reason::Uncertain, |full, index| {
            let effect = &full.model.found()[index];
            let half = half_widths(effect, &covariance(data, full), full.model.indices_of(scope, index));
            let is_uncertain = may_be_zero(effect, &half, &data.options.search)
                || has_unknown_shape(effect, &half)
                || is_remainder(effect, full.model.found());
            is_uncertain.then(|| least_squares::fit_without(data, full, scope, index))
        })
    }

    /// Drops effects that later ones made unnecessary.
    fn drop_unnecessary(&mut self, data: &FitData<'_>, full: Fitted, scope: &Scope) -> Fitted {
        let options = &data.options.search;
        self.dropping(full, scope, Reason::NotNeeded, |full, index| {
            let effect = full.model.found()[index].clone();
            if is_companion(&effect, full.model.found()) {
                return None;
            }
            let without = least_squares::fit_without(data, full, scope, index);
            let comparison = compare(&scores(&without), &scores(full), &scope.stages, options);
            let gain = comparison.iter().map(|c| c.gain).sum();
            let judged =
                Candidate { effect, comparison, gain, fitted: None, exceeds_tolerance: true, limit: None };
            let is_alone = scope.stages == [Stage::Force];
            let is_needed = judged.is_needed(options) || is_alone && judged.is_consistent(options);
            (!is_needed || removes_only_noise(data, &without, full, scope)).then_some(without)
        })
    }

    /// A fit without the effects without which it leaves as little: they made up for values that were bounded.
    fn without_idle(&mut self, data: &FitData<'_>, fitted: Fitted, scope: &Scope) -> Fitted {
        self.dropping(fitted, scope, Reason::MadeUpForBound, |fitted, index| {
            let without = least_squares::fit(data, &fitted.model.without(index), scope, least_squares::STEPS);
            let loss = left_by(data, &without, scope) - left_by(data, fitted, scope);
            (loss < data.options.search.min_gain()).then_some(without)
        })
    }

    /// Drops each effect of a scope for which `better` returns a fit without it.
    fn dropping(
        &mut self,
        mut full: Fitted,
        scope: &Scope,
        reason: Reason,
        better: impl Fn(&Fitted, usize) -> Option<Fitted>,
    ) -> Fitted {
        let mut index = 0;
        while let Some(effect) = full.model.found().get(index) {
            let Some(without) = scope.holds(effect).then(|| better(&full, index)).flatten() else {
                index += 1;
                continue;
            };
            let dropped = Dropped::new(effect, reason, self.data.name(), self.progress);
            if let Some(round) = self.rounds.last_mut() {
                round.dropped.push(dropped);
            }
            full = without;
        }
        full
    }
}

/// Sum over the stages of a scope of the logarithm of what a fit leaves.
fn left_by(data: &FitData<'_>, fitted: &Fitted, scope: &Scope) -> f64 {
    model_bias::log_rms(data, &data.residuals(&fitted.model, scope), scope)
}

/// Fits again with the tracer's own error recomputed from the fitted model, and returns fit and error if less remains. Both fits are compared at their
/// own optimum: one that was fitted with another error subtracted would seem to describe the logs worse with the right one.
fn without_bias(
    data: &FitData<'_>,
    base: Fitted,
    bias: Vec<ResidualSeries>,
    scope: &Scope,
) -> (Fitted, Vec<ResidualSeries>) {
    let new = model_bias::of(data, &base.model, scope);
    if new.is_empty() {
        return (base, bias);
    }
    let without = FitData { bias: &new, ..*data };
    let fitted = least_squares::fit_from(&without, &base.model, scope, least_squares::STEPS, &base.columns);
    if model_bias::is_less(data, [&base.residuals, &fitted.residuals], scope) {
        (fitted, new)
    } else {
        (base, bias)
    }
}

/// The point at which candidates start: the fitted values, or the nominal values in the first round of a mechanical scope
/// with a very large residual. A large effect, such as a wide gap, distorts the declared values up to their bounds, from
/// which no fit returns.
fn origin(data: &FitData<'_>, base: &Fitted, scope: &Scope, added: usize) -> Fitted {
    let ratio = data.options.search.min_gross_ratio;
    let is_gross = |&stage: &Stage| data.rms(&base.residuals, stage) > ratio * data.noise(&base.model, stage);
    if added > 0 || scope.mechanics != Mechanics::All || !scope.stages.iter().any(is_gross) {
        return base.clone();
    }
    least_squares::fit(data, &base.model.at_nominal(), scope, 0)
}

/// The parts of the remaining residuals that are to be excluded. An effect of any shape describes any position: what it leaves is not a
/// defect that no effect describes.
fn new_exclusions(data: &FitData<'_>, fitted: &Fitted, scope: &Scope) -> Vec<Exclusion> {
    let is_described = |exclusion: &Exclusion| {
        let is_of_stage = |effect: &Effect| effect.describes_any_shape_of() == Some(exclusion.stage);
        fitted.model.found().iter().any(is_of_stage) && !matches!(exclusion.part, ExcludedPart::Sine { .. })
    };
    let of_stage = |&stage: &Stage| {
        let noise = data.noise(&fitted.model, stage);
        unexplained(data, &fitted.residuals, stage, noise)?.exclusion(data, &fitted.residuals, noise)
    };
    scope.stages.iter().filter_map(of_stage).filter(|exclusion| !is_described(exclusion)).collect()
}
