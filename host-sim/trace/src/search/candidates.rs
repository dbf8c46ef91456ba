//! The candidates of a round: screened by one linear step, then fitted, then cross-validated.

use std::mem::{Discriminant, discriminant};

use nalgebra::DVector;
use rayon::prelude::*;

use super::companion::{with_companion, with_variation};
use super::held_out::{Comparison, Score, compare, scores};
use super::several_of_kind::{at_best_start, with_free_coordinates};
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{self, Fitted, derivatives};
use crate::fit::limits::{self, ParameterAtLimit};
use crate::fit::model_bias;
use crate::fit::normal_equations::{Column, FOLDS, Known, normal, renewed_blocks, stepped};
use crate::fit::scope::Scope;
use crate::options::SearchOptions;
use model::effects::{Effect, KINDS, Stage};

/// Largest number of steps of a candidate's fit.
const STEPS: usize = 6;

/// A candidate and its gain.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The effect with its best parameters.
    pub effect: Effect,
    /// Comparison on held-out data, by stage; empty if the candidate was not fitted.
    pub comparison: Vec<Comparison>,
    /// Gain in log-likelihood per sample, summed over stages; on held-out data if fitted, otherwise predicted by the linear
    /// step.
    pub gain: f64,
    /// The fit with the effect, if it was fitted.
    pub fitted: Option<Fitted>,
    /// See [`model::effects::EffectModel::exceeds_tolerance`]; false before the fit.
    pub exceeds_tolerance: bool,
    /// The parameter at a limit of its search range, if there is one.
    pub limit: Option<ParameterAtLimit>,
}

impl Candidate {
    /// Whether held-out data support the effect, and its parameters are within their limits.
    #[must_use]
    pub fn is_supported(&self, options: &SearchOptions) -> bool {
        self.limit.is_none() && self.passes_significance(options)
    }

    /// Whether held-out data support the effect: at least one stage improves significantly and in every fold, and in no log
    /// does a stage lose more than a small fraction of the total gain.
    #[must_use]
    pub fn passes_significance(&self, options: &SearchOptions) -> bool {
        self.meets_criteria(options, |c| c.t >= c.min_t, |c| c.worst_log)
    }

    /// Whether held-out data support an effect that is to be kept beside others. A loss of a stage counts only if the fitted data show it, too: a fit
    /// without a fold determines a map of many knots poorly, so that its error on that fold changes by chance.
    #[must_use]
    pub fn is_needed(&self, options: &SearchOptions) -> bool {
        self.meets_criteria(options, |c| c.t >= c.min_t, |c| c.worst_log.max(c.worst_fitted_log))
    }

    /// As [`Self::is_supported`], without the test of significance.
    #[must_use]
    pub fn is_consistent(&self, options: &SearchOptions) -> bool {
        self.limit.is_none() && self.meets_criteria(options, |c| c.t >= 0.0, |c| c.worst_log)
    }

    fn meets_criteria(
        &self,
        options: &SearchOptions,
        is_significant: impl Fn(&Comparison) -> bool,
        worst_log: impl Fn(&Comparison) -> f64,
    ) -> bool {
        let is_better = |c: &Comparison| {
            is_shown_in(&self.effect, c.stage)
                && c.reduction.min(c.fitted_reduction) >= options.min_reduction
                && c.evidence >= options.min_evidence
                && is_significant(c)
                && c.folds_better == FOLDS
        };
        let loss = |c: &Comparison| 0.5 * libm::log(1.0 - worst_log(c).min(0.0));
        let tolerable = options.tolerable_loss(self.gain);
        self.exceeds_tolerance
            && self.comparison.iter().any(is_better)
            && self.comparison.iter().all(|c| loss(c) < tolerable)
    }
}

/// Whether a gain in a stage may show the effect. An error of a position that only the table shows changes the force as well,
/// by the acceleration that follows the error: a wave of nanometres would explain any short piece of a force.
fn is_shown_in(effect: &Effect, stage: Stage) -> bool {
    let mut kinds = KINDS.iter().filter(|kind| kind.name == effect.name());
    matches!(stage, Stage::Table | Stage::Tool) || kinds.any(|kind| kind.shown_in != [Stage::Table])
}

