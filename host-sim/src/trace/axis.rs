//! One axis traced: fit what is declared, add what held-out data support, one after the other.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::candidates::{Candidate, LEAST_REDUCTION, rank};
use super::empirical::{Empirical, empirical};
use super::fit::{self, Fitted, normal};
use super::free_run::{FreeRun, free_runs};
use super::held_out::{compare, scores};
use super::look_alike::{LookAlike, rivals};
use super::model::AxisModel;
use super::repeatability::{Repeatability, repeatability};
use super::residual::{Evidence, Part, rms};
use super::scope::{Mechanics, NotTestable, Scope, scopes};
use super::set_aside::Aside;
use super::unexplained::{Unexplained, unexplained};
use super::untested::{Untested, untested};
use super::wound;
use crate::effects::{Coordinate, Effect, Stage, Surroundings, VelocityLag, candidates};
use crate::log::Unit;
use crate::machine::Axis;

/// Most effects that one scope may gain.
const MOST_EFFECTS: usize = 10;

/// Most remainders that one scope sets aside.
const MOST_ASIDE: usize = 2;

/// A residual so many times its noise has bent the declared values.
const GROSS: f64 = 20.0;

/// What the closed loop may lose of what a candidate gains.
const LOOP_SHARE: f64 = 0.25;

/// Share of the power that was set aside which may be left over where it fades out.
const FRINGE: f64 = 0.002;

/// Steps of the fit of the declared values.
const FIT_STEPS: usize = 10;

/// 97.5 % point of Student's t at 71 degrees of freedom: blocks of three logs.
const T_975: f64 = 1.99;

/// One round of the search: what was tried, and whether the best was taken.
#[derive(Clone, Debug)]
pub struct Round {
    /// Where it was looked for.
    pub stages: Vec<Stage>,
    /// All candidates, best first.
    pub candidates: Vec<Candidate>,
    /// Number of the one that was added: the best of those that held-out data support.
    pub added: Option<usize>,
    /// Those that explain as much as the one that was added.
    pub look_alikes: Vec<LookAlike>,
}

impl Round {
    /// The best that was fitted and not taken, if it gains much: its number.
    #[must_use]
    pub fn refused(&self) -> Option<usize> {
        const MUCH: f64 = 0.2;
        let is_refused =
            |c: &Candidate| c.gain > MUCH && c.material && c.fitted.is_some() && !c.is_supported();
        self.candidates.iter().position(is_refused)
    }
}

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
    pub untested: Vec<Untested>,
    /// Effects, in the order in which they were added.
    pub found: Vec<Found>,
    /// Errors by stage.
    pub errors: Vec<StageError>,
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
    for scope in &scopes {
        say(&format!("{name}: fitting the declared values to {}", stage_names(&scope.stages)));
        before = fit::fit(fit_logs, &before, scope, FIT_STEPS).model;
        before.weigh(scope);
    }
    let mut model = before.clone();
    let mut explained = Vec::new();
    for scope in &scopes {
        let outcome = search.explain(&model, scope);
        model = outcome.fitted.model.clone();
        model.weigh(scope);
        explained.push(outcome);
    }
    if let Some(joint) = joint(&scopes) {
        say(&format!("{name}: fitting all to {}", stage_names(&joint.stages)));
        let fitted = fit::fit(fit_logs, &model, &joint, FIT_STEPS);
        model = fitted.model.clone();
        // Whichever scope an effect was found in, its interval is that of this fit.
        for outcome in &mut explained {
            (outcome.fitted_to, outcome.fitted) = (joint.clone(), fitted.clone());
        }
    }
    let found = reported(fit_logs, validate, &before, &model, &explained);
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
    let formed: Vec<Stage> = scopes.iter().flat_map(|scope| scope.stages.iter().copied()).collect();
    let mut tried: Vec<&str> = declared.effect.iter().map(Effect::name).collect();
    tried.extend(search.rounds.iter().flat_map(|round| &round.candidates).map(|c| c.effect.name()));
    let untested = untested(declared, fit_logs.axis, fit_logs.names.len(), &formed, &not_testable, &tried);
    let held_out: Vec<_> = validate.logs.iter().map(|log| (&log.axes[validate.axis], log.sample_s)).collect();
    let free_runs = free_runs(name, &before.axis, &model.axis, &held_out);
    let is_found = |alike: &&LookAlike| found.iter().any(|found| is_same(&found.effect, &alike.added));
    let is_rival = |alike: &&LookAlike| !found.iter().any(|found| is_same(&found.effect, &alike.rival));
    let all = search.rounds.iter().flat_map(|round| &round.look_alikes);
    let look_alikes = all.filter(is_found).filter(is_rival).cloned().collect();
    AxisTrace {
        look_alikes,
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
    }
}

