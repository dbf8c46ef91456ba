//! Laws of what remains of the stages of an axis.

use super::confirmation::{Confirmed, MANY_COORDINATES};
use crate::analysis::law::{FoundLaw, Left, law};
use crate::dropped::{Dropped, Reason};
use crate::fit::axis_data::AxisData;
use crate::fit::axis_model::AxisModel;
use crate::fit::exclusion::Exclusion;
use crate::fit::fit_data::FitData;
use crate::fit::fitted_axis::FittedAxis;
use crate::fit::least_squares::{STEPS, derivatives, fit};
use crate::fit::scope::Scope;
use crate::fit::scope_fit::ScopeFit;
use crate::task::Progress;
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

/// What was confirmed, without a map in whose place a law describes its stage.
#[must_use]
pub fn without_map_of_law(
    data: &AxisData<'_>,
    mut confirmed: Confirmed,
    progress: &Progress<'_>,
) -> Confirmed {
    if let Some((index, without)) = map_in_place_of_law(data, &confirmed.axis) {
        let map = &confirmed.axis.model.found()[index];
        confirmed.found.retain(|found| !found.effect.is_same(map));
        confirmed.dropped.push(Dropped::new(map, Reason::DescribedByLaw, data.fit.name(), progress));
        confirmed.axis = without;
    }
    confirmed
}

/// The index of a found map over a position that leaves much of its stage in the fitted or the held-out logs, where a law without the map describes
/// it better than the map, and the axis without it. The knots of a map take away a part of every wave, and leave a shape that follows no law.
fn map_in_place_of_law(data: &AxisData<'_>, axis: &FittedAxis) -> Option<(usize, FittedAxis)> {
    let AxisData { fit, validate, .. } = data;
    axis.model.found().iter().enumerate().find_map(|(index, effect)| {
        if effect.coordinates().len() < MANY_COORDINATES {
            return None;
        }
        let ScopeFit { scope, exclusions, .. } = axis.fits.iter().find(|fit| fit.scope.holds(effect))?;
        let [stage] = scope.stages[..] else { return None };
        let left = |data: &FitData<'_>| data.rms(&data.residuals(&axis.model, scope), stage);
        // A map knows nothing of positions outside the fitted logs, which a law may reach.
        let most = fit.options.verdict.max_certain(fit.noise(&axis.model, stage));
        if left(fit) <= most && left(validate) <= most {
            return None;
        }
        let without = axis.without(fit, index);
        let law = law_of(data, (&without.model, scope), exclusions, stage)?;
        let beside = law_of(data, (&axis.model, scope), exclusions, stage);
        let best = beside.map_or_else(|| left(validate), |law| law.after.validate);
        (law.after.validate < best).then_some((index, without))
    })
}

/// The model with laws, and the parameters of their stages fitted again.
#[must_use]
pub fn with_laws(data: &FitData<'_>, model: &AxisModel, scopes: &[Scope], laws: &[FoundLaw]) -> AxisModel {
    let model = model.with_further_laws(laws.iter().map(FoundLaw::residual_law));
    let changed = scopes.iter().filter(|scope| laws.iter().any(|law| scope.stages.contains(&law.stage)));
    changed.fold(model, |model, scope| fit(data, &model, scope, STEPS).model)
}