/// The fits that candidates are compared with and start from.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    /// The fit without the candidate.
    pub base: &'a Fitted,
    /// The point at which the fits of the candidates start.
    pub origin: &'a Fitted,
}

/// Tries all initial guesses and returns the candidates, best first. The most promising ones are fitted and compared on
/// held-out data.
#[must_use]
pub fn rank(
    data: &FitData<'_>,
    reference: Reference<'_>,
    scope: &Scope,
    initial_guesses: Vec<Effect>,
) -> Vec<Candidate> {
    let options = &data.options.search;
    let mut screened: Vec<Candidate> = initial_guesses
        .into_par_iter()
        .filter(|effect| scope.holds(effect))
        .map(|effect| screen(data, reference, scope, effect))
        .collect();
    screened.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    keep_best_guess(&mut screened);

    let held_out = scores(reference.base);
    let min_gain = options.promising * options.min_gain();
    let promising = screened.iter().take_while(|candidate| candidate.gain > min_gain).count();
    let fitted = promising.min(options.fitted_candidates);
    screened[..fitted]
        .par_iter_mut()
        .for_each(|candidate| try_out(data, reference.origin, scope, candidate, &held_out));
    screened[..fitted].sort_by(|a, b| b.gain.total_cmp(&a.gain));
    screened
}

/// Predicts the gain of an initial guess by one linear step with all parameters free.
fn screen(data: &FitData<'_>, reference: Reference<'_>, scope: &Scope, effect: Effect) -> Candidate {
    let Reference { base, origin } = reference;
    let model = origin.model.with(effect.clone());
    let parameters = model.free_parameters(scope);
    let residuals = data.residuals(&model, scope);
    // The parameters of the new effect are the last ones. The derivatives with respect to the others are those of the origin.
    let shared = origin.columns.len();
    let mut columns = origin.columns.clone();
    let new: Vec<usize> = (shared..parameters.len()).collect();
    columns.extend(derivatives(data, &model, scope, &new, &residuals));
    let known = Known { blocks: &origin.blocks, renewed: &new };
    let blocks = renewed_blocks(data, &columns, known, &residuals, &base.weights);
    let (curvature, gradient) = normal(&blocks, &parameters);
    let start = DVector::from_iterator(
        parameters.len(),
        parameters.iter().map(|parameter| parameter.coordinate.value),
    );
    let mut moved = DVector::from_vec(stepped(&parameters, &curvature, &gradient, 1e-4));
    let step = &moved - &start;
    let after = |stage| {
        let blocks = blocks.iter().filter(|block| block.stage == stage);
        blocks
            .map(|b| b.squares + 2.0 * b.gradient.dot(&step) + step.dot(&(&b.curvature * &step)))
            .sum::<f64>()
    };
    let gain = scope.stages.iter().map(|&s| 0.5 * libm::log(base.squares(s) / after(s).max(1e-9))).sum();
    // A full fit starts from the origin with the effect after the step.
    moved.rows_mut(0, shared).copy_from(&start.rows(0, shared));
    let effect = model.at(scope, moved.as_slice()).axis.effect.last().cloned().unwrap_or(effect);
    Candidate { effect, comparison: Vec::new(), gain, fitted: None, exceeds_tolerance: false, limit: None }
}

/// Keeps the best of several initial guesses of one effect. Effects of different kinds, of different sources, or with different
/// numbers of coordinates, are different effects.
fn keep_best_guess(sorted: &mut Vec<Candidate>) {
    let mut known: Vec<(Discriminant<Effect>, Option<String>, usize)> = Vec::new();
    sorted.retain(|Candidate { effect, .. }| {
        let source = effect.distinction().source().map(str::to_owned);
        let identity = (discriminant(effect), source, effect.coordinates().len());
        let is_new = !known.contains(&identity);
        known.push(identity);
        is_new
    });
}

