//! Removal of effects with a parameter at a limit of its range, and of effects that the validation logs refute.

use super::found_effect::FoundEffect;
use super::likelihood::refuting_loss_over_all;
use super::refutation;
use crate::dropped::{Dropped, Reason};
use crate::fit::fit_data::{FitAndValidationRms, FitData, ResidualSeries};
use crate::fit::fitted_axis::FittedAxis;
use crate::fit::intervals::{has_unknown_shape, may_be_zero};
use crate::fit::least_squares;
use crate::fit::limits::ParameterAtLimit;
use crate::fit::scope::Scope;
use crate::fit::scope_fit::{ScopeFit, fitted_in_order};
use crate::search::companion::{is_companion, is_remainder};
use crate::search::round::{Round, refused_at_limit};
use crate::task::Progress;
use model::effects::{Effect, Stage};

/// Largest number of steps of a fit of the other parameters, after an effect was added with its final parameters.
const STEPS: usize = 3;

/// Number of coordinates of an effect from which it must improve the validation logs, and not only not make them worse: of all effects, only
/// maps over a position have as many.
pub const MANY_COORDINATES: usize = 4;

/// A model without refuted effects and without effects at a limit, and what was dropped.
pub struct Confirmed {
    /// The model and its fits.
    pub axis: FittedAxis,
    /// Effects of the model, in the order in which they were added.
    pub found: Vec<FoundEffect>,
    /// Effects with a parameter at a limit, after the final fit or in the search.
    pub refused: Vec<ParameterAtLimit>,
    /// Effects that the validation logs refute.
    pub refuted: Vec<FoundEffect>,
    /// All effects that were dropped, with the reasons.
    pub dropped: Vec<Dropped>,
}

