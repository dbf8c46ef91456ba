//! Fits of all scopes of an axis, one after the other, and the joint fit of force and motor stage.

use super::axis_model::AxisModel;
use super::exclusion::Exclusion;
use super::fit_data::FitData;
use super::least_squares::{self, Fitted};
use super::scope::{Mechanics, Scope};
use super::total_mass;
use crate::stages::stage_names;
use model::effects::Stage;

/// Called with a message for each step of the trace, from several threads.
pub type Progress<'a> = dyn Fn(&str) + Sync + 'a;

/// The fit of one scope.
#[derive(Clone, Debug)]
pub struct ScopeFit {
    /// The scope in which its effects were searched for.
    pub scope: Scope,
    /// The scope of the last fit: the joint scope after [`fit_jointly`], otherwise `scope`.
    pub fitted_scope: Scope,
    /// The fit.
    pub fitted: Fitted,
    /// Exclusions from the residuals.
    pub exclusions: Vec<Exclusion>,
}

/// Fits all scopes again, one after the other, from the model.
#[must_use]
pub fn fit_again(
    data: &FitData<'_>,
    model: &AxisModel,
    fits: &[ScopeFit],
    scopes: &[Scope],
    progress: &Progress<'_>,
) -> (AxisModel, Vec<ScopeFit>) {
    let (mut model, mut fits) = (model.clone(), fits.to_vec());
    for fit in &mut fits {
        let data = FitData { exclusions: &fit.exclusions, ..*data };
        // The derivatives of the last fit are reused, except those of the joint fit, which has other stages.
        let is_own = fit.fitted_scope.stages == fit.scope.stages;
        let known = if is_own { &fit.fitted.columns[..] } else { &[] };
        fit.fitted = least_squares::fit_from(&data, &model, &fit.scope, least_squares::STEPS, known);
        model = total_mass::pinned(&data, &fit.fitted, [&fit.scope; 2]);
    }
    fit_jointly(data, &mut model, &mut fits, scopes, progress);
    (model, fits)
}

/// Fits the model to force and motor stage jointly, if there is no table stage.
pub fn fit_jointly(
    data: &FitData<'_>,
    model: &mut AxisModel,
    fits: &mut [ScopeFit],
    scopes: &[Scope],
    progress: &Progress<'_>,
) {
    let Some(joint) = joint(scopes) else { return };
    progress(&format!("{}: fitting all to {}", data.name(), stage_names(&joint.stages)));
    let fitted = least_squares::fit(data, model, &joint, least_squares::STEPS);
    *model = fitted.model.clone();
    // The confidence intervals of all effects are those of the joint fit.
    for fit in fits {
        (fit.fitted_scope, fit.fitted) = (joint.clone(), fitted.clone());
    }
}

/// The joint scope of force and motor stage, if there is no table stage. Both stages determine the same friction: the force
/// at fast changes, the closed loop at slow ones.
fn joint(scopes: &[Scope]) -> Option<Scope> {
    let has = |stage| scopes.iter().any(|scope| scope.stages == [stage]);
    let stages = vec![Stage::Force, Stage::Motor];
    (has(Stage::Force) && has(Stage::Motor)).then_some(Scope { stages, mechanics: Mechanics::All })
}
