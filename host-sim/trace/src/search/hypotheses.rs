//! Step 4, the search: effects that the fit logs support, and the model that contains them.

use super::assumption::{self, Searched};
use super::effect_search::EffectSearch;
use super::round::Round;
use super::scale_waves::{taken_back, with_waves_of_scale};
use crate::fit::axis_data::AxisData;
use crate::fit::axis_model::AxisModel;
use crate::fit::baseline::Baseline;
use crate::fit::final_fit::{FinalFit, final_fit};
use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::fitted_axis::FittedAxis;
use crate::fit::least_squares::Fitted;
use crate::fit::model_bias::first_fit;
use crate::fit::scope::{NotTestable, Scope};
use crate::fit::scope_fit::{ScopeFit, fit_again, fit_jointly};
use crate::fit::total_mass;
use crate::task::{Job, Task};
use model::effects::Stage;

/// The effects that the fit logs of an axis support.
#[derive(Clone, Debug)]
pub struct Hypotheses {
    /// The model of the machine file.
    pub written: AxisModel,
    /// The model with the effects, and the declared model fitted in the same way.
    pub axis: FittedAxis,
    /// Error of the tracer's own simulation in the fit logs and in the validation logs; empty if not known.
    pub bias: [Vec<ResidualSeries>; 2],
    /// The rounds of the search.
    pub rounds: Vec<Round>,
    /// Stages that can be evaluated, by scope.
    pub scopes: Vec<Scope>,
    /// Stages that cannot be evaluated, with the reasons.
    pub not_testable: Vec<NotTestable>,
}

/// What a search added to a baseline.
pub struct SearchedAxis {
    baseline: Baseline,
    searched: Searched,
}

impl SearchedAxis {
    /// The model with the effects.
    #[must_use]
    pub const fn model(&self) -> &AxisModel {
        &self.searched.model
    }
}

/// Searches for effects that a baseline lacks, unless the task is to evaluate it.
#[must_use]
pub fn search(job: &Job<'_>, axis: &AxisData<'_>, baseline: Baseline) -> SearchedAxis {
    let Baseline { model: declared, scopes, .. } = &baseline;
    let steps = Steps { job, data: &axis.fit, scopes };
    let searched = match job.request.task {
        Task::Search => assumption::searched(&axis.fit, scopes, declared, |from| steps.through_scopes(from)),
        Task::Evaluate => steps.through_scopes(declared),
    };
    SearchedAxis { baseline, searched }
}

/// Fits everything together. The data have the models of the other axes, as far as they are known.
#[must_use]
pub fn fit_together(job: &Job<'_>, axis: &AxisData<'_>, axis_searched: SearchedAxis) -> Hypotheses {
    let SearchedAxis { baseline, searched } = axis_searched;
    let Baseline { written, model: declared, fits: declared_fits, scopes, not_testable } = baseline;
    let FinalFit { model, fits, bias } = final_fit(
        [&axis.fit, &axis.validate],
        &written,
        (searched.model, searched.fits),
        &scopes,
        job.progress,
    );
    let unbiased = FitData { bias: &bias[0], ..axis.fit };
    let steps = Steps { job, data: &unbiased, scopes: &scopes };
    let baseline = steps.refit_baseline(&declared, declared_fits, (&model, &fits));
    let axis = FittedAxis { baseline, model, fits };
    Hypotheses { written, axis, bias, rounds: searched.rounds, scopes, not_testable }
}

/// The steps of the search of one axis.
#[derive(Clone, Copy)]
struct Steps<'a> {
    job: &'a Job<'a>,
    data: &'a FitData<'a>,
    scopes: &'a [Scope],
}

impl Steps<'_> {
    /// Searches for effects, scope by scope, unless the task is to evaluate; then fits all parameters to force and motor
    /// stage jointly, see [`fit_jointly`].
    fn through_scopes(&self, from: &AxisModel) -> Searched {
        let servo = self.scopes.iter().find(|scope| scope.stages == [Stage::Motor]).cloned();
        let progress = self.job.progress;
        let mut search =
            EffectSearch { data: self.data, progress, servo, rounds: Vec::new(), dropped: Vec::new() };
        let mut model = from.clone();
        let mut fits = Vec::new();
        for scope in self.scopes {
            let fit = match self.job.request.task {
                Task::Search if scope.stages == [Stage::Tool] => self.search_tool(&mut search, &model, scope),
                Task::Search => search.search(&model, scope),
                Task::Evaluate => {
                    let (fitted, _) = first_fit(self.data, &model, scope);
                    let (scope, fitted_scope) = (scope.clone(), scope.clone());
                    ScopeFit { scope, fitted_scope, fitted, exclusions: Vec::new() }
                }
            };
            model = total_mass::pinned(self.data, &fit.fitted, [&fit.scope, &fit.fitted_scope]);
            fits.push(fit);
        }
        fit_jointly(self.data, &mut model, &mut fits, self.scopes, progress);
        search.rounds.iter_mut().for_each(Round::forget_data);
        Searched { model, fits, rounds: search.rounds }
    }

    /// Searches for effects of the tool, beside which waves are the scale's or not.
    fn search_tool(&self, search: &mut EffectSearch<'_>, model: &AxisModel, scope: &Scope) -> ScopeFit {
        let first_round = search.rounds.len();
        let exchanged = with_waves_of_scale(self.data, model.clone(), scope);
        let fit = search.search(&exchanged, scope);
        let Some(start) = taken_back(self.data, [model, &exchanged, &fit.fitted.model], scope) else {
            return fit;
        };
        search.rounds.truncate(first_round);
        search.search(&start, scope)
    }

    /// Fits the declared model with the same exclusions and the same error subtracted as the model with effects; without any effect,
    /// both are the same.
    fn refit_baseline(
        &self,
        declared: &AxisModel,
        fits: Vec<Fitted>,
        (model, with_effects): (&AxisModel, &[ScopeFit]),
    ) -> AxisModel {
        if model.found().is_empty() {
            return model.clone();
        }
        let alike = |(fitted, other): (Fitted, &ScopeFit)| {
            let (scope, exclusions) = (other.scope.clone(), other.exclusions.clone());
            ScopeFit { fitted_scope: scope.clone(), scope, fitted, exclusions }
        };
        let fits: Vec<ScopeFit> = fits.into_iter().zip(with_effects).map(alike).collect();
        fit_again(self.data, declared, &fits, self.scopes, self.job.progress).0
    }
}
