//! Effects that the fit logs support and the validation logs refute.
//!
//! A found effect is removed, and all other parameters are fitted again to the fit logs. If this raises the log-likelihood of
//! the validation logs significantly, the effect is reported as refuted and is not part of the model.

use rayon::prelude::*;

use super::fitted_axis::FittedAxis;
use super::found_effect::FoundEffect;
use super::likelihood::refuting_loss;
use crate::fit::fit_data::{FitAndValidationRms, FitData};
use crate::fit::scope::{Mechanics, Scope};
use model::effects::Stage;

/// A refuted effect, and the model without it.
pub struct Refutation {
    /// The effect, with the residual of the stage that it increases most: `before` without, `after` with the effect.
    pub found: FoundEffect,
    /// The model without the effect.
    pub without: FittedAxis,
}

/// The found effect that the validation logs refute with the largest loss, if they refute any.
#[must_use]
pub fn worst(
    fit_data: &FitData<'_>,
    validate: &FitData<'_>,
    axis: &FittedAxis,
    stages: &[Stage],
) -> Option<Refutation> {
    let judged = |index: usize| {
        let effect = &axis.model.found()[index];
        let stages = effect.stages().iter().copied().filter(|stage| stages.contains(stage)).collect();
        let scope = Scope { stages, mechanics: Mechanics::None };
        let without = axis.without(fit_data, index);
        let models = [&without.model, &axis.model];
        let held_out = models.map(|model| validate.residuals(model, &scope));
        let gain = refuting_loss(validate, [&held_out[0], &held_out[1]])?;
        let fitted = models.map(|model| fit_data.residuals(model, &scope));
        let pair = |model: usize, stage| FitAndValidationRms {
            fit: fit_data.rms(&fitted[model], stage),
            validate: validate.rms(&held_out[model], stage),
        };
        let of_stage = |&stage: &Stage| (stage, pair(0, stage), pair(1, stage));
        let shown = scope.stages.iter().map(of_stage).filter(|(_, before, _)| before.validate > 0.0);
        let ratio = |(_, before, after): &(Stage, FitAndValidationRms, FitAndValidationRms)| {
            after.validate / before.validate
        };
        let (stage, before, after) = shown.max_by(|a, b| ratio(a).total_cmp(&ratio(b)))?;
        let found = FoundEffect {
            effect: effect.clone(),
            half_widths: axis.half_widths(fit_data, index),
            stage,
            before,
            after,
            rivals: Vec::new(),
        };
        Some((gain, Refutation { found, without }))
    };
    let all: Vec<_> = (0..axis.model.found().len()).into_par_iter().filter_map(judged).collect();
    all.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, refutation)| refutation)
}