/// Where friction is seen alone, force and closed loop are two views of the same few newtons, the one sharp at
/// fast changes and the other at slow ones: what was found is fitted to both in the end.
fn joint(scopes: &[Scope]) -> Option<Scope> {
    let has = |stage| scopes.iter().any(|scope| scope.stages == [stage]);
    let stages = vec![Stage::Force, Stage::Motor];
    (has(Stage::Force) && has(Stage::Motor)).then_some(Scope { stages, mechanics: Mechanics::All })
}

struct Search<'a> {
    fit_logs: &'a Evidence<'a>,
    name: &'a str,
    say: &'a (dyn Fn(&str) + Sync),
    /// The motor stage, where it can be formed.
    servo: Option<Scope>,
    rounds: Vec<Round>,
}

/// One scope, explained.
struct Explained {
    scope: Scope,
    /// The stages that its effects were fitted to in the end.
    fitted_to: Scope,
    fitted: Fitted,
    /// What was set aside on the way.
    aside: Vec<Aside>,
}

impl Search<'_> {
    /// Adds effects to one scope; where what stays is none but would hide or feign one, again without it.
    fn explain(&mut self, start: &AxisModel, scope: &Scope) -> Explained {
        let mut aside: Vec<Aside> = Vec::new();
        loop {
            let first_round = self.rounds.len();
            let evidence = Evidence { aside: &aside, ..*self.fit_logs };
            let mut fitted = self.add(&evidence, start, scope);
            let mut new = remainders(&evidence, &fitted, scope, self.name);
            let refused = self.rounds.last().and_then(|round| round.candidates.get(round.refused()?));
            if let (true, Some(refused)) = (new.is_empty(), refused.and_then(|c| c.fitted.as_ref())) {
                // What was refused because one log got worse may have shown there what is to be set aside.
                new = remainders(&evidence, refused, scope, self.name);
            }
            if new.is_empty() || aside.len() >= MOST_ASIDE {
                if !aside.is_empty() {
                    fitted = self.keep_what_is_large(&evidence, fitted, scope);
                }
                return Explained { scope: scope.clone(), fitted_to: scope.clone(), fitted, aside };
            }
            self.rounds.truncate(first_round);
            aside.extend(new);
        }
    }

    /// Drops what is small beside that which was set aside: its fringes look like it.
    fn keep_what_is_large(&self, evidence: &Evidence<'_>, mut full: Fitted, scope: &Scope) -> Fitted {
        let whole = self.fit_logs.residuals(&full.model, scope);
        let is_large = |without: &Fitted, with: &Fitted, stage: Stage| {
            let [before, after] = [without, with].map(|fit| rms(&fit.parts, stage, evidence).powi(2));
            before - after > FRINGE * rms(&whole, stage, self.fit_logs).powi(2)
        };
        let mut index = 0;
        while index < full.model.found().len() {
            if scope.holds(&full.model.found()[index]) {
                let without = fit::fit(evidence, &full.model.without(index), scope, FIT_STEPS);
                if !scope.stages.iter().any(|&stage| is_large(&without, &full, stage)) {
                    full = without;
                    continue;
                }
            }
            index += 1;
        }
        full
    }

    /// Adds effects until nothing is supported; drops what a later one made needless.
    fn add(&mut self, evidence: &Evidence<'_>, start: &AxisModel, scope: &Scope) -> Fitted {
        let mut base = fit::fit(evidence, start, scope, FIT_STEPS);
        let mut added = 0;
        while added < MOST_EFFECTS {
            (self.say)(&format!("{}: trying the catalogue on {}", self.name, stage_names(&scope.stages)));
            let starts = self.starts(&base.model, scope);
            let origin = origin(evidence, &base, scope, added);
            let candidates = rank(evidence, &base, &origin, scope, starts);
            let added_index = candidates.iter().position(|c| self.is_supported(&base.model, c, scope));
            let best = added_index.map(|index| candidates[index].clone());
            let look_alikes = added_index.map_or_else(Vec::new, |added| rivals(&candidates, added, scope));
            self.rounds.push(Round {
                stages: scope.stages.clone(),
                candidates,
                added: added_index,
                look_alikes,
            });
            let Some(Candidate { effect, fitted: Some(fitted), .. }) = best else { break };
            (self.say)(&format!("{}: added {}", self.name, effect.name()));
            base = fit::fit(evidence, &fitted.model, scope, FIT_STEPS);
            added += 1;
        }
        if added > 1 {
            base = self.prune(evidence, base, scope);
        }
        self.keep_what_is_certain(evidence, base, scope)
    }

    /// Whether held-out data support a candidate and the closed loop agrees. Where friction is seen alone, the
    /// loop stands in for standard errors, too: what is only here or there along the travel or after a
    /// reversal differs from block to block by its nature, which looks like chance.
    fn is_supported(&self, base: &AxisModel, candidate: &Candidate, scope: &Scope) -> bool {
        let agrees = || self.loop_loss(base, candidate, scope);
        let is_alone = scope.stages == [Stage::Force];
        let shapes_loop = candidate.effect.stages().contains(&Stage::Motor);
        if candidate.is_supported() {
            // What is plain to see in the force may show what else the model of the loop lacks.
            let most = (0.5 * LEAST_REDUCTION).max(LOOP_SHARE * candidate.gain);
            return agrees().is_none_or(|loss| loss <= most);
        }
        let is_confirmed = || agrees().is_some_and(|loss| loss <= -0.5 * LEAST_REDUCTION);
        is_alone && shapes_loop && candidate.is_consistent() && is_confirmed()
    }

    /// What the closed loop, which took no part in fitting a mechanical effect, loses with it: by how
    /// much the logarithm of its error grows. `None` where it does not tell.
    fn loop_loss(&self, base: &AxisModel, candidate: &Candidate, scope: &Scope) -> Option<f64> {
        let shapes_loop = candidate.effect.stages().contains(&Stage::Motor);
        let (Some(servo), Some(fitted), true) = (&self.servo, &candidate.fitted, shapes_loop) else {
            return None;
        };
        if servo.stages == scope.stages {
            return None;
        }
        let [before, after] = [base, &fitted.model].map(|model| self.in_loop(model, servo, scope));
        let of_log =
            |parts: &[Part], log: usize| rms(&parts[log..=log], Stage::Motor, self.fit_logs).max(1e-12);
        let logs = before.len();
        let loss = (0..logs).map(|log| (of_log(&after, log) / of_log(&before, log)).ln()).sum::<f64>();
        Some(loss / logs.max(1) as f64)
    }

    /// The motor stage of a model. Where friction is seen alone the drive's own lag, which is only found
    /// later, is taken out first: it would hide what friction does to the loop.
    fn in_loop(&self, model: &AxisModel, servo: &Scope, scope: &Scope) -> Vec<Part> {
        const STEPS: usize = 3;
        let has_lag = model.axis.effect.iter().any(|effect| matches!(effect, Effect::VelocityLag(_)));
        if scope.stages != [Stage::Force] || has_lag {
            return self.fit_logs.residuals(model, servo);
        }
        let mut model = model.with(Effect::VelocityLag(VelocityLag::default()));
        model.weigh(scope);
        self.fit_logs.residuals(&fit::fit(self.fit_logs, &model, servo, STEPS).model, servo)
    }

    /// Every starting point of every effect that the model has not yet.
    fn starts(&self, model: &AxisModel, scope: &Scope) -> Vec<Effect> {
        let names = self.fit_logs.names;
        let others: Vec<String> = names.iter().filter(|name| *name != self.name).cloned().collect();
        let around = Surroundings {
            axis: &model.axis,
            first: self.fit_logs.axis == 0,
            others: &others,
            stages: &scope.stages,
            travel_mm: self.fit_logs.travel_mm(),
        };
        let mut starts = candidates(&around);
        let force_is_logged =
            self.fit_logs.logs.iter().all(|log| log.axes[self.fit_logs.axis].force.is_some());
        starts.retain(|effect| wound::can_show(effect, force_is_logged));
        starts.retain(|effect| !model.found().iter().any(|found| is_same(found, effect)));
        starts
    }

    /// Drops effects whose size might be nothing.
    fn keep_what_is_certain(&self, evidence: &Evidence<'_>, mut full: Fitted, scope: &Scope) -> Fitted {
        let mut index = 0;
        while index < full.model.found().len() {
            let effect = &full.model.found()[index];
            if scope.holds(effect) {
                let slots = full.model.slots_of(scope, index);
                let all = covariance(&full);
                let own = all.view((slots.start, slots.start), (slots.len(), slots.len())).into_owned();
                let half = half_widths(effect, &own).first().copied().unwrap_or(0.0);
                if effect.parameters().first().is_some_and(|(_, size)| size.abs() < half) {
                    (self.say)(&format!("{}: {} might be nothing", self.name, effect.name()));
                    full = fit::fit(evidence, &full.model.without(index), scope, FIT_STEPS);
                    continue;
                }
            }
            index += 1;
        }
        full
    }

    fn prune(&self, evidence: &Evidence<'_>, mut full: Fitted, scope: &Scope) -> Fitted {
        let mut index = 0;
        while index < full.model.found().len() {
            if scope.holds(&full.model.found()[index]) {
                let without = fit::fit(evidence, &full.model.without(index), scope, FIT_STEPS);
                let comparison = compare(&scores(&without), &scores(&full), &scope.stages);
                let effect = full.model.found()[index].clone();
                let gain = comparison.iter().map(|c| c.gain).sum();
                let judged = Candidate { effect, comparison, gain, fitted: None, material: true };
                let is_alone = scope.stages == [Stage::Force];
                if !(judged.is_supported() || is_alone && judged.is_consistent()) {
                    (self.say)(&format!("{}: {} is no longer needed", self.name, judged.effect.name()));
                    full = without;
                    continue;
                }
            }
            index += 1;
        }
        full
    }
}

