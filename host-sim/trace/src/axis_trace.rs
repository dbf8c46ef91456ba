//! The trace of one axis, in the order of `docs/tracing.md`, "Order".

use crate::alignment::{self, drift_rate, wave};
use crate::analysis::empirical::{Empirical, empirical};
use crate::analysis::free_run::{FreeRun, free_runs};
use crate::analysis::repeatability::{Repeatability, repeatability};
use crate::analysis::residual_analysis::{UnexplainedResidual, unexplained};
use crate::fit::axis_model::AxisModel;
use crate::fit::exclusion::Exclusion;
use crate::fit::final_fit::{FinalFit, final_fit, reuse_previous_fit};
use crate::fit::fit_data::{FitAndValidationRms, FitData};
use crate::fit::fitted_scope::FittedScope;
use crate::fit::least_squares::Fitted;
use crate::fit::model_bias::{first_fit, from_best_start};
use crate::fit::scope::{NotTestable, Scope};
use crate::fit::scope_fit::{Progress, ScopeFit, fit_again, fit_jointly};
use crate::fit::testable_scopes::scopes;
use crate::fit::total_mass;
use crate::not_testable::{EffectNotTestable, effects_not_testable};
use crate::outcome::{AxisTrace, StageResidual};
use crate::search::ambiguity::Ambiguity;
use crate::search::assumption::{self, Searched};
use crate::search::effect_search::EffectSearch;
use crate::search::round::Round;
use crate::stages::stage_names;
use crate::task::{Request, Task};
use crate::validation::confirmation::{Confirmed, confirm};
use crate::validation::declared_value::declared_values;
use crate::validation::fitted_axis::FittedAxis;
use crate::validation::found_effect::FoundEffect;
use crate::validation::misfit::{Evidence, is_of_another_machine};
use crate::validation::tool_slopes::ToolSlopes;
use files::log::Unit;
use model::effects::{Effect, Neighbours, Stage};
use model::machine::Axis;
use model::residual_table::ResidualTable;

