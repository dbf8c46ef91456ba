//! The effects with which a round of the search starts.

use super::map_remainder::is_wave_of_own_period;
use super::residual_shape::shape;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::Fitted;
use crate::fit::scope::Scope;
use crate::prediction::force_windup;
use model::effects::{Effect, EffectContext, Stage, initial_guesses};

/// All initial guesses of the effects that the model does not yet contain.
#[must_use]
pub fn missing_effects(data: &FitData<'_>, base: &Fitted, scope: &Scope) -> Vec<Effect> {
    let model = &base.model;
    let others: Vec<String> = data.names.iter().filter(|name| *name != data.name()).cloned().collect();
    let residual = shape(data, &base.residuals, model.axis.settings.mechanics.lead_mm);
    let context = EffectContext {
        axis: &model.axis.settings,
        first: data.axis == 0,
        others: &others,
        stages: &scope.stages,
        travel_mm: data.travel_mm(),
        has_backlash: model.axis.effect.iter().any(|effect| matches!(effect, Effect::Backlash(_))),
        modes: model.axis.effect.iter().filter(|effect| matches!(effect, Effect::Resonance(_))).count(),
        residual: &residual,
    };
    let mut guesses = initial_guesses(&context);
    let force_is_logged = data.logs.iter().all(|log| log.axes[data.axis].force.is_some());
    guesses.retain(|effect| force_windup::is_testable(effect, force_is_logged));
    guesses.retain(|effect| !model.found().iter().any(|found| found.is_same(effect)));
    // A map would describe what the bump of a local defect leaves.
    let has_bump = data.exclusions.iter().any(|exclusion| exclusion.bump(Stage::Table).is_some());
    guesses.retain(|effect| !(has_bump && matches!(effect, Effect::PitchMap(_))));
    if model.found().iter().any(|effect| matches!(effect, Effect::PitchMap(_))) {
        // Between its knots a map deviates from the screw, in waves of a few knots.
        guesses.retain(|effect| !is_wave_of_own_period(effect, model.axis.settings.mechanics.lead_mm));
    }
    guesses
}
