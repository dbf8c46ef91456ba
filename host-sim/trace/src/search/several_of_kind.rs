//! An effect beside another one of its kind.
//!
//! Beside a second mode, for example, the first one has a participation of its own: the tool is no longer the mass that the table
//! drives.

use rayon::prelude::*;

use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{self, Fitted};
use crate::fit::normal_equations::Column;
use crate::fit::scope::Scope;
use model::effects::Effect;

/// Steps of a fit that only shows whether its start is near the best one.
const TRIAL_STEPS: usize = 3;

/// The model with all coordinates free of every found effect of one kind, if its last effect is a further one of this kind, and those of
/// the known derivatives that remain valid.
#[must_use]
pub fn with_free_coordinates<'a>(
    mut model: AxisModel,
    scope: &Scope,
    known: &'a [Column],
) -> (AxisModel, &'a [Column]) {
    let Some((last, others)) = model.found().split_last() else { return (model, known) };
    let last = last.clone();
    let freed = |effect: &Effect| effect.among_several().filter(|_| effect.is_same_kind(&last));
    let Some(first) = others.iter().position(|effect| freed(effect).is_some()) else { return (model, known) };
    let valid = model.indices_of(scope, first).start.min(known.len());
    let declared = model.axis.effect.len() - model.found().len();
    for effect in &mut model.axis.effect[declared..] {
        if let Some(freed) = freed(effect) {
            *effect = freed;
        }
    }
    (model, &known[..valid])
}

/// The model of a fit with the last effect at the best of its other starts, if it is a further one of its kind and one of them leaves
/// less.
#[must_use]
pub fn at_best_start(data: &FitData<'_>, fitted: &Fitted, scope: &Scope) -> Option<AxisModel> {
    let (last, others) = fitted.model.found().split_last()?;
    let stage = *last.stages().first()?;
    let left = data.rms(&fitted.residuals, stage);
    if !others.iter().any(|effect| effect.is_same_kind(last)) {
        return None;
    }
    let at = |effect: Effect| {
        let start = fitted.model.without(others.len()).with(effect);
        let trial = least_squares::fit(data, &start, scope, TRIAL_STEPS);
        (data.rms(&trial.residuals, stage), trial.model)
    };
    let trials: Vec<(f64, AxisModel)> = last.other_starts().into_par_iter().map(at).collect();
    let best = trials.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 < left).then_some(best.1)
}