/// Traces or evaluates one axis. `progress` is called with a message for each step.
#[must_use]
pub fn trace(
    declared: &Axis,
    [fit_data, validate]: [&FitData<'_>; 2],
    request: Request,
    progress: &Progress<'_>,
) -> AxisTrace {
    let task = request.task;
    let (scopes, not_testable) = scopes(declared, fit_data);
    let written = AxisModel::new(declared, fit_data.rates, fit_data.options.model);
    let stage = Tracing { fit_data, scopes: &scopes, progress };

    // The declared values, then the effects, scope by scope, then the joint fit to force and motor.
    let (before, declared_fits) = stage.fit_declared(&written);
    let Searched { model, fits, rounds } = stage.searched(&before, task);
    // 5: fit with the error of the tracer's own simulation subtracted.
    let FinalFit { model, fits, bias } =
        final_fit([fit_data, validate], &written, (model, fits), &scopes, progress);
    let [fit_data, validate] =
        &[(fit_data, &bias[0]), (validate, &bias[1])].map(|(data, bias)| FitData { bias, ..*data });
    let stage = Tracing { fit_data, ..stage };
    // 6: the declared model, fitted in the same way.
    let before = stage.refit_baseline(&before, declared_fits, (&model, &fits));
    // What the validation logs refute.
    let stages: Vec<Stage> = scopes.iter().flat_map(|scope| scope.stages.iter().copied()).collect();
    let axis = drift_rate::with_rates(fit_data, FittedAxis { baseline: before.clone(), model, fits });
    let Confirmed { axis, mut found, refused, refuted } =
        confirm([fit_data, validate], axis, &stages, &rounds, progress);
    let fitted_scopes = FittedScope::of(&axis.fits);
    let declared_values = declared_values([fit_data, validate], &axis);
    let tool_slopes = ToolSlopes::of(fit_data, &axis);
    let exclusions = exclusions_of(&axis.fits);
    let evidence =
        Evidence { models: [&before, &axis.model], values: &declared_values, refused: refused.len() };
    let is_of_another_machine = is_of_another_machine(fit_data, evidence, &scopes);
    let kept = stage.previous_fit_if_nothing_new(&written, axis.model);
    let model = if is_of_another_machine { before.clone() } else { kept };
    found.retain(|_| !is_of_another_machine);
    let before = stage.shown_before(task, declared, [before, model.clone()]);
    // What remains.
    let (model, remains) = stage.with_tables(request, validate, [&before, &model], &exclusions);
    let Remainder { residuals, unexplained, repeats, tables } = remains;
    let ambiguities = named_ambiguities(&rounds, &mut found);
    alignment::doubt(fit_data, &model, &scopes, &mut found);
    AxisTrace {
        task,
        axis: fit_data.name().to_owned(),
        unit: fit_data.logs.iter().find_map(|log| log.axes[fit_data.axis].unit).unwrap_or(Unit::Millimetre),
        effects_not_testable: untested(declared, fit_data, (&stages, &not_testable), &rounds),
        data_faults: Vec::new(),
        ambiguities,
        free_runs: free_runs_of(validate, [&before, &model]),
        bias: validate.bias.to_vec(),
        declared_values,
        has_force_scale: false,
        is_of_another_machine,
        baseline: before,
        model,
        scopes,
        fitted_scopes,
        subtracts_bias: !fit_data.bias.is_empty(),
        not_testable,
        found,
        refused,
        refuted,
        tool_slopes,
        residuals,
        unexplained,
        repeats,
        tables,
        rounds,
    }
}

/// Fits the declared values of an axis and nothing else, as a trace does first: the model, and rms and noise of what it leaves of each
/// stage, µm or N.
#[must_use]
pub fn fit_values(declared: &Axis, data: &FitData<'_>) -> (AxisModel, Vec<(Stage, [f64; 2])>) {
    let (scopes, _) = scopes(declared, data);
    let written = AxisModel::new(declared, data.rates, data.options.model);
    let (model, _) = Tracing { fit_data: data, scopes: &scopes, progress: &|_| {} }.fit_declared(&written);
    let mut left = Vec::new();
    for scope in &scopes {
        let residuals = data.residuals(&model, scope);
        let of_stage = |stage: &Stage| (*stage, [data.rms(&residuals, *stage), data.noise(&model, *stage)]);
        left.extend(scope.stages.iter().map(of_stage));
    }
    (model, left)
}

/// The errors of both models under the measured force alone, on the validation logs.
fn free_runs_of(validate: &FitData<'_>, [before, model]: [&AxisModel; 2]) -> Vec<FreeRun> {
    let logs: Vec<_> = validate.logs.iter().map(|log| (&log.axes[validate.axis], log.sample_s)).collect();
    free_runs(validate.name(), &before.axis, &model.axis, &logs)
}

/// The fits of one axis before the validation.
#[derive(Clone, Copy)]
struct Tracing<'a> {
    fit_data: &'a FitData<'a>,
    scopes: &'a [Scope],
    progress: &'a Progress<'a>,
}