/// Drops effects that ended at a limit in the final fit, and effects that the validation logs refute, one after the other.
#[must_use]
pub fn confirm(
    [fit_data, validate]: [&FitData<'_>; 2],
    mut axis: FittedAxis,
    stages: &[Stage],
    rounds: &[Round],
    progress: &Progress<'_>,
) -> Confirmed {
    let name = fit_data.name();
    let (mut refused, mut refuted, mut dropped) = (Vec::new(), Vec::new(), Vec::new());
    let mut leaves =
        |effect: &Effect, reason: Reason| dropped.push(Dropped::new(effect, reason, name, progress));
    loop {
        if let Some((index, limit)) = axis.model.first_at_limit() {
            let simpler = limit.effect.at_its_limit();
            if simpler.is_none() {
                leaves(&limit.effect, Reason::AtLimit);
                refused.push(limit);
            }
            axis = axis.changed(fit_data, index, simpler);
            continue;
        }
        let options = &fit_data.options.search;
        let nominal = &axis.model.nominal().settings;
        let is_not_shown = |&index: &usize| {
            let effect = &axis.model.found()[index];
            let half_widths = axis.half_widths(fit_data, index);
            may_be_zero(effect, &half_widths, options)
                || has_unknown_shape(effect, &half_widths)
                || is_remainder(effect, axis.model.found())
                || !effect.exceeds_tolerance(nominal, fit_data.rates)
        };
        if let Some(index) = (0..axis.model.found().len()).find(is_not_shown) {
            leaves(&axis.model.found()[index], Reason::NotShown);
            axis = axis.without(fit_data, index);
            continue;
        }
        progress(&format!("{name}: testing what was found on the validation logs"));
        let reported = reported(fit_data, validate, &axis);
        // The reported intervals contain what earlier fits leave uncertain, too.
        if let Some(one) = reported.iter().find(|one| one.found.may_be_zero()) {
            leaves(&one.found.effect, Reason::IntervalContainsZero);
            axis = axis.without(fit_data, one.index);
            continue;
        }
        let losses = reported.iter().filter_map(|one| Some((one.loss?, one)));
        // First each effect is tested as it was added, without the later ones; then by removing only this effect.
        if let Some((_, one)) = losses.min_by(|a, b| a.0.total_cmp(&b.0)) {
            leaves(&one.found.effect, Reason::Refuted);
            axis = axis.without(fit_data, one.index);
            refuted.push(one.found.clone());
        } else if let Some(refutation) = refutation::worst(fit_data, validate, &axis, stages) {
            leaves(&refutation.found.effect, Reason::Refuted);
            axis = refutation.without;
            refuted.push(refutation.found);
        } else {
            let found =
                reported.into_iter().map(|one| one.shown([fit_data, validate], &axis, stages)).collect();
            add_refused(&mut refused, &axis, rounds);
            return Confirmed { axis, found, refused, refuted, dropped };
        }
    }
}

/// Adds the effects that the search refused at a limit, unless they were found or are already in the list.
fn add_refused(refused: &mut Vec<ParameterAtLimit>, axis: &FittedAxis, rounds: &[Round]) {
    for limit in refused_at_limit(rounds) {
        let is_same = |effect: &Effect| effect.is_same(&limit.effect);
        if !axis.model.found().iter().any(is_same) && !refused.iter().any(|at| is_same(&at.effect)) {
            refused.push(limit);
        }
    }
}

/// A found effect with its validation.
struct Reported {
    found: FoundEffect,
    /// Index in [`AxisModel::found`](crate::fit::axis_model::AxisModel::found).
    index: usize,
    /// The (negative) gain in log-likelihood of the validation logs, if it refutes the effect.
    loss: Option<f64>,
}

impl Reported {
    /// The effect with the residuals that show it best: if it did not reduce any as it was first added, because effects that were
    /// added later hid it, those of the final model without it and with it.
    fn shown(self, data: [&FitData<'_>; 2], axis: &FittedAxis, stages: &[Stage]) -> FoundEffect {
        if self.found.validate_reduction_percent() > 0.0 {
            return self.found;
        }
        match refutation::reduced_beside_others(data, axis, self.index, stages) {
            Some((stage, before, after)) if after.validate < before.validate => {
                FoundEffect { stage, before, after, ..self.found }
            }
            _ => self.found,
        }
    }
}

/// The effects found, each with its confidence intervals and with two residuals: of the model with the effects before it,
/// and of the model that also contains it.
fn reported(fit_data: &FitData<'_>, validate: &FitData<'_>, axis: &FittedAxis) -> Vec<Reported> {
    let mut all = Vec::new();
    let mut last = axis.baseline.clone();
    for ScopeFit { scope, exclusions, .. } in &axis.fits {
        let data = FitData { exclusions, ..*fit_data };
        for (index, effect) in axis.model.found().iter().enumerate() {
            if !scope.holds(effect) {
                continue;
            }
            let with = last.with(effect.clone());
            // An assumed effect goes with other masses.
            let next = if (effect.kind().assumed)().is_empty() {
                least_squares::fit(&data, &with, scope, STEPS).model
            } else {
                let scopes = axis.fits.iter().map(|fit| (&fit.scope, &fit.exclusions[..]));
                fitted_in_order(fit_data, with, scopes)
            };
            let fitted = [&last, &next].map(|model| fit_data.residuals(model, scope));
            let held_out = [&last, &next].map(|model| validate.residuals(model, scope));
            // A slope is tested with its map.
            let loss = refuting_loss_over_all(validate, [&held_out[0], &held_out[1]])
                .filter(|_| !is_companion(effect, axis.model.found()));
            let residuals = Residuals { fit_data, validate, fitted, held_out };
            // The stage with the largest improvement; for a refuted effect, the stage with the largest deterioration.
            let sign = if loss.is_some() { -1.0 } else { 1.0 };
            let Some((stage, before, after)) = residuals.most_changed(scope, sign) else { continue };
            // Many parameters follow the chance of the fitted logs: without any gain on others they are refuted.
            let has_many = effect.coordinates().len() >= MANY_COORDINATES;
            let loss = loss.or_else(|| {
                (has_many && after.validate > before.validate)
                    .then(|| libm::log(before.validate / after.validate))
            });
            let half_widths = axis.full_half_widths(fit_data, index);
            let effect = effect.clone();
            let found = FoundEffect::new((effect, half_widths), stage, [before, after]);
            all.push(Reported { found, index, loss });
            last = next;
        }
    }
    all
}

/// Residuals without an effect and with it.
struct Residuals<'a> {
    fit_data: &'a FitData<'a>,
    validate: &'a FitData<'a>,
    fitted: [Vec<ResidualSeries>; 2],
    held_out: [Vec<ResidualSeries>; 2],
}

impl Residuals<'_> {
    /// The stage with the largest reduction of the residual of the validation logs (sign −1: the smallest), and its
    /// residuals without and with the effect.
    fn most_changed(
        &self,
        scope: &Scope,
        sign: f64,
    ) -> Option<(Stage, FitAndValidationRms, FitAndValidationRms)> {
        let pair = |model: usize, stage| FitAndValidationRms {
            fit: self.fit_data.rms(&self.fitted[model], stage),
            validate: self.validate.rms(&self.held_out[model], stage),
        };
        let stages = scope.stages.iter().map(|&stage| (stage, pair(0, stage), pair(1, stage)));
        let reduction = |(_, before, after): &(Stage, FitAndValidationRms, FitAndValidationRms)| {
            1.0 - after.validate / before.validate.max(f64::MIN_POSITIVE)
        };
        stages.max_by(|a, b| (sign * reduction(a)).total_cmp(&(sign * reduction(b))))
    }
}
