//! The catalogue tried on a residual: screened by one linear step, then fitted, then cross-validated.

use nalgebra::DVector;
use rayon::prelude::*;

use super::held_out::{Comparison, Score, compare, scores};
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{self, Fitted, derivatives};
use crate::fit::limits::{self, ParameterAtLimit};
use crate::fit::normal_equations::{FOLDS, blocks, normal, stepped};
use crate::fit::scope::Scope;
use crate::options::SearchOptions;
use model::effects::Effect;

/// Most steps of a candidate's fit.
const STEPS: usize = 6;

/// A candidate and what it gains.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The effect with its best parameters.
    pub effect: Effect,
    /// On held-out data, by stage; empty if it was not fitted.
    pub comparison: Vec<Comparison>,
    /// Gain in log-likelihood a sample, summed over stages; on held-out data if fitted, else predicted by the linear step.
    pub gain: f64,
    /// The fit with it.
    pub fitted: Option<Fitted>,
    /// Whether it is larger than what a declared model leaves open in any case.
    pub exceeds_tolerance: bool,
    /// The parameter at a limit of its search range, if there is one.
    pub limit: Option<ParameterAtLimit>,
}

impl Candidate {
    /// Whether held-out data support it, and its parameters are within their limits.
    #[must_use]
    pub fn is_supported(&self, options: &SearchOptions) -> bool {
        self.limit.is_none() && self.stands_out(options)
    }

    /// Whether held-out data support it: some stage improves by more than chance and in every fold, and no stage of any
    /// log loses more than a small fraction of what is gained.
    #[must_use]
    pub fn stands_out(&self, options: &SearchOptions) -> bool {
        self.helps(options, options.min_t)
    }

    /// The same as [`Self::is_supported`] without the comparison with chance.
    #[must_use]
    pub fn is_consistent(&self, options: &SearchOptions) -> bool {
        self.limit.is_none() && self.helps(options, 0.0)
    }

    fn helps(&self, options: &SearchOptions, min_t: f64) -> bool {
        let is_better =
            |c: &Comparison| c.reduction >= options.min_reduction && c.t >= min_t && c.folds_better == FOLDS;
        let loss = |c: &Comparison| 0.5 * (1.0 - c.worst_log.min(0.0)).ln();
        let tolerable = options.min_gain().max(options.max_loss * self.gain);
        self.exceeds_tolerance
            && self.comparison.iter().any(is_better)
            && self.comparison.iter().all(|c| loss(c) < tolerable)
    }
}

/// The fits that candidates are compared with and start from.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    /// The fit without a further effect.
    pub base: &'a Fitted,
    /// Where the candidates' fits start.
    pub origin: &'a Fitted,
}

/// Tries every initial guess; the best candidates come first, fitted ones with their comparison on held-out data.
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

/// One linear step from an initial guess with all parameters free: the gain that it predicts.
fn screen(data: &FitData<'_>, reference: Reference<'_>, scope: &Scope, effect: Effect) -> Candidate {
    let Reference { base, origin } = reference;
    let model = origin.model.with(effect.clone());
    let parameters = model.free_parameters(scope);
    let residuals = data.residuals(&model, scope);
    // The new effect's parameters are the last ones; the derivatives of the others are those of the origin.
    let shared = origin.columns.len();
    let mut columns = origin.columns.clone();
    columns.extend(derivatives(data, &model, scope, shared..parameters.len(), &residuals));
    let blocks = blocks(data, &columns, &residuals, &base.weights);
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
    let gain = scope.stages.iter().map(|&s| 0.5 * (base.squares(s) / after(s).max(1e-9)).ln()).sum();
    // A full fit starts from the origin, with the effect as after the step.
    moved.rows_mut(0, shared).copy_from(&start.rows(0, shared));
    let effect = model.at(scope, moved.as_slice()).axis.effect.last().cloned().unwrap_or(effect);
    Candidate { effect, comparison: Vec::new(), gain, fitted: None, exceeds_tolerance: false, limit: None }
}

/// Keeps the best of several initial guesses of one effect. Sources of one effect are different effects, and so are its
/// forms with another number of coordinates.
fn keep_best_guess(sorted: &mut Vec<Candidate>) {
    let mut known: Vec<(&'static str, Option<String>, usize)> = Vec::new();
    sorted.retain(|Candidate { effect, .. }| {
        let source = effect.distinction().source().map(str::to_owned);
        let identity = (effect.name(), source, effect.coordinates().len());
        let is_new = !known.contains(&identity);
        known.push(identity);
        is_new
    });
}

/// Fits a candidate with everything else free, and compares it on held-out data.
fn try_out(
    data: &FitData<'_>,
    origin: &Fitted,
    scope: &Scope,
    candidate: &mut Candidate,
    held_out: &[Score],
) {
    let start = origin.model.with(candidate.effect.clone());
    let fitted = least_squares::fit_from(data, &start, scope, STEPS, &origin.columns);
    candidate.comparison = compare(held_out, &scores(&fitted), &scope.stages, &data.options.search);
    candidate.gain = candidate.comparison.iter().map(|c| c.gain).sum();
    if let Some(effect) = fitted.model.axis.effect.last() {
        candidate.effect = effect.clone();
    }
    candidate.exceeds_tolerance =
        candidate.effect.exceeds_tolerance(&origin.model.nominal().settings, data.rates);
    candidate.limit = limits::of(&candidate.effect, data.rates);
    candidate.fitted = Some(fitted);
}