impl Tracing<'_> {
    /// Fits the declared values, scope by scope. If an earlier trace wrote the file, its values are kept unless the fit is
    /// much better.
    fn fit_declared(&self, written: &AxisModel) -> (AxisModel, Vec<Fitted>) {
        let data = self.fit_data;
        let mut model = written.clone();
        let mut fits = Vec::new();
        for scope in self.scopes {
            let stages = stage_names(&scope.stages);
            (self.progress)(&format!("{}: fitting the declared values to {stages}", data.name()));
            let (fitted, _) = first_fit(data, &model, scope);
            model = total_mass::pinned(data, &fitted, [scope; 2]);
            fits.push(fitted);
        }
        if let Some((previous, _)) = reuse_previous_fit(data, written, &model, self.scopes) {
            model = previous;
        }
        (model, fits)
    }

    /// The model of the machine file, if an earlier trace wrote it and no effect was confirmed: effects that were tried and
    /// refuted leave the other values slightly different.
    fn previous_fit_if_nothing_new(&self, written: &AxisModel, model: AxisModel) -> AxisModel {
        if !model.found().is_empty() {
            return model;
        }
        reuse_previous_fit(self.fit_data, written, &model, self.scopes)
            .map_or(model, |(previous, _)| previous)
    }

    /// The model that "before" shows, from the fitted declared model and the model with effects.
    fn shown_before(&self, task: Task, declared: &Axis, [before, model]: [AxisModel; 2]) -> AxisModel {
        match task {
            Task::Evaluate => self.as_declared(declared),
            // If all effects were dropped, both models are the same.
            Task::Search if model.found().is_empty() => model,
            Task::Search => before,
        }
    }

    /// The values of the machine file; only zeros and instants of the logs are fitted.
    fn as_declared(&self, declared: &Axis) -> AxisModel {
        let fixed = Axis { settings: declared.settings.clone().without_tolerances(), ..declared.clone() };
        let mut model = AxisModel::new(&fixed, self.fit_data.rates, self.fit_data.options.model);
        for scope in self.scopes {
            model = from_best_start(self.fit_data, &model, scope).model;
        }
        model
    }

    /// What remains of the residuals under both models. If requested, what the logs confirm of it is added to the second model as
    /// tables, and what remains is that beside the tables.
    fn with_tables(
        &self,
        request: Request,
        validate: &FitData<'_>,
        models: [&AxisModel; 2],
        exclusions: &[Exclusion],
    ) -> (AxisModel, Remainder) {
        let data = [self.fit_data, validate];
        let [before, model] = models;
        let remains = remainder(data, models, self.scopes, exclusions);
        let confirmed: Vec<ResidualTable> = remains.tables.iter().filter_map(Empirical::confirmed).collect();
        if !request.tables || confirmed.is_empty() {
            return (model.clone(), remains);
        }
        let model = model.with_further_tables(&confirmed);
        let beside = remainder(data, [before, &model], self.scopes, exclusions);
        (model, Remainder { tables: remains.tables, ..beside })
    }

    /// The search, also from an assumed effect where that describes the logs better.
    fn searched(&self, before: &AxisModel, task: Task) -> Searched {
        let search = |from: &AxisModel| self.search(from, task);
        match task {
            Task::Search => assumption::searched(self.fit_data, self.scopes, before, search),
            Task::Evaluate => search(before),
        }
    }

    /// Searches for effects, scope by scope, unless the task is to evaluate; then fits all parameters to force and motor
    /// stage jointly, see [`fit_jointly`].
    fn search(&self, before: &AxisModel, task: Task) -> Searched {
        let servo = self.scopes.iter().find(|scope| scope.stages == [Stage::Motor]).cloned();
        let mut search = EffectSearch {
            data: self.fit_data,
            progress: self.progress,
            servo,
            rounds: Vec::new(),
            dropped: Vec::new(),
        };
        let mut model = before.clone();
        let mut fits = Vec::new();
        for scope in self.scopes {
            if task == Task::Search && scope.stages == [Stage::Tool] {
                model = wave::with_waves_of_scale(self.fit_data, model, scope);
            }
            let fit = match task {
                Task::Search => search.search(&model, scope),
                Task::Evaluate => {
                    let (fitted, _) = first_fit(self.fit_data, &model, scope);
                    let (scope, fitted_scope) = (scope.clone(), scope.clone());
                    ScopeFit { scope, fitted_scope, fitted, exclusions: Vec::new() }
                }
            };
            model = total_mass::pinned(self.fit_data, &fit.fitted, [&fit.scope, &fit.fitted_scope]);
            fits.push(fit);
        }
        fit_jointly(self.fit_data, &mut model, &mut fits, self.scopes, self.progress);
        search.rounds.iter_mut().for_each(Round::forget_data);
        Searched { model, fits, rounds: search.rounds }
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
        fit_again(self.fit_data, declared, &fits, self.scopes, self.progress).0
    }
}

/// Residuals after the fit, and their analysis.
#[derive(Default)]
struct Remainder {
    residuals: Vec<StageResidual>,
    unexplained: Vec<UnexplainedResidual>,
    repeats: Vec<Repeatability>,
    tables: Vec<Empirical>,
}

