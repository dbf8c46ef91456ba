//! Fits of all scopes of an axis, one after the other, and the joint fit of force and motor stage.

use super::axis_model::AxisModel;
use super::exclusion::Exclusion;
use super::fit_data::FitData;
use super::least_squares::{self, Fitted};
use super::scope::{Mechanics, Scope};
use super::total_mass;
use crate::stages::stage_names;
use crate::task::Progress;
use model::effects::Stage;

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
        fit.fit_from(data, &mut model);
    }
    fit_jointly(data, &mut model, &mut fits, scopes, progress);
    (model, fits)
}

/// A model after fits to the scopes one after the other, without a joint fit.
#[must_use]
pub fn fitted_in_order<'a>(
    data: &FitData<'_>,
    mut model: AxisModel,
    scopes: impl IntoIterator<Item = (&'a Scope, &'a [Exclusion])>,
) -> AxisModel {
    for (scope, exclusions) in scopes {
        let data = FitData { exclusions, ..*data };
        let fitted = least_squares::fit(&data, &model, scope, least_squares::STEPS);
        model = total_mass::pinned(&data, &fitted, [scope; 2]);
    }
    model
}

impl ScopeFit {
    /// Fits the scope alone again, from the model, which takes the fitted values.
    fn fit_from(&mut self, data: &FitData<'_>, model: &mut AxisModel) {
        let data = FitData { exclusions: &self.exclusions, ..*data };
        // The derivatives of the last fit are reused, except those of the joint fit, which has other stages.
        let is_own = self.fitted_scope.stages == self.scope.stages;
        let known = if is_own { &self.fitted.columns[..] } else { &[] };
        self.fitted = least_squares::fit_from(&data, model, &self.scope, least_squares::STEPS, known);
        *model = total_mass::pinned(&data, &self.fitted, [&self.scope; 2]);
    }
}

/// Fits the model to force and motor stage jointly, if there is no table stage, and the other scopes to the result.
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
    for fit in fits {
        // The confidence intervals of the effects of force and motor are those of the joint fit. The tool is no part of it.
        if fit.scope.stages.iter().all(|stage| joint.stages.contains(stage)) {
            (fit.fitted_scope, fit.fitted) = (joint.clone(), fitted.clone());
        } else {
            fit.fit_from(data, model);
        }
    }
}

/// The joint scope of force and motor stage, if there is no table stage. Both stages determine the same friction: the force
/// at fast changes, the closed loop at slow ones.
fn joint(scopes: &[Scope]) -> Option<Scope> {
    let has = |stage| scopes.iter().any(|scope| scope.stages == [stage]);
    let stages = vec![Stage::Force, Stage::Motor];
    let shown_in = scopes.first()?.shown_in;
    (has(Stage::Force) && has(Stage::Motor)).then_some(Scope { stages, mechanics: Mechanics::All, shown_in })
}
