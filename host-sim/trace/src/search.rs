//! The search for the effects that a model lacks, scope by scope: added one after the other as held-out data support
//! them, dropped again where they are not needed.

use super::axis::{is_same, stage_names};
use super::axis_model::AxisModel;
use super::candidates::{Candidate, LEAST_REDUCTION, rank};
use super::fit::{self, Fitted};
use super::held_out::{compare, scores};
use super::intervals::{covariance, half_widths};
use super::last_fit::first_fit;
use super::look_alike::{LookAlike, rivals};
use super::own_error;
use super::residual::{Evidence, Part, rms};
use super::scope::{Mechanics, Scope};
use super::set_aside::Aside;
use super::unexplained::unexplained;
use super::wound;
use model::effects::{Effect, EffectContext, Stage, VelocityLag, initial_guesses};

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
    /// The best that was fitted and not taken, if it gains much: its number. Those at a limit are told for themselves.
    #[must_use]
    pub fn refused(&self) -> Option<usize> {
        const MUCH: f64 = 0.2;
        let is_refused = |c: &Candidate| {
            c.gain > MUCH && c.material && c.fitted.is_some() && c.limit.is_none() && !c.is_supported()
        };
        self.candidates.iter().position(is_refused)
    }
}

/// The search for what an axis's model lacks.
pub struct Search<'a> {
    /// What is explained.
    pub fit_logs: &'a Evidence<'a>,
    /// Name of the axis.
    pub name: &'a str,
    /// Told what is being tried.
    pub say: &'a (dyn Fn(&str) + Sync),
    /// The motor stage, where it can be formed.
    pub servo: Option<Scope>,
    /// What was tried so far.
    pub rounds: Vec<Round>,
}

/// One scope, explained.
#[derive(Clone, Debug)]
pub struct Explained {
    /// Where its effects were looked for.
    pub scope: Scope,
    /// The stages that its effects were fitted to in the end.
    pub fitted_to: Scope,
    /// The fit.
    pub fitted: Fitted,
    /// What was set aside on the way.
    pub aside: Vec<Aside>,
}