/// The residuals of each stage under the declared model and under the model with effects.
fn remainder(
    [fit_data, validate]: [&FitData<'_>; 2],
    [before, model]: [&AxisModel; 2],
    scopes: &[Scope],
    exclusions: &[Exclusion],
) -> Remainder {
    let mut remainder = Remainder::default();
    for scope in scopes {
        let [fit_before, fit_after] = [before, model].map(|model| fit_data.residuals(model, scope));
        let [held_out_before, held_out_after] = [before, model].map(|model| validate.residuals(model, scope));
        let has_exclusion = exclusions.iter().any(|exclusion| scope.stages.contains(&exclusion.stage));
        let beside = has_exclusion.then(|| {
            [fit_data, validate].map(|data| FitData { exclusions, ..*data }.residuals(model, scope))
        });
        let [fit_beside, held_out_beside] =
            beside.as_ref().map_or([&fit_after, &held_out_after], |[fit, held_out]| [fit, held_out]);
        for &stage in &scope.stages {
            let noise = fit_data.noise(model, stage);
            let pair = |fitted, held_out| FitAndValidationRms {
                fit: fit_data.rms(fitted, stage),
                validate: validate.rms(held_out, stage),
            };
            remainder.residuals.push(StageResidual {
                stage,
                before: pair(&fit_before, &held_out_before),
                after: pair(&fit_after, &held_out_after),
                beside_exclusions: pair(fit_beside, held_out_beside),
                noise,
                max_described: fit_data.max_described(model, stage),
            });
            remainder.repeats.extend(repeatability(fit_data, &fit_after, stage));
            if let Some(found) = unexplained(fit_data, &fit_after, stage, noise) {
                let residuals = [&fit_after[..], &held_out_after];
                let table = empirical([fit_data, validate], residuals, stage, found.variable);
                remainder.tables.extend(table);
                remainder.unexplained.push(found);
            }
        }
    }
    remainder
}

/// The exclusions of all fits. A local defect of the table also moves the motor, if the loop is closed by the table, too.
fn exclusions_of(fits: &[ScopeFit]) -> Vec<Exclusion> {
    let all = || fits.iter().flat_map(|fit| fit.exclusions.iter().copied());
    let of_motor = all().filter(|exclusion| exclusion.bump(Stage::Table).is_some());
    all().chain(of_motor.map(|exclusion| Exclusion { stage: Stage::Motor, ..exclusion })).collect()
}

/// The effects that could not be tested, and why, with the stages that were evaluated and those that could not be.
fn untested(
    declared: &Axis,
    fit_data: &FitData<'_>,
    (stages, missing): (&[Stage], &[NotTestable]),
    rounds: &[Round],
) -> Vec<EffectNotTestable> {
    let neighbours = Neighbours { is_first: fit_data.axis == 0, others: fit_data.names.len() - 1 };
    effects_not_testable(&declared.settings, neighbours, stages, missing, &tried(declared, rounds))
}

/// Names of the effects that are declared or were tried.
fn tried<'a>(declared: &'a Axis, rounds: &'a [Round]) -> Vec<&'a str> {
    let candidates = rounds.iter().flat_map(|round| &round.candidates).map(|c| c.effect.name());
    declared.effect.iter().map(Effect::name).chain(candidates).collect()
}

/// The ambiguities of the search, whose rivals are also added to the effects found.
fn named_ambiguities(rounds: &[Round], found: &mut [FoundEffect]) -> Vec<Ambiguity> {
    let ambiguities = ambiguities(rounds, found);
    for one in found {
        let of_this = ambiguities.iter().filter(|ambiguity| ambiguity.added.is_same(&one.effect));
        one.rivals = of_this.map(|ambiguity| ambiguity.rival.clone()).collect();
    }
    ambiguities
}

/// The ambiguities of the search between an effect of the final result and an effect that is not in it.
fn ambiguities(rounds: &[Round], found: &[FoundEffect]) -> Vec<Ambiguity> {
    let is_found = |effect: &Effect| found.iter().any(|found| found.effect.is_same(effect));
    let all = rounds.iter().flat_map(|round| &round.ambiguities);
    all.filter(|one| is_found(&one.added) && !is_found(&one.rival)).cloned().collect()
}
