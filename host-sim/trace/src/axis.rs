//! One axis traced: fit what is declared, add what held-out data support, one after the other.

use serde::Serialize;

use super::axis_model::AxisModel;
use super::empirical::{Empirical, empirical};
use super::fit::{self, Fitted};
use super::free_run::{FreeRun, free_runs};
use super::last_fit::{Finished, finish, first_fit, unmoved};
use super::limits::AtLimit;
use super::look_alike::LookAlike;
use super::not_testable::{EffectNotTestable, effects_not_testable};
use super::refute::Whole;
use super::repeatability::{Repeatability, repeatability};
use super::residual::{Evidence, Part, rms};
use super::scope::{Mechanics, NotTestable, Scope, scopes};
use super::search::{Explained, Round, Search};
use super::settle::{Settled, settle};
use super::unexplained::{Unexplained, unexplained};
use files::log::Unit;
use model::effects::{Effect, Neighbours, Stage};
use model::machine::Axis;

/// An effect that was found, as reported.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The effect at its final parameters.
    pub effect: Effect,
    /// Half widths of the 95 % confidence intervals, in the order of [`Effect::parameters`].
    pub half_widths: Vec<f64>,
    /// Stage that it improves most on the validation logs.
    pub stage: Stage,
    /// That stage's residual with the effects found before it.
    pub before: Pair,
    /// That stage's residual with it.
    pub after: Pair,
}

impl Found {
    /// By how much it lowers the residual on the validation logs, percent of the residual before it.
    #[must_use]
    pub fn validate_reduction_percent(&self) -> f64 {
        100.0 * (1.0 - self.after.validate / self.before.validate.max(f64::MIN_POSITIVE))
    }
}

/// The error of one stage, µm or N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageError {
    /// Stage.
    pub stage: Stage,
    /// Declared model, fitted within its tolerance.
    pub before: Pair,
    /// With the effects found.
    pub after: Pair,
    /// What no model can remove.
    pub noise: f64,
}

/// A figure on the logs that were fitted and on those that were not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Pair {
    /// Fit logs.
    pub fit: f64,
    /// Validation logs.
    pub validate: f64,
}

/// What came out for one axis.
#[derive(Clone, Debug)]
pub struct AxisTrace {
    /// Name.
    pub axis: String,
    /// Unit of its channels.
    pub unit: Unit,
    /// The declared model, fitted.
    pub declared: AxisModel,
    /// The model with the effects found.
    pub model: AxisModel,
    /// Stages that could be formed.
    pub scopes: Vec<Scope>,
    /// Stages that could not, and why.
    pub not_testable: Vec<NotTestable>,
    /// Effects that could not be looked for, and why.
    pub untested: Vec<EffectNotTestable>,
    /// Effects, in the order in which they were added.
    pub found: Vec<Found>,
    /// Effects that were not taken because a parameter ended at a limit of its search.
    pub refused: Vec<AtLimit>,
    /// Effects that the fit logs show and the validation logs refute: no part of the model. `before` is without them.
    pub refuted: Vec<Found>,
    /// Errors by stage.
    pub errors: Vec<StageError>,
    /// What the trace itself leaves on the validation logs.
    pub own: Vec<Part>,
    /// What stays above the noise.
    pub unexplained: Vec<Unexplained>,
    /// How much of what stays comes again with the motion.
    pub repeats: Vec<Repeatability>,
    /// The models under the measured force alone, on the validation logs.
    pub free_runs: Vec<FreeRun>,
    /// What stays, as tables over what it follows.
    pub tables: Vec<Empirical>,
    /// Pairs of effects that the logs cannot tell apart.
    pub look_alikes: Vec<LookAlike>,
    /// The search.
    pub rounds: Vec<Round>,
}

