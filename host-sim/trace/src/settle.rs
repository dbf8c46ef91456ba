//! What is left of the effects that were found: none at a limit of its search, none that the validation logs refute.

use super::axis::{Found, Pair, is_same};
use super::fit;
use super::limits::{self, AtLimit};
use super::refute::{self, Whole};
use super::residual::{Evidence, rms};
use super::search::{Explained, Round};
use model::effects::{Effect, Stage};

/// Steps to where the others are without an effect that is at its optimum.
const STEPS_TO_REPORT: usize = 3;

/// A model of which no effect stands at a limit or is refuted, and the effects that did or were.
pub struct Settled {
    /// The model and its fits.
    pub whole: Whole,
    /// Its effects, in the order in which they were added.
    pub found: Vec<Found>,
    /// Those of which a parameter ended at a limit: in the last fits, or so that they were not added.
    pub refused: Vec<AtLimit>,
    /// Those that the validation logs refute.
    pub refuted: Vec<Found>,
}

/// Drops what the last fits drove to a limit and what the validation logs refute, one after the other.
#[must_use]
pub fn settle(
    [fit_logs, validate]: [&Evidence<'_>; 2],
    mut whole: Whole,
    formed: &[Stage],
    rounds: &[Round],
    say: &(dyn Fn(&str) + Sync),
) -> Settled {
    let name = &fit_logs.names[fit_logs.axis];
    let (mut refused, mut refuted) = (Vec::new(), Vec::new());
    loop {
        if let Some((index, limit)) = limits::first(&whole.model) {
            say(&format!("{name}: {} stands at a limit of its search", limit.effect.name()));
            whole = whole.without(fit_logs, index);
            refused.push(limit);
            continue;
        }
        say(&format!("{name}: holding what was found against the validation logs"));
        let reported = reported(fit_logs, validate, &whole);
        let against = reported.iter().filter_map(|one| Some((one.loss?, one)));
        // As it was added first, then as the one that the whole could do without.
        if let Some((_, one)) = against.min_by(|a, b| a.0.total_cmp(&b.0)) {
            whole = whole.without(fit_logs, one.index);
            refuted.push(one.found.clone());
        } else if let Some(refutation) = refute::worst(fit_logs, validate, &whole, formed) {
            whole = refutation.without;
            refuted.push(refutation.found);
        } else {
            let found = reported.into_iter().map(|one| one.found).collect();
            for limit in limits::refused(rounds) {
                let is_told = |effect: &Effect| is_same(effect, &limit.effect);
                if !whole.model.found().iter().any(is_told)
                    && !refused.iter().any(|at: &AtLimit| is_told(&at.effect))
                {
                    refused.push(limit);
                }
            }
            return Settled { whole, found, refused, refuted };
        }
    }
}

/// A found effect with what speaks against it.
struct Reported {
    found: Found,
    /// Its index in [`AxisModel::found`](super::axis_model::AxisModel::found).
    index: usize,
    /// What the validation logs lose with it, if they refute it.
    loss: Option<f64>,
}

/// The effects found with confidence intervals, and what each is worth on the validation logs: the
/// residual with all effects up to it against that with those before it.
fn reported(fit_logs: &Evidence<'_>, validate: &Evidence<'_>, whole: &Whole) -> Vec<Reported> {
    let mut all = Vec::new();
    let mut last = whole.declared.clone();
    for Explained { scope, aside, .. } in &whole.explained {
        let seen = Evidence { aside, ..*fit_logs };
        for (index, effect) in whole.model.found().iter().enumerate() {
            if !scope.holds(effect) {
                continue;
            }
            let next = fit::fit(&seen, &last.with(effect.clone()), scope, STEPS_TO_REPORT).model;
            let models = [&last, &next];
            let fitted = models.map(|model| fit_logs.residuals(model, scope));
            let held_out = models.map(|model| validate.residuals(model, scope));
            let loss = refute::loss(validate, [&held_out[0], &held_out[1]]);
            let pair = |at: usize, stage| Pair {
                fit: rms(&fitted[at], stage, fit_logs),
                validate: rms(&held_out[at], stage, validate),
            };
            let figures = scope.stages.iter().map(|&stage| (stage, pair(0, stage), pair(1, stage)));
            let reduction = |(_, before, after): &(Stage, Pair, Pair)| {
                1.0 - after.validate / before.validate.max(f64::MIN_POSITIVE)
            };
            // Where it helps most; of one that is refuted, where it harms most.
            let sign = if loss.is_some() { -1.0 } else { 1.0 };
            let most = figures.max_by(|a, b| (sign * reduction(a)).total_cmp(&(sign * reduction(b))));
            let Some((stage, before, after)) = most else { continue };
            let half_widths = whole.half_widths(index);
            let found = Found { effect: effect.clone(), half_widths, stage, before, after };
            all.push(Reported { found, index, loss });
            last = next;
        }
    }
    all
}