/// Where candidates start from: where the declared values were fitted to, but for a gross effect, such as a wide
/// gap. That has bent them to their bounds, and from there no fit finds the way back.
fn origin(evidence: &Evidence<'_>, base: &Fitted, scope: &Scope, added: usize) -> Fitted {
    let gross =
        |&stage: &Stage| rms(&base.parts, stage, evidence) > GROSS * evidence.noise(&base.model, stage);
    if added > 0 || scope.mechanics != Mechanics::All || !scope.stages.iter().any(gross) {
        return base.clone();
    }
    fit::fit(evidence, &base.model.unbent(), scope, 0)
}

/// What stays of a scope's stages and is to be set aside.
fn remainders(evidence: &Evidence<'_>, fitted: &Fitted, scope: &Scope, name: &str) -> Vec<Aside> {
    let of_stage = |&stage: &Stage| {
        let noise = evidence.noise(&fitted.model, stage);
        let rest = unexplained(evidence, &fitted.parts, stage, noise, name)?;
        Aside::of(evidence, &rest, noise, &fitted.parts)
    };
    scope.stages.iter().filter_map(of_stage).collect()
}

/// Whether two entries would be the same effect twice: name, and source where there is one.
#[must_use]
pub fn is_same(a: &Effect, b: &Effect) -> bool {
    match (a, b) {
        (Effect::Crosstalk(a), Effect::Crosstalk(b)) => a.source == b.source,
        (Effect::Straightness(a), Effect::Straightness(b)) => a.source == b.source,
        (Effect::Latency(a), Effect::Latency(b)) => a.channel == b.channel,
        _ => a.name() == b.name(),
    }
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

/// The effects found with confidence intervals, and what each is worth on the validation logs: the
/// residual with all effects up to it against that with those before it.
fn reported(
    fit_logs: &Evidence<'_>,
    validate: &Evidence<'_>,
    before: &AxisModel,
    model: &AxisModel,
    explained: &[Explained],
) -> Vec<Found> {
    let mut found = Vec::new();
    let mut last = before.clone();
    for Explained { scope, fitted_to, fitted, aside } in explained {
        let seen = Evidence { aside, ..*fit_logs };
        let covariance = covariance(fitted);
        for (index, effect) in model.found().iter().enumerate() {
            if !scope.holds(effect) {
                continue;
            }
            let next = fit::fit(&seen, &last.with(effect.clone()), scope, FIT_STEPS).model;
            let [worse, better] = [&last, &next].map(|model| {
                let of =
                    |evidence: &Evidence<'_>, stage| rms(&evidence.residuals(model, scope), stage, evidence);
                let pair = |&stage: &Stage| {
                    (stage, Pair { fit: of(fit_logs, stage), validate: of(validate, stage) })
                };
                scope.stages.iter().map(pair).collect::<Vec<_>>()
            });
            let reduction = |(before, after): &(&(Stage, Pair), &(Stage, Pair))| {
                1.0 - after.1.validate / before.1.validate.max(f64::MIN_POSITIVE)
            };
            let most = worse.iter().zip(&better).max_by(|a, b| reduction(a).total_cmp(&reduction(b)));
            let Some((&(stage, before), &(_, after))) = most else { continue };
            let slots = fitted.model.slots_of(fitted_to, index);
            let own = covariance.view((slots.start, slots.start), (slots.len(), slots.len())).into_owned();
            found.push(Found {
                effect: effect.clone(),
                half_widths: half_widths(effect, &own),
                stage,
                before,
                after,
            });
            last = next;
        }
    }
    found
}

/// Covariance of a fit's slots: H⁻¹·(Σ g gᵀ)·H⁻¹ over the blocks of the logs, which holds for errors
/// that are correlated within a block.
fn covariance(fitted: &Fitted) -> DMatrix<f64> {
    let n = fitted.slots.len();
    let (curvature, _) = normal(&fitted.blocks, &fitted.slots);
    let mut regular =
        curvature.clone() + DMatrix::from_diagonal(&(curvature.diagonal() * 1e-9).add_scalar(1e-12));
    // A slot at its bound is held there: the others are as certain as if it were known.
    for (i, slot) in fitted.slots.iter().enumerate() {
        let Coordinate { value, lower, upper, .. } = slot.coordinate;
        let near = 1e-6 * (upper - lower);
        if value - lower < near || upper - value < near {
            regular[(i, i)] += 1e9 * (1.0 + curvature[(i, i)]);
        }
    }
    let inverse = regular.cholesky().map_or_else(|| DMatrix::zeros(n, n), |c| c.inverse());
    // Blocks of all stages over one stretch of one log go together.
    let mut stretches: Vec<((usize, usize), DVector<f64>)> = Vec::new();
    for block in &fitted.blocks {
        let key = (block.log, block.part);
        match stretches.iter_mut().find(|(k, _)| *k == key) {
            Some((_, sum)) => *sum += &block.gradient,
            None => stretches.push((key, block.gradient.clone())),
        }
    }
    let meat = stretches.iter().fold(DMatrix::zeros(n, n), |sum, (_, g)| sum + g * g.transpose());
    &inverse * meat * &inverse
}

/// Half widths of the parameters' intervals from the covariance of the coordinates.
fn half_widths(effect: &Effect, covariance: &DMatrix<f64>) -> Vec<f64> {
    let coordinates = effect.coordinates();
    let values: Vec<f64> = coordinates.iter().map(|c| c.value).collect();
    let parameters = effect.parameters();
    let mut jacobian = DMatrix::zeros(parameters.len(), values.len());
    for (j, coordinate) in coordinates.iter().enumerate() {
        let mut moved = values.clone();
        let step = 1e-3 * coordinate.step;
        moved[j] += step;
        for (i, (name, value)) in effect.at(&moved).parameters().iter().enumerate() {
            let mut change = value - parameters[i].1;
            if name.starts_with("phase") {
                change =
                    (change + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
            }
            jacobian[(i, j)] = change / step;
        }
    }
    let spread = &jacobian * covariance * jacobian.transpose();
    spread.diagonal().iter().map(|variance| T_975 * variance.max(0.0).sqrt()).collect()
}