/// Traces one axis. `say` is told what is being tried.
#[must_use]
pub fn trace(
    declared: &Axis,
    fit_logs: &Evidence<'_>,
    validate: &Evidence<'_>,
    say: &(dyn Fn(&str) + Sync),
) -> AxisTrace {
    let name = &fit_logs.names[fit_logs.axis];
    let (scopes, not_testable) = scopes(declared, fit_logs.axis, fit_logs.logs);
    let servo = scopes.iter().find(|scope| scope.stages == [Stage::Motor]).cloned();
    let mut search = Search { fit_logs, name, say, servo, rounds: Vec::new() };

    let mut before = AxisModel::new(declared, fit_logs.rates);
    let mut fits = Vec::new();
    for scope in &scopes {
        say(&format!("{name}: fitting the declared values to {}", stage_names(&scope.stages)));
        let (fitted, _) = first_fit(fit_logs, &before, scope);
        before = fitted.model.clone();
        before.weigh(scope);
        fits.push(fitted);
    }
    let written = AxisModel::new(declared, fit_logs.rates);
    if let Some((stays, _)) = unmoved(fit_logs, &written, &before, &scopes) {
        before = stays;
    }
    let mut model = before.clone();
    let mut explained = Vec::new();
    for scope in &scopes {
        let outcome = search.explain(&model, scope);
        model = outcome.fitted.model.clone();
        model.weigh(scope);
        explained.push(outcome);
    }
    together(fit_logs, &mut model, &mut explained, &scopes, say);

    // What driving a filtered motor gets wrong shows in the loop that was found: once more, without that.
    let Finished { model, explained, own } =
        finish([fit_logs, validate], &written, model, explained, &scopes, say);
    let [fit_logs, validate] =
        &[(fit_logs, &own[0]), (validate, &own[1])].map(|(logs, own)| Evidence { own, ..*logs });
    before = if model.found().is_empty() {
        model.clone()
    } else {
        fitted_alike(fit_logs, &before, fits, &explained, &scopes, say)
    };
    let formed: Vec<Stage> = scopes.iter().flat_map(|scope| scope.stages.iter().copied()).collect();
    let whole = Whole { declared: before.clone(), model, explained };
    let Settled { whole: Whole { model, .. }, found, refused, refuted } =
        settle([fit_logs, validate], whole, &formed, &search.rounds, say);
    // All that was found is taken back: the declared model at its best is what there is.
    if model.found().is_empty() {
        before = model.clone();
    }
    let mut errors = Vec::new();
    let mut rest = Vec::new();
    let mut repeats = Vec::new();
    let mut tables = Vec::new();
    for scope in &scopes {
        let [fit_before, fit_after] = [&before, &model].map(|m| fit_logs.residuals(m, scope));
        let [validate_before, validate_after] = [&before, &model].map(|m| validate.residuals(m, scope));
        for &stage in &scope.stages {
            let noise = fit_logs.noise(&model, stage);
            let pair =
                |fit, held| Pair { fit: rms(fit, stage, fit_logs), validate: rms(held, stage, validate) };
            errors.push(StageError {
                stage,
                before: pair(&fit_before, &validate_before),
                after: pair(&fit_after, &validate_after),
                noise,
            });
            repeats.extend(repeatability(fit_logs, &fit_after, stage));
            if let Some(found) = unexplained(fit_logs, &fit_after, stage, noise, name) {
                let parts = [&fit_after[..], &validate_after];
                tables.extend(empirical([fit_logs, validate], parts, stage, found.variable, name));
                rest.push(found);
            }
        }
    }
    let mut tried: Vec<&str> = declared.effect.iter().map(Effect::name).collect();
    tried.extend(search.rounds.iter().flat_map(|round| &round.candidates).map(|c| c.effect.name()));
    let neighbours = Neighbours { is_first: fit_logs.axis == 0, others: fit_logs.names.len() - 1 };
    let untested = effects_not_testable(&declared.settings, neighbours, &formed, &not_testable, &tried);
    let held_out: Vec<_> = validate.logs.iter().map(|log| (&log.axes[validate.axis], log.sample_s)).collect();
    let free_runs = free_runs(name, &before.axis, &model.axis, &held_out);
    let is_found = |alike: &&LookAlike| found.iter().any(|found| is_same(&found.effect, &alike.added));
    let is_rival = |alike: &&LookAlike| !found.iter().any(|found| is_same(&found.effect, &alike.rival));
    let all = search.rounds.iter().flat_map(|round| &round.look_alikes);
    let look_alikes = all.filter(is_found).filter(is_rival).cloned().collect();
    AxisTrace {
        look_alikes,
        refused,
        refuted,
        tables,
        untested,
        axis: name.clone(),
        unit: fit_logs.logs.iter().find_map(|log| log.axes[fit_logs.axis].unit).unwrap_or(Unit::Millimetre),
        declared: before,
        model,
        scopes,
        not_testable,
        found,
        errors,
        unexplained: rest,
        repeats,
        free_runs,
        rounds: search.rounds,
        own: validate.own.to_vec(),
    }
}

