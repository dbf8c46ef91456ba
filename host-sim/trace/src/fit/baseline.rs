//! Step 3, the fit of the declared values: the best that the declared model can do.

use super::axis_data::AxisData;
use super::axis_model::AxisModel;
use super::final_fit::reuse_previous_fit;
use super::fit_data::FitData;
use super::least_squares::Fitted;
use super::model_bias::first_fit;
use super::scope::{NotTestable, Scope};
use super::testable_scopes::scopes;
use super::total_mass;
use crate::stages::stage_names;
use crate::task::{Job, Progress};
use model::effects::Stage;
use model::machine::Axis;

/// The declared model of an axis, fitted within the tolerance of its values.
#[derive(Clone, Debug)]
pub struct Baseline {
    /// The model of the machine file.
    pub written: AxisModel,
    /// The fitted model.
    pub model: AxisModel,
    /// The fits, in the order of the scopes.
    pub fits: Vec<Fitted>,
    /// Stages that can be evaluated, by scope.
    pub scopes: Vec<Scope>,
    /// Stages that cannot be evaluated, with the reasons.
    pub not_testable: Vec<NotTestable>,
}

/// Fits the declared values of an axis, scope by scope.
#[must_use]
pub fn fit(job: &Job<'_>, axis: &AxisData<'_>) -> Baseline {
    baseline(axis.declared, &axis.fit, job.progress)
}

/// Fits the declared values of an axis and nothing else: the model, and rms and noise of what it leaves of each stage, µm or N.
#[must_use]
pub fn fit_values(declared: &Axis, data: &FitData<'_>) -> (AxisModel, Vec<(Stage, [f64; 2])>) {
    let Baseline { model, scopes, .. } = baseline(declared, data, &|_| {});
    let mut left = Vec::new();
    for scope in &scopes {
        let residuals = data.residuals(&model, scope);
        let of_stage = |stage: &Stage| (*stage, [data.rms(&residuals, *stage), data.noise(&model, *stage)]);
        left.extend(scope.stages.iter().map(of_stage));
    }
    (model, left)
}

/// If an earlier trace wrote the file, its values are kept unless the fit is much better.
fn baseline(declared: &Axis, data: &FitData<'_>, progress: &Progress<'_>) -> Baseline {
    let (scopes, not_testable) = scopes(declared, data);
    let written = AxisModel::new(declared, data.rates, data.options.model);
    let mut model = written.clone();
    let mut fits = Vec::new();
    for scope in &scopes {
        let stages = stage_names(&scope.stages);
        progress(&format!("{}: fitting the declared values to {stages}", data.name()));
        let (fitted, _) = first_fit(data, &model, scope);
        model = total_mass::pinned(data, &fitted, [scope; 2]);
        fits.push(fitted);
    }
    if let Some((previous, _)) = reuse_previous_fit(data, &written, &model, &scopes) {
        model = previous;
    }
    Baseline { written, model, fits, scopes, not_testable }
}
