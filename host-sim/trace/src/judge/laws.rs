//! Laws of what remains of the stages of an axis.

use crate::analysis::law::{FoundLaw, Left, law};
use crate::fit::axis_data::AxisData;
use crate::fit::axis_model::AxisModel;
use crate::fit::exclusion::Exclusion;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{STEPS, derivatives, fit};
use crate::fit::scope::Scope;
use model::effects::Stage;

/// The law of what a model leaves of a stage. An exclusion may be an artefact of the law: where the law leaves less without it, it is found without it.
#[must_use]
pub fn law_of(
    AxisData { fit, validate, .. }: &AxisData<'_>,
    (model, scope): (&AxisModel, &Scope),
    exclusions: &[Exclusion],
    stage: Stage,
) -> Option<FoundLaw> {
    let noise = fit.noise(model, stage);
    let is_excluded = exclusions.iter().any(|exclusion| exclusion.stage == stage);
    let variants: &[&[Exclusion]] = if is_excluded { &[exclusions, &[]] } else { &[&[]] };
    let found = variants.iter().filter_map(|exclusions| {
        let [fit, validate] = [fit, validate].map(|data| FitData { exclusions, ..*data });
        law_beside([&fit, &validate], (model, scope), stage, noise)
    });
    found.min_by(|a, b| a.after.validate.total_cmp(&b.after.validate))
}

/// The law of what remains of a stage. The parameters of its scope stay free beside the law, where they are parameters of this stage
/// alone.
fn law_beside(
    datas: [&FitData<'_>; 2],
    (model, scope): (&AxisModel, &Scope),
    stage: Stage,
    noise: f64,
) -> Option<FoundLaw> {
    let count = if scope.stages.len() == 1 { model.free_parameters(scope).len() } else { 0 };
    let all: Vec<usize> = (0..count).collect();
    let [of_fit, of_validation] = datas.map(|data| {
        let residuals = data.residuals(model, scope);
        let free = derivatives(data, model, scope, &all, &residuals);
        (data, residuals, free)
    });
    let [fit, validate] =
        [&of_fit, &of_validation].map(|(data, residuals, free)| Left { data, residuals, free });
    law(&fit, &validate, stage, noise)
}

/// The model with laws, and the parameters of their stages fitted again.
#[must_use]
pub fn with_laws(data: &FitData<'_>, model: &AxisModel, scopes: &[Scope], laws: &[FoundLaw]) -> AxisModel {
    let model = model.with_further_laws(laws.iter().map(FoundLaw::residual_law));
    let changed = scopes.iter().filter(|scope| laws.iter().any(|law| scope.stages.contains(&law.stage)));
    changed.fold(model, |model, scope| fit(data, &model, scope, STEPS).model)
}