impl Search<'_> {
    /// Adds effects to one scope; where what stays is none but would hide or feign one, again without it.
    #[must_use]
    pub fn explain(&mut self, start: &AxisModel, scope: &Scope) -> Explained {
        let mut aside: Vec<Aside> = Vec::new();
        loop {
            let first_round = self.rounds.len();
            let evidence = Evidence { aside: &aside, ..*self.fit_logs };
            let (mut fitted, own) = self.add(&evidence, start, scope);
            let evidence = Evidence { own: &own, ..evidence };
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
    fn keep_what_is_large(&self, evidence: &Evidence<'_>, full: Fitted, scope: &Scope) -> Fitted {
        let whole = self.fit_logs.residuals(&full.model, scope);
        let is_large = |without: &Fitted, with: &Fitted, stage: Stage| {
            let [before, after] = [without, with].map(|fit| rms(&fit.parts, stage, evidence).powi(2));
            before - after > FRINGE * rms(&whole, stage, self.fit_logs).powi(2)
        };
        dropping(full, scope, |full, index| {
            let without = fit::fit(evidence, &full.model.without(index), scope, fit::STEPS);
            let stages = &mut scope.stages.iter();
            (!stages.any(|&stage| is_large(&without, full, stage))).then_some(without)
        })
    }

    /// Adds effects until nothing is supported; drops what a later one made needless. Gives what the trace itself
    /// leaves, too.
    fn add(&mut self, evidence: &Evidence<'_>, start: &AxisModel, scope: &Scope) -> (Fitted, Vec<Part>) {
        let (mut base, mut own) = first_fit(evidence, start, scope);
        let mut added = 0;
        while added < MOST_EFFECTS {
            (base, own) = without_own(evidence, base, own, scope);
            let evidence = &Evidence { own: &own, ..*evidence };
            (self.say)(&format!("{}: trying the catalogue on {}", self.name, stage_names(&scope.stages)));
            let starts = self.starts(&base.model, scope);
            let origin = origin(evidence, &base, scope, added);
            let mut candidates = rank(evidence, &base, &origin, scope, starts);
            let best = self.best(evidence, &base.model, &mut candidates, scope);
            let added_index = best.as_ref().map(|(index, _)| *index);
            let look_alikes = added_index.map_or_else(Vec::new, |added| rivals(&candidates, added, scope));
            let said =
                added_index.map(|index| format!("{}: added {}", self.name, candidates[index].effect.name()));
            self.rounds.push(Round {
                stages: scope.stages.clone(),
                candidates,
                added: added_index,
                look_alikes,
            });
            let Some((_, fitted)) = best else { break };
            (self.say)(&said.unwrap_or_default());
            base = fitted;
            added += 1;
        }
        let seen = Evidence { own: &own, ..*evidence };
        if added > 1 {
            base = self.prune(&seen, base, scope);
        }
        base = self.keep_what_is_certain(&seen, base, scope);
        (base, own)
    }

    /// The best candidate that is supported, and its fit to the end: that may lead on to a limit of its search, and then
    /// the next one is taken.
    fn best(
        &self,
        evidence: &Evidence<'_>,
        base: &AxisModel,
        candidates: &mut [Candidate],
        scope: &Scope,
    ) -> Option<(usize, Fitted)> {
        for (index, candidate) in candidates.iter_mut().enumerate() {
            if !self.is_supported(base, candidate, scope) {
                continue;
            }
            let Some(start) = &candidate.fitted else { continue };
            let fitted = fit::fit(evidence, &start.model, scope, fit::STEPS);
            let last = fitted.model.found().len() - 1;
            candidate.limit = fitted.model.at_limit(last);
            if candidate.limit.is_none() {
                return Some((index, fitted));
            }
        }
        None
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
        let context = EffectContext {
            axis: &model.axis.settings,
            first: self.fit_logs.axis == 0,
            others: &others,
            stages: &scope.stages,
            travel_mm: self.fit_logs.travel_mm(),
        };
        let mut starts = initial_guesses(&context);
        let force_is_logged =
            self.fit_logs.logs.iter().all(|log| log.axes[self.fit_logs.axis].force.is_some());
        starts.retain(|effect| wound::can_show(effect, force_is_logged));
        starts.retain(|effect| !model.found().iter().any(|found| is_same(found, effect)));
        starts
    }

    /// Drops effects whose size might be nothing.
    fn keep_what_is_certain(&self, evidence: &Evidence<'_>, full: Fitted, scope: &Scope) -> Fitted {
        dropping(full, scope, |full, index| {
            let effect = &full.model.found()[index];
            let half = half_widths(effect, &covariance(full), full.model.slots_of(scope, index));
            let least = half.first().copied().unwrap_or(0.0);
            let is_certain = effect.parameters().first().is_none_or(|(_, size)| size.abs() >= least);
            (!is_certain).then(|| {
                (self.say)(&format!("{}: {} might be nothing", self.name, effect.name()));
                fit::fit(evidence, &full.model.without(index), scope, fit::STEPS)
            })
        })
    }

    /// Drops effects that those which came later made needless.
    fn prune(&self, evidence: &Evidence<'_>, full: Fitted, scope: &Scope) -> Fitted {
        dropping(full, scope, |full, index| {
            let without = fit::fit(evidence, &full.model.without(index), scope, fit::STEPS);
            let comparison = compare(&scores(&without), &scores(full), &scope.stages);
            let effect = full.model.found()[index].clone();
            let gain = comparison.iter().map(|c| c.gain).sum();
            let judged = Candidate { effect, comparison, gain, fitted: None, material: true, limit: None };
            let is_alone = scope.stages == [Stage::Force];
            let is_needed = judged.is_supported() || is_alone && judged.is_consistent();
            (!is_needed).then(|| {
                (self.say)(&format!("{}: {} is no longer needed", self.name, judged.effect.name()));
                without
            })
        })
    }
}

/// Goes through the effects that were found in a scope and takes, where there is one, the fit without.
fn dropping(mut full: Fitted, scope: &Scope, better: impl Fn(&Fitted, usize) -> Option<Fitted>) -> Fitted {
    let mut index = 0;
    while let Some(effect) = full.model.found().get(index) {
        match scope.holds(effect).then(|| better(&full, index)).flatten() {
            Some(without) => full = without,
            None => index += 1,
        }
    }
    full
}

/// A fit without the trace's own error, and that, where the model knows it better than it was known.
fn without_own(evidence: &Evidence<'_>, base: Fitted, own: Vec<Part>, scope: &Scope) -> (Fitted, Vec<Part>) {
    let new = own_error::of(evidence, &base.model, scope);
    let after = Evidence { own: &new, ..*evidence };
    let is_less = || {
        let parts = after.residuals(&base.model, scope);
        own_error::is_less(evidence, [&base.parts, &parts], scope)
    };
    if new.is_empty() || !is_less() {
        return (base, own);
    }
    (fit::fit_from(&after, &base.model, scope, fit::STEPS, &base.columns), new)
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
