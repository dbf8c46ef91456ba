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
use crate::fit::scope_fit::ScopeFit;
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

/// The search from the declared model, or, if that does not describe the closed loop, the first search from an assumed effect that leaves no more than
/// the noise of the motor: a wrong assumption describes it roughly, with other effects that are wrong, too.
#[must_use]
pub fn searched(
    data: &FitData<'_>,
    scopes: &[Scope],
    declared: &AxisModel,
    search: impl Fn(&AxisModel) -> Searched,
) -> Searched {
    let plain = search(declared);
    let described = |model: &AxisModel| data.max_described(model, Stage::Motor);
    if leaves_at_most(data, scopes, &plain.model, described(&plain.model)) {
        return plain;
    }
    let noise =
        |model: &AxisModel| data.options.search.max_provisional_ratio * data.noise(model, Stage::Motor);
    let is_declared = |effect: &Effect| declared.axis.effect.iter().any(|other| other.is_same(effect));
    let assumed = KINDS.iter().flat_map(|kind| (kind.assumed)()).filter(|effect| !is_declared(effect));
    let mut searches = assumed.map(|effect| search(&declared.assuming(&effect)));
    searches
        .find(|with| leaves_at_most(data, scopes, &with.model, noise(&with.model)))
        .map_or(plain, |with| with.with_assumed_as_found(scopes))
}

/// Whether the residual of the motor in closed loop, if this stage can be evaluated, is at most this, µm rms.
fn leaves_at_most(data: &FitData<'_>, scopes: &[Scope], model: &AxisModel, most_um: f64) -> bool {
    let mut loops = scopes.iter().filter(|scope| scope.stages.contains(&Stage::Motor));
    loops.all(|scope| {
        let residuals = data.residuals(model, scope);
        data.rms(&residuals, Stage::Motor) <= most_um
    })
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
