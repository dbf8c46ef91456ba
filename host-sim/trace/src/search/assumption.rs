//! Effects that are assumed before the mechanics are fitted.
//!
//! Some effects of the control loop change the force as a mass does. Without such an effect the fit of the mechanics takes its force for that
//! of another mass, beside which no effect of the loop describes the motor, so that no round of the search can find it. Where a search
//! leaves the closed loop undescribed, it is repeated with each form of such an effect assumed
//! ([`EffectModel::assumed`](model::effects::EffectModel::assumed)).

use super::round::Round;
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::Fitted;
use crate::fit::scope::Scope;
use crate::fit::scope_fit::{ScopeFit, fitted_in_order};
use model::effects::{Effect, KINDS, Stage};

/// The result of a search in all scopes.
pub struct Searched {
    /// The model with the effects found.
    pub model: AxisModel,
    /// The fits of its scopes.
    pub fits: Vec<ScopeFit>,
    /// The rounds of the search.
    pub rounds: Vec<Round>,
}

/// The search from the declared model; if it leaves more of the motor than noise, the first search from an assumed effect that does not. A
/// wrong assumption may describe the motor roughly, beside other effects that are wrong, too.
///
/// A search takes long. Where the model describes the motor but for a part of it, an effect is assumed only if the declared model alone
/// describes the logs better with it.
#[must_use]
pub fn searched(
    data: &FitData<'_>,
    scopes: &[Scope],
    declared: &AxisModel,
    search: impl Fn(&AxisModel) -> Searched,
) -> Searched {
    let plain = search(declared);
    let Some(scope) = scopes.iter().find(|scope| scope.stages.contains(&Stage::Motor)) else { return plain };
    let residual = |model: &AxisModel| data.rms(&data.residuals(model, scope), Stage::Motor);
    let leaves_noise = |model: &AxisModel| {
        residual(model) <= data.options.search.max_provisional_ratio * data.noise(model, Stage::Motor)
    };
    if leaves_noise(&plain.model) {
        return plain;
    }
    let is_described = residual(&plain.model) <= data.max_described(&plain.model, Stage::Motor);
    let describes_better = |model: &AxisModel| {
        let fitted = fitted_in_order(data, model.clone(), scopes.iter().map(|scope| (scope, &[][..])));
        residual(&fitted) < residual(declared)
    };
    let is_declared = |effect: &Effect| declared.axis.effect.iter().any(|other| other.is_same(effect));
    let assumed = KINDS.iter().flat_map(|kind| (kind.assumed)()).filter(|effect| !is_declared(effect));
    let mut searches = assumed
        .map(|effect| declared.assuming(&effect))
        .filter(|model| !is_described || describes_better(model))
        .map(|model| search(&model));
    searches.find(|with| leaves_noise(&with.model)).map_or(plain, |with| with.with_assumed_as_found(scopes))
}

impl Searched {
    fn with_assumed_as_found(mut self, scopes: &[Scope]) -> Self {
        let as_found = |model: &AxisModel| model.with_assumed_as_found(scopes);
        for fit in &mut self.fits {
            fit.fitted = Fitted { model: as_found(&fit.fitted.model), ..fit.fitted.clone() };
        }
        Self { model: as_found(&self.model), ..self }
    }
}
