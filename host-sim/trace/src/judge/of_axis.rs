//! Step 5, the judgement of one axis: which hypotheses the validation logs leave, and what remains.

use super::alignment::{self, drift_rate};
use super::axis_findings::AxisFindings;
use super::confirmation::{Confirmed, confirm};
use super::declared_value::declared_values;
use super::found_effect::FoundEffect;
use super::laws::without_map_of_law;
use super::misfit::{Evidence, is_of_another_machine};
use super::not_testable::{EffectNotTestable, effects_not_testable};
use super::remainder::Remainder;
use super::resemblance::compare_with_catalogue;
use super::tool_slopes::ToolSlopes;
use crate::analysis::free_run::{FreeRun, free_runs};
use crate::analysis::law::FoundLaw;
use crate::dropped::{Dropped, Reason};
use crate::fit::axis_data::AxisData;
use crate::fit::axis_model::AxisModel;
use crate::fit::exclusion::Exclusion;
use crate::fit::final_fit::reuse_previous_fit;
use crate::fit::fit_data::FitData;
use crate::fit::fitted_scope::FittedScope;
use crate::fit::model_bias::from_best_start;
use crate::fit::scope::{NotTestable, Scope};
use crate::fit::scope_fit::ScopeFit;
use crate::search::ambiguity::Ambiguity;
use crate::search::hypotheses::Hypotheses;
use crate::search::other_form::is_form_of;
use crate::search::round::Round;
use crate::task::{Job, Task};
use files::log::Unit;
use model::effects::{Effect, Neighbours, Stage};
use model::machine::Axis;

/// Judges the hypotheses on an axis by its validation logs.
#[must_use]
pub fn judge(job: &Job<'_>, axis: &AxisData<'_>, hypotheses: Hypotheses) -> AxisFindings {
    let Hypotheses { written, axis: searched, bias, rounds, scopes, not_testable } = hypotheses;
    let data = axis.without_bias(&bias);
    let tested: Vec<Stage> = scopes.iter().flat_map(|scope| scope.stages.iter().copied()).collect();
    let candidates = drift_rate::with_rates(&data.fit, searched);
    let confirmed = confirm([&data.fit, &data.validate], candidates, &tested, &rounds, job.progress);
    let Confirmed { axis: confirmed, found, refused, refuted, dropped: by_logs } =
        without_map_of_law(&data, confirmed, job.progress);
    let fitted_scopes = FittedScope::of(&confirmed.fits);
    let declared_values = declared_values([&data.fit, &data.validate], &confirmed);
    let tool_slopes = ToolSlopes::of(&data.fit, &confirmed);
    let exclusions = exclusions_of(&confirmed.fits);
    let evidence = Evidence {
        models: [&confirmed.baseline, &confirmed.model],
        values: &declared_values,
        refused: refused.len(),
    };
    let is_of_another_machine = is_of_another_machine(&data.fit, evidence, &scopes);
    let (final_model, final_found, by_machine) = if is_of_another_machine {
        let leaves = |found: &FoundEffect| {
            Dropped::new(&found.effect, Reason::OtherMachine, data.fit.name(), job.progress)
        };
        (confirmed.baseline.clone(), Vec::new(), found.iter().map(leaves).collect())
    } else {
        (previous_fit_if_nothing_new(&data.fit, &written, confirmed.model, &scopes), found, Vec::new())
    };
    let baseline = shown_before(job, &data, &scopes, [confirmed.baseline, final_model.clone()]);
    let (model, remainder) = remaining(job, &data, [&baseline, &final_model], (&scopes, &exclusions));
    let (ambiguities, mut found) = with_rivals(&rounds, final_found);
    let in_search = rounds.iter().flat_map(|round| &round.dropped).cloned();
    let dropped = in_search.chain(by_logs).chain(by_machine).collect();
    alignment::doubt(&data.fit, &model, &scopes, &mut found);
    let Remainder { residuals, unexplained, repeats, tables, laws } = remainder;
    AxisFindings {
        task: job.request.task,
        axis: data.fit.name().to_owned(),
        unit: unit(&data),
        effects_not_testable: untested(&data, (&tested, &not_testable), &rounds),
        ambiguities,
        free_runs: free_runs_of(&data, [&baseline, &model]),
        bias: data.validate.bias.to_vec(),
        declared_values,
        is_of_another_machine,
        baseline,
        model,
        fitted_scopes,
        subtracts_bias: !data.fit.bias.is_empty(),
        laws: laws.into_iter().map(|law| beside_ambiguous(law, &found)).collect(),
        found,
        refused,
        refuted,
        dropped,
        tool_slopes,
        residuals,
        unexplained,
        repeats,
        tables,
        scopes,
        not_testable,
        rounds,
    }
}

/// The model of the machine file, if an earlier trace wrote it and no effect was confirmed: effects that were tried and
/// refuted leave the other values slightly different.
fn previous_fit_if_nothing_new(
    data: &FitData<'_>,
    written: &AxisModel,
    model: AxisModel,
    scopes: &[Scope],
) -> AxisModel {
    if !model.found().is_empty() {
        return model;
    }
    reuse_previous_fit(data, written, &model, scopes).map_or(model, |(previous, _)| previous)
}

