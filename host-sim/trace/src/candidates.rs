//! The catalogue tried on a residual: screened by one linear step, then fitted, then held out.

use nalgebra::DVector;
use rayon::prelude::*;

use super::fit::{self, Fitted, blocks, derivatives, normal, stepped};
use super::held_out::{Comparison, FOLDS, Score, compare, scores};
use super::limits::{self, AtLimit};
use super::residual::Evidence;
use super::scope::Scope;
use model::effects::Effect;

/// Candidates that get a full fit.
const FITTED: usize = 4;

/// A linear step that gains less promises nothing: a quarter of what [`LEAST_REDUCTION`] gains. Of 800 candidates of 30
/// traces none that was supported in the end had promised less than four times as much.
const PROMISING: f64 = 0.25 * 0.5 * LEAST_REDUCTION;

/// Steps of a candidate's fit.
const FIT_STEPS: usize = 6;

/// A candidate must take this share of Σr² of some stage away on held-out data…
pub const LEAST_REDUCTION: f64 = 0.04;

/// …by this many standard errors over the blocks of the logs. With some thirty candidates a round, a
/// normal deviate passes 3.5 by chance in one round of a hundred; blocks are few and their errors
/// have long tails, so a clean machine is tested besides (`tests/`).
pub const LEAST_T: f64 = 3.5;

/// A candidate and what it is worth.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The effect at its best parameters.
    pub effect: Effect,
    /// On held-out data, by stage; empty if it was screened out.
    pub comparison: Vec<Comparison>,
    /// Gain per sample in the log-likelihood, summed over stages; held out if fitted, else predicted.
    pub gain: f64,
    /// The fit with it.
    pub fitted: Option<Fitted>,
    /// Whether it is larger than what a declared model leaves open in any case.
    pub material: bool,
    /// The parameter that stands at a limit of its search, if one does: then it is no measurement.
    pub limit: Option<AtLimit>,
}

impl Candidate {
    /// Whether held-out data support it, and its parameters were found within their limits.
    #[must_use]
    pub fn is_supported(&self) -> bool {
        self.limit.is_none() && self.stands_out()
    }

    /// Whether held-out data support it: some stage gets better beyond chance and in every fold, and no
    /// stage of any log loses more than chance, or than a tenth of what is gained in all.
    #[must_use]
    pub fn stands_out(&self) -> bool {
        self.helps(LEAST_T)
    }

    /// The same as [`Self::is_supported`] without its standing out of chance.
    #[must_use]
    pub fn is_consistent(&self) -> bool {
        self.limit.is_none() && self.helps(0.0)
    }

    fn helps(&self, least_t: f64) -> bool {
        let better =
            |c: &Comparison| c.reduction >= LEAST_REDUCTION && c.t >= least_t && c.folds_better == FOLDS;
        let loss = |c: &Comparison| 0.5 * (1.0 - c.worst_log.min(0.0)).ln();
        let tolerable = (0.5 * LEAST_REDUCTION).max(0.1 * self.gain);
        self.material
            && self.comparison.iter().any(better)
            && self.comparison.iter().all(|c| loss(c) < tolerable)
    }
}

/// Tries every starting point, from the declared values of `origin`, against what `base` explains; the best come first,
/// fitted ones with their held-out comparison.
#[must_use]
pub fn rank(
    evidence: &Evidence<'_>,
    base: &Fitted,
    origin: &Fitted,
    scope: &Scope,
    starts: Vec<Effect>,
) -> Vec<Candidate> {
    let mut screened: Vec<Candidate> = starts
        .into_par_iter()
        .filter(|effect| scope.holds(effect))
        .map(|effect| screen(evidence, [base, origin], scope, effect))
        .collect();
    screened.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    keep_best_start(&mut screened);

    let held_out = scores(base);
    let promising = screened.iter().take_while(|candidate| candidate.gain > PROMISING).count();
    let fitted = promising.min(FITTED);
    screened[..fitted]
        .par_iter_mut()
        .for_each(|candidate| try_out(evidence, origin, scope, candidate, &held_out));
    screened[..fitted].sort_by(|a, b| b.gain.total_cmp(&a.gain));
    screened
}

/// One linear step from the candidate's start, all slots free: what it could gain at the best.
fn screen(evidence: &Evidence<'_>, [base, origin]: [&Fitted; 2], scope: &Scope, effect: Effect) -> Candidate {
    let model = origin.model.with(effect.clone());
    let slots = model.slots(scope);
    let parts = evidence.residuals(&model, scope);
    // The new effect's slots are the last ones; the derivatives of the others hold near the start, too.
    let shared = origin.columns.len();
    let mut columns = origin.columns.clone();
    columns.extend(derivatives(evidence, &model, scope, shared..slots.len(), &parts));
    let blocks = blocks(evidence, &columns, &parts, &base.weights);
    let (curvature, gradient) = normal(&blocks, &slots);
    let stood = DVector::from_iterator(slots.len(), slots.iter().map(|slot| slot.coordinate.value));
    let mut moved = DVector::from_vec(stepped(&slots, &curvature, &gradient, 1e-4));
    let step = &moved - &stood;
    let after = |stage| {
        let blocks = blocks.iter().filter(|block| block.stage == stage);
        blocks
            .map(|b| b.squares + 2.0 * b.gradient.dot(&step) + step.dot(&(&b.curvature * &step)))
            .sum::<f64>()
    };
    let gain = scope.stages.iter().map(|&s| 0.5 * (base.squares(s) / after(s).max(1e-9)).ln()).sum();
    // A full fit starts from the origin with the effect where the step took it.
    moved.rows_mut(0, shared).copy_from(&stood.rows(0, shared));
    let effect = model.at(scope, moved.as_slice()).axis.effect.last().cloned().unwrap_or(effect);
    Candidate { effect, comparison: Vec::new(), gain, fitted: None, material: false, limit: None }
}

/// Of several guesses of one effect the best stays. Sources of one effect are different effects, and so are its forms
/// with another number of coordinates.
fn keep_best_start(sorted: &mut Vec<Candidate>) {
    let mut seen: Vec<(&'static str, Option<String>, usize)> = Vec::new();
    sorted.retain(|Candidate { effect, .. }| {
        let source = effect.distinction().source().map(str::to_owned);
        let kind = (effect.name(), source, effect.coordinates().len());
        let new = !seen.contains(&kind);
        seen.push(kind);
        new
    });
}

/// Fits a candidate with everything else free, and holds it against held-out data.
fn try_out(
    evidence: &Evidence<'_>,
    origin: &Fitted,
    scope: &Scope,
    candidate: &mut Candidate,
    held_out: &[Score],
) {
    let start = origin.model.with(candidate.effect.clone());
    let fitted = fit::fit_from(evidence, &start, scope, FIT_STEPS, &origin.columns);
    candidate.comparison = compare(held_out, &scores(&fitted), &scope.stages);
    candidate.gain = candidate.comparison.iter().map(|c| c.gain).sum();
    if let Some(effect) = fitted.model.axis.effect.last() {
        candidate.effect = effect.clone();
    }
    candidate.material = candidate.effect.exceeds_tolerance(&origin.model.nominal().settings, evidence.rates);
    candidate.limit = limits::of(&candidate.effect, evidence.rates);
    candidate.fitted = Some(fitted);
}
