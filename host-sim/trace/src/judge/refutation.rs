//! Effects that the fit logs support and the validation logs refute.
//!
//! A found effect is removed, and all other parameters are fitted again to the fit logs. If this raises the log-likelihood of
//! the validation logs significantly, the effect is reported as refuted and is not part of the model.

use rayon::prelude::*;

use super::found_effect::FoundEffect;
use super::likelihood::refuting_loss;
use crate::fit::fit_data::{FitAndValidationRms, FitData, ResidualSeries};
use crate::fit::fitted_axis::FittedAxis;
use crate::fit::scope::{Mechanics, Scope, ShownIn};
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
        let removal = Removal::of([fit_data, validate], axis, index, stages);
        let gain = refuting_loss(validate, [&removal.held_out[0], &removal.held_out[1]])?;
        let (stage, before, after) =
            removal.changes.iter().max_by(|a, b| ratio(a).total_cmp(&ratio(b))).copied()?;
        let reported = (axis.model.found()[index].clone(), axis.half_widths(fit_data, index));
        let found = FoundEffect::new(reported, stage, [before, after]);
        Some((gain, Refutation { found, without: removal.without }))
    };
    let all: Vec<_> = (0..axis.model.found().len()).into_par_iter().filter_map(judged).collect();
    all.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, refutation)| refutation)
}

/// The stage whose residual on the validation logs a found effect, by its index, reduces most beside all other effects, with its
/// residual without the effect, everything else fitted again, and with it.
#[must_use]
pub fn reduced_beside_others(
    data: [&FitData<'_>; 2],
    axis: &FittedAxis,
    index: usize,
    stages: &[Stage],
) -> Option<Change> {
    let removal = Removal::of(data, axis, index, stages);
    removal.changes.into_iter().min_by(|a, b| ratio(a).total_cmp(&ratio(b)))
}

/// A stage with its residuals without and with an effect.
pub type Change = (Stage, FitAndValidationRms, FitAndValidationRms);

/// Residual of the validation logs with an effect, as a fraction of that without it.
fn ratio((_, before, after): &Change) -> f64 {
    after.validate / before.validate
}

/// A model without one of its effects.
struct Removal {
    /// The model without the effect, everything else fitted again.
    without: FittedAxis,
    /// Residuals of the validation logs without and with the effect.
    held_out: [Vec<ResidualSeries>; 2],
    /// The stages that the validation logs show.
    changes: Vec<Change>,
}

impl Removal {
    fn of(
        [fit_data, validate]: [&FitData<'_>; 2],
        axis: &FittedAxis,
        index: usize,
        stages: &[Stage],
    ) -> Self {
        let effect = &axis.model.found()[index];
        let shown_in = axis.fits.first().map_or(ShownIn::default(), |fit| fit.scope.shown_in);
        let stages = shown_in.stages_of(effect).into_iter().filter(|stage| stages.contains(stage)).collect();
        let scope = Scope { stages, mechanics: Mechanics::None, shown_in };
        let without = axis.without(fit_data, index);
        let models = [&without.model, &axis.model];
        let held_out = models.map(|model| validate.residuals(model, &scope));
        let fitted = models.map(|model| fit_data.residuals(model, &scope));
        let pair = |model: usize, stage| FitAndValidationRms {
            fit: fit_data.rms(&fitted[model], stage),
            validate: validate.rms(&held_out[model], stage),
        };
        let of_stage = |&stage: &Stage| (stage, pair(0, stage), pair(1, stage));
        let changes =
            scope.stages.iter().map(of_stage).filter(|(_, before, _)| before.validate > 0.0).collect();
        Self { without, held_out, changes }
    }
}