/// Fits a candidate with all other parameters free, and compares it on held-out data. An effect that is not supported is
/// tried again with its variation over the position, if it has one, which then is the candidate.
fn try_out(
    data: &FitData<'_>,
    origin: &Fitted,
    scope: &Scope,
    candidate: &mut Candidate,
    held_out: &[Score],
) {
    let fit = |start: &AxisModel, columns: &[Column]| {
        judged(
            data,
            &origin.model,
            scope,
            held_out,
            least_squares::fit_from(data, start, scope, STEPS, columns),
        )
    };
    let start = with_companion(&origin.model, candidate.effect.clone());
    let (start, columns) = with_free_coordinates(start, scope, &origin.columns);
    *candidate = fit(&start, columns).unwrap_or_else(|| candidate.clone());
    let gains = candidate.gain >= data.options.search.min_gain();
    let better_start =
        candidate.fitted.as_ref().filter(|_| gains).and_then(|fitted| at_best_start(data, fitted, scope));
    if let Some(refitted) = better_start.and_then(|start| fit(&start, &[])) {
        *candidate = refitted;
    }
    let other_form =
        candidate.fitted.as_ref().filter(|_| gains).and_then(|fitted| in_other_form(&fitted.model));
    let other_form = other_form.and_then(|start| fit(&start, &[]));
    if let Some(other_form) = other_form.filter(|other| other.gain > candidate.gain) {
        *candidate = other_form;
    }
    let options = &data.options.search;
    if candidate.is_supported(options) || candidate.gain < options.min_gain() {
        return;
    }
    if let Some(unbiased) = without_own_error(data, origin, scope, candidate, held_out) {
        *candidate = unbiased;
        return;
    }
    let varying = candidate
        .fitted
        .as_ref()
        .and_then(|fitted| fit(&with_variation(data, fitted, scope, &candidate.effect)?, &fitted.columns));
    if let Some(varying) = varying.filter(|varying| varying.is_supported(options)) {
        *candidate = varying;
    }
}

/// The model with its last effect in its other form.
fn in_other_form(model: &AxisModel) -> Option<AxisModel> {
    model.in_other_form(model.found().len().checked_sub(1)?)
}

/// A candidate that gains so much that its refusal would be reported, judged with the error of the tracer's own simulation computed from its model, if
/// it is supported then. The error that is subtracted from the logs is that of the model without the candidate: beside a gap, a ripple of the
/// force changes it by twenty times the noise. Its fit remains that of the logs which the other candidates are fitted to.
fn without_own_error(
    data: &FitData<'_>,
    origin: &Fitted,
    scope: &Scope,
    candidate: &Candidate,
    held_out: &[Score],
) -> Option<Candidate> {
    let options = &data.options.search;
    let is_large = candidate.exceeds_tolerance && candidate.gain > options.min_reported_gain;
    let fitted = candidate.fitted.as_ref().filter(|_| is_large && candidate.limit.is_none())?;
    let bias = model_bias::of(data, &fitted.model, scope);
    if bias.is_empty() {
        return None;
    }
    let data = &FitData { bias: &bias, ..*data };
    let refitted = least_squares::fit_from(data, &fitted.model, scope, STEPS, &fitted.columns);
    let unbiased = judged(data, &origin.model, scope, held_out, refitted)?;
    unbiased.is_supported(options).then(|| Candidate { fitted: Some(fitted.clone()), ..unbiased })
}

/// The effect that was added last, with its fit and its comparison on held-out data.
fn judged(
    data: &FitData<'_>,
    origin: &AxisModel,
    scope: &Scope,
    held_out: &[Score],
    fitted: Fitted,
) -> Option<Candidate> {
    let effect = fitted.model.axis.effect.last()?.clone();
    let comparison = compare(held_out, &scores(&fitted), &scope.stages, &data.options.search);
    let gain = comparison.iter().map(|c| c.gain).sum();
    let exceeds_tolerance = effect.exceeds_tolerance(&origin.nominal().settings, data.rates);
    let limit = limits::of(&effect, data.rates);
    Some(Candidate { effect, comparison, gain, fitted: Some(fitted), exceeds_tolerance, limit })
}