/// The declared model fitted as what was found is: the same is set aside, and the same error taken out.
fn fitted_alike(
    fit_logs: &Evidence<'_>,
    declared: &AxisModel,
    fits: Vec<Fitted>,
    explained: &[Explained],
    scopes: &[Scope],
    say: &(dyn Fn(&str) + Sync),
) -> AxisModel {
    let as_declared = |(fitted, last): (Fitted, &Explained)| {
        let (scope, aside) = (last.scope.clone(), last.aside.clone());
        Explained { fitted_to: scope.clone(), scope, fitted, aside }
    };
    let fits: Vec<Explained> = fits.into_iter().zip(explained).map(as_declared).collect();
    again(fit_logs, declared, &fits, scopes, say).0
}

/// Fits all that was found once more, scope by scope.
pub(super) fn again(
    evidence: &Evidence<'_>,
    model: &AxisModel,
    explained: &[Explained],
    scopes: &[Scope],
    say: &(dyn Fn(&str) + Sync),
) -> (AxisModel, Vec<Explained>) {
    let (mut model, mut explained) = (model.clone(), explained.to_vec());
    for outcome in &mut explained {
        let seen = Evidence { aside: &outcome.aside, ..*evidence };
        // The derivatives hold where little moves, unless they are those of the stages that belong together.
        let is_own = outcome.fitted_to.stages == outcome.scope.stages;
        let known = if is_own { &outcome.fitted.columns[..] } else { &[] };
        outcome.fitted = fit::fit_from(&seen, &model, &outcome.scope, fit::STEPS, known);
        model = outcome.fitted.model.clone();
        model.weigh(&outcome.scope);
    }
    together(evidence, &mut model, &mut explained, scopes, say);
    (model, explained)
}

/// Fits all that was found to the scopes that belong together, if there are such.
fn together(
    evidence: &Evidence<'_>,
    model: &mut AxisModel,
    explained: &mut [Explained],
    scopes: &[Scope],
    say: &(dyn Fn(&str) + Sync),
) {
    let Some(joint) = joint(scopes) else { return };
    say(&format!("{}: fitting all to {}", evidence.names[evidence.axis], stage_names(&joint.stages)));
    let fitted = fit::fit(evidence, model, &joint, fit::STEPS);
    *model = fitted.model.clone();
    // Whichever scope an effect was found in, its interval is that of this fit.
    for outcome in explained {
        (outcome.fitted_to, outcome.fitted) = (joint.clone(), fitted.clone());
    }
}

/// Where friction is seen alone, force and closed loop are two views of the same few newtons, the one sharp at
/// fast changes and the other at slow ones: what was found is fitted to both in the end.
fn joint(scopes: &[Scope]) -> Option<Scope> {
    let has = |stage| scopes.iter().any(|scope| scope.stages == [stage]);
    let stages = vec![Stage::Force, Stage::Motor];
    (has(Stage::Force) && has(Stage::Motor)).then_some(Scope { stages, mechanics: Mechanics::All })
}

/// Whether two entries would be the same effect twice: name, and source where there is one.
#[must_use]
pub fn is_same(a: &Effect, b: &Effect) -> bool {
    a.is_same(b)
}

/// Unit of a stage's residual as people write it, and as a key of the JSON ends.
#[must_use]
pub const fn residual_unit(unit: Unit, stage: Stage) -> (&'static str, &'static str) {
    match (unit, stage) {
        (Unit::Millimetre, Stage::Force) => ("N", "n"),
        (Unit::Millimetre, _) => ("µm", "um"),
        (Unit::Degree, Stage::Force) => ("N·m", "nm"),
        (Unit::Degree, _) => ("mdeg", "mdeg"),
    }
}

/// Names of stages for people.
#[must_use]
pub fn stage_names(stages: &[Stage]) -> String {
    let name = |stage: &Stage| match stage {
        Stage::Motor => "motor",
        Stage::Table => "table",
        Stage::Tool => "tool",
        Stage::Force => "force",
    };
    stages.iter().map(name).collect::<Vec<_>>().join(" and ")
}