/// The model that "before" shows, from the fitted declared model and the model with effects.
fn shown_before(
    job: &Job<'_>,
    data: &AxisData<'_>,
    scopes: &[Scope],
    [baseline, model]: [AxisModel; 2],
) -> AxisModel {
    match job.request.task {
        Task::Evaluate => as_declared(data, scopes),
        // If all effects were dropped, both models are the same.
        Task::Search if model.found().is_empty() => model,
        Task::Search => baseline,
    }
}

/// The values of the machine file; only zeros and instants of the logs are fitted.
fn as_declared(data: &AxisData<'_>, scopes: &[Scope]) -> AxisModel {
    let settings = data.declared.settings.clone().without_tolerances();
    let fixed = Axis { settings, ..data.declared.clone() };
    let model = AxisModel::new(&fixed, data.fit.rates, data.fit.options.model);
    scopes.iter().fold(model, |model, scope| from_best_start(&data.fit, &model, scope).model)
}

/// What remains of the residuals under both models. If requested, what the logs confirm of it is added to the second model as
/// laws or tables, and what remains is that beside these.
fn remaining(
    job: &Job<'_>,
    data: &AxisData<'_>,
    [baseline, model]: [&AxisModel; 2],
    (scopes, exclusions): (&[Scope], &[Exclusion]),
) -> (AxisModel, Remainder) {
    let mut remainder = Remainder::of(data, [baseline, model], scopes, exclusions);
    compare_with_catalogue(&FitData { exclusions, ..data.fit }, (model, scopes), &mut remainder.laws);
    let residuals = || remainder.with_residuals(data, [baseline, model], scopes, exclusions);
    match job.request.tables.then(residuals).flatten() {
        Some(with_residuals) => with_residuals,
        None => (model.clone(), remainder),
    }
}

/// A law with its doubts beside effects that have rivals.
fn beside_ambiguous(law: FoundLaw, found: &[FoundEffect]) -> FoundLaw {
    let ambiguous = found.iter().filter(|found| !found.rivals.is_empty()).map(|found| &found.effect);
    law.doubted_beside(&ambiguous.collect::<Vec<_>>())
}

/// Unit of the channels of an axis.
fn unit(data: &AxisData<'_>) -> Unit {
    let units = data.fit.logs.iter().find_map(|log| log.axes[data.fit.axis].unit);
    units.unwrap_or(Unit::Millimetre)
}

/// The errors of both models under the measured force alone, on the validation logs.
fn free_runs_of(AxisData { validate, .. }: &AxisData<'_>, [before, model]: [&AxisModel; 2]) -> Vec<FreeRun> {
    let logs: Vec<_> = validate.logs.iter().map(|log| (&log.axes[validate.axis], log.sample_s)).collect();
    free_runs(validate.name(), &before.axis, &model.axis, &logs)
}

/// The exclusions of all fits. A local defect of the table also moves the motor, if the loop is closed by the table, too.
fn exclusions_of(fits: &[ScopeFit]) -> Vec<Exclusion> {
    let all = || fits.iter().flat_map(|fit| fit.exclusions.iter().copied());
    let of_motor = all().filter(|exclusion| exclusion.bump(Stage::Table).is_some());
    all().chain(of_motor.map(|exclusion| Exclusion { stage: Stage::Motor, ..exclusion })).collect()
}

/// The effects that could not be tested, and why, with the stages that were evaluated and those that could not be.
fn untested(
    data: &AxisData<'_>,
    (stages, missing): (&[Stage], &[NotTestable]),
    rounds: &[Round],
) -> Vec<EffectNotTestable> {
    let AxisData { declared, fit, .. } = data;
    let neighbours = Neighbours { is_first: fit.axis == 0, others: fit.names.len() - 1 };
    let candidates = rounds.iter().flat_map(|round| &round.candidates).map(|c| c.effect.name());
    let tried: Vec<&str> = declared.effect.iter().map(Effect::name).chain(candidates).collect();
    effects_not_testable(&declared.settings, neighbours, stages, missing, &tried)
}

/// The ambiguities of the search between an effect of the final result and an effect that is not in it, or its other form, and the effects found with
/// these rivals.
fn with_rivals(rounds: &[Round], found: Vec<FoundEffect>) -> (Vec<Ambiguity>, Vec<FoundEffect>) {
    let is_found = |effect: &Effect| found.iter().any(|found| found.effect.is_same(effect));
    let all = rounds.iter().flat_map(|round| &round.ambiguities);
    let is_no_finding = |one: &Ambiguity| !is_found(&one.rival) || is_form_of(&one.rival, &one.added);
    let ambiguities: Vec<Ambiguity> =
        all.filter(|one| is_found(&one.added) && is_no_finding(one)).cloned().collect();
    let with_rivals = |one: FoundEffect| {
        let of_this = ambiguities.iter().filter(|ambiguity| ambiguity.added.is_same(&one.effect));
        FoundEffect { rivals: of_this.map(|ambiguity| ambiguity.rival.clone()).collect(), ..one }
    };
    let found = found.into_iter().map(with_rivals).collect();
    (ambiguities, found)
}
