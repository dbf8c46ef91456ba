//! Effects that are added together.
//!
//! What an effect describes may have a part that is an effect of its own, such as the slope of a pitch map
//! ([`EffectModel::added_with`](model::effects::EffectModel::added_with)), or a variation over the position
//! ([`EffectModel::variation`](model::effects::EffectModel::variation)).

use super::residual_shape::shape;
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::Fitted;
use model::effects::Effect;

/// The model with a candidate, and before it with the effect that is added with it, if the model does not have that one.
#[must_use]
pub fn with_companion(model: &AxisModel, candidate: Effect) -> AxisModel {
    let is_missing = |companion: &Effect| !model.axis.effect.iter().any(|other| other.is_same(companion));
    match candidate.added_with().filter(is_missing) {
        Some(companion) => model.with(companion).with(candidate),
        None => model.with(candidate),
    }
}

/// Whether an effect is added with another one of the same model.
#[must_use]
pub fn is_companion(effect: &Effect, found: &[Effect]) -> bool {
    found.iter().any(|other| other.added_with().is_some_and(|companion| companion.is_same(effect)))
}

/// The model of a fit with a candidate and its variation over the position; `None` if it has none, or the model describes any shape
/// over the position already.
#[must_use]
pub fn with_variation(data: &FitData<'_>, fitted: &Fitted, candidate: &Effect) -> Option<AxisModel> {
    let model = &fitted.model;
    let residual = || shape(data, &fitted.residuals, model.axis.settings.mechanics.lead_mm);
    if has_any_shape(&model.axis.effect) {
        return None;
    }
    Some(with_companion(model, candidate.variation(&residual(), data.travel_mm())?))
}

/// Whether one of the effects describes a residual of any shape over the position.
#[must_use]
pub fn has_any_shape(effects: &[Effect]) -> bool {
    effects.iter().any(|effect| effect.describes_any_shape_of().is_some())
}

/// Whether an effect is what another one leaves, and no effect of its own.
#[must_use]
pub fn is_remainder(effect: &Effect, found: &[Effect]) -> bool {
    effect.wave().is_some_and(|wave| found.iter().any(|other| other.leaves(wave)))
}
