//! The effects with which a round of the search starts.

use super::companion::has_any_shape;
use super::residual_shape::shape;
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::scope::Scope;
use crate::input::signals::logged_channels;
use model::effects::{Effect, EffectContext, Stage, initial_guesses};

/// All initial guesses of the effects that the model does not yet contain, for these residuals.
#[must_use]
pub fn missing_effects(
    data: &FitData<'_>,
    (model, residuals): (&AxisModel, &[ResidualSeries]),
    scope: &Scope,
) -> Vec<Effect> {
    let others: Vec<String> = data.names.iter().filter(|name| *name != data.name()).cloned().collect();
    let residual = shape(data, residuals, scope, &model.axis.settings.mechanics);
    let names: Vec<&'static str> = model.axis.effect.iter().map(Effect::name).collect();
    let logged = logged_channels(data.logs, data.axis, &data.options.samples);
    let context = EffectContext {
        axis: &model.axis.settings,
        logged,
        first: data.axis == 0,
        others: &others,
        stages: &scope.shown_stages(),
        travel_mm: data.travel_mm(),
        effects: &names,
        residual: &residual,
    };
    let mut guesses = initial_guesses(&context);
    guesses.retain(|effect| logged.force || !effect.kind().needs_force);
    guesses.retain(|effect| !model.found().iter().any(|found| found.is_same(effect)));
    // An effect of any shape would describe what the bump of a local defect leaves.
    let has_bump = |stage: Stage| data.exclusions.iter().any(|exclusion| exclusion.bump(stage).is_some());
    guesses.retain(|effect| !effect.describes_any_shape_of().is_some_and(has_bump));
    if has_any_shape(model.found()) {
        // Between its knots a map deviates from the screw, in waves of a few knots.
        let lead_mm = model.axis.settings.mechanics.lead_mm;
        guesses.retain(|effect| !effect.wave().is_some_and(|wave| wave.has_own_period(lead_mm)));
    }
    guesses
}
