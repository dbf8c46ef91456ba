//! Effects that the fit logs show and the validation logs refute.
//!
//! The one decision in which validation logs take part. An effect that was found is fitted away again, everything else
//! fitted anew to the fit logs; where the validation logs are explained better without it, it is reported as refuted
//! and is no part of the model.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::axis::{Found, Pair};
use super::axis_model::AxisModel;
use super::fit::{self, BLOCKS, Column};
use super::intervals::{covariance, half_widths};
use super::residual::{Evidence, Part, rms};
use super::scope::{Mechanics, Scope};
use super::search::Explained;
use model::effects::{Effect, Stage};

/// A residual that grows by a tenth is more than an effect costs whose parameters are uncertain: p parameters from n
/// independent stretches cost p/(2n) of log-likelihood on other data of the same machine, 0.06 for three parameters from
/// the 24 blocks of one log. As a loss of log-likelihood a sample.
const GROSS: f64 = 0.095;

/// What fitting the declared values anew shifts where the validation logs do not show the effect at all.
const TRIFLE: f64 = 0.005;

/// A loss below [`GROSS`] counts from so many of its standard errors on: chance passes them once in forty times.
const BEYOND_CHANCE: f64 = 2.0;

/// A model of an axis with the fits that led to it.
#[derive(Clone, Debug)]
pub struct Whole {
    /// The declared model, fitted.
    pub declared: AxisModel,
    /// The model.
    pub model: AxisModel,
    /// Its fits, scope by scope.
    pub explained: Vec<Explained>,
}

/// An effect that is refuted, and the model without it.
pub struct Refutation {
    /// The effect, with the residual of the stage that it makes worse most: `before` without it, `after` with it.
    pub found: Found,
    /// Without it.
    pub without: Whole,
}

impl Whole {
    /// The same without a found effect, by its index in [`AxisModel::found`]; what it shaped is fitted anew.
    #[must_use]
    pub fn without(&self, evidence: &Evidence<'_>, index: usize) -> Self {
        let effect = &self.model.found()[index];
        let mut model = self.model.without(index);
        let mut explained = self.explained.clone();
        // Scopes that were fitted together in the end have one fit. What comes after hangs on it: the instants of the
        // table are those that the tool is held against.
        let mut done: Option<usize> = None;
        for i in 0..explained.len() {
            let Explained { scope, fitted_to, fitted, aside } = &self.explained[i];
            if let Some(other) = done.filter(|other| self.explained[*other].fitted_to == *fitted_to) {
                explained[i].fitted = explained[other].fitted.clone();
                continue;
            }
            if done.is_none() && !fitted_to.holds(effect) {
                continue;
            }
            // An effect that is none may have led the fit astray: without any it starts where the declared model did.
            if !model.found().iter().any(|other| fitted_to.holds(other)) {
                let slots = self.declared.slots(fitted_to);
                let values: Vec<f64> = slots.iter().map(|slot| slot.coordinate.value).collect();
                model = model.at(fitted_to, &values);
            }
            let known = columns_without(&self.model, fitted_to, index, &fitted.columns);
            let seen = Evidence { aside, ..*evidence };
            let fitted = fit::fit_from(&seen, &model, fitted_to, fit::STEPS, &known);
            model = fitted.model.clone();
            model.weigh(scope);
            explained[i].fitted = fitted;
            done = Some(i);
        }
        Self { declared: self.declared.clone(), model, explained }
    }

    /// Half widths of the intervals of a found effect's parameters.
    #[must_use]
    pub fn half_widths(&self, index: usize) -> Vec<f64> {
        let effect = &self.model.found()[index];
        let outcome = self.explained.iter().find(|outcome| outcome.scope.holds(effect));
        outcome.map_or_else(Vec::new, |Explained { fitted_to, fitted, .. }| {
            half_widths(effect, &covariance(fitted), fitted.model.slots_of(fitted_to, index))
        })
    }
}

/// The derivatives of a fit that hold without an effect, where they do: an instant that the effect told has none.
fn columns_without(model: &AxisModel, scope: &Scope, index: usize, columns: &[Column]) -> Vec<Column> {
    let effect = &model.found()[index];
    if !scope.holds(effect) {
        return columns.to_vec();
    }
    if matches!(effect, Effect::Latency(_) | Effect::VelocityLag(_)) {
        return Vec::new();
    }
    let slots = model.slots_of(scope, index);
    let others = columns.iter().enumerate().filter(|(slot, _)| !slots.contains(slot));
    others.map(|(_, column)| column.clone()).collect()
}

/// The found effect that the validation logs refute most clearly, if they refute one.
#[must_use]
pub fn worst(
    fit_logs: &Evidence<'_>,
    validate: &Evidence<'_>,
    whole: &Whole,
    formed: &[Stage],
) -> Option<Refutation> {
    let judged = |index: usize| {
        let effect = &whole.model.found()[index];
        let stages = effect.stages().iter().copied().filter(|stage| formed.contains(stage)).collect();
        let scope = Scope { stages, mechanics: Mechanics::None };
        let without = whole.without(fit_logs, index);
        let models = [&without.model, &whole.model];
        let held_out = models.map(|model| validate.residuals(model, &scope));
        let gain = loss(validate, [&held_out[0], &held_out[1]])?;
        let fitted = models.map(|model| fit_logs.residuals(model, &scope));
        let pair = |at: usize, stage| Pair {
            fit: rms(&fitted[at], stage, fit_logs),
            validate: rms(&held_out[at], stage, validate),
        };
        let of_stage = |&stage: &Stage| (stage, pair(0, stage), pair(1, stage));
        let shown = scope.stages.iter().map(of_stage).filter(|(_, before, _)| before.validate > 0.0);
        let ratio = |(_, before, after): &(Stage, Pair, Pair)| after.validate / before.validate;
        let (stage, before, after) = shown.max_by(|a, b| ratio(a).total_cmp(&ratio(b)))?;
        let found =
            Found { effect: effect.clone(), half_widths: whole.half_widths(index), stage, before, after };
        Some((gain, Refutation { found, without }))
    };
    let all: Vec<_> = (0..whole.model.found().len()).into_par_iter().filter_map(judged).collect();
    all.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, refutation)| refutation)
}

/// The gain of log-likelihood a sample, below zero, if the residuals of held-out logs speak against an effect: those
/// without it and those with it.
#[must_use]
pub fn loss(evidence: &Evidence<'_>, parts: [&[Part]; 2]) -> Option<f64> {
    let cells = cells(evidence, parts);
    let gain = gain(&cells, None);
    is_refuted(gain, standard_error(&cells)).then_some(gain)
}

/// Whether a gain of log-likelihood a sample, with its standard error, speaks against an effect.
fn is_refuted(gain: f64, error: f64) -> bool {
    gain < -GROSS || gain < -TRIFLE.max(BEYOND_CHANCE * error)
}

/// Σr² of one block of one stage of one log, without an effect and with it.
#[derive(Clone, Copy, Debug)]
struct Cell {
    stage: Stage,
    log: usize,
    block: usize,
    squares: [f64; 2],
    samples: usize,
}

fn cells(evidence: &Evidence<'_>, [without, with]: [&[Part]; 2]) -> Vec<Cell> {
    let mut cells = Vec::new();
    for (before, after) in without.iter().zip(with) {
        let counts = evidence.counting(before.stage, before.log);
        let count = before.values.len();
        let length = count.div_ceil(BLOCKS).max(1);
        let blocks = (0..count).step_by(length).map(|start| start..(start + length).min(count));
        for (block, range) in blocks.enumerate() {
            let squares =
                [before, after].map(|part| part.values[range.clone()].iter().map(|r| r * r).sum::<f64>());
            let samples = range.filter(|&i| counts(i)).count();
            if samples > 0 {
                cells.push(Cell { stage: before.stage, log: before.log, block, squares, samples });
            }
        }
    }
    cells
}

/// Log-likelihood a sample that the effect gains: ½·ln(Σr² without / Σr² with) of each log with its own noise, the mean
/// over the samples of a stage, summed over the stages. Without the cells of one block of one log, if it is given.
fn gain(cells: &[Cell], left_out: Option<(usize, usize)>) -> f64 {
    let mut logs: Vec<Cell> = Vec::new();
    for cell in cells.iter().filter(|cell| left_out != Some((cell.log, cell.block))) {
        match logs.iter_mut().find(|log| (log.stage, log.log) == (cell.stage, cell.log)) {
            Some(log) => {
                log.samples += cell.samples;
                (0..2).for_each(|i| log.squares[i] += cell.squares[i]);
            }
            None => logs.push(*cell),
        }
    }
    let of_stage =
        |stage| logs.iter().filter(move |log| log.stage == stage).map(|log| log.samples).sum::<usize>();
    let of_log = |log: &Cell| {
        let [without, with] = log.squares.map(|squares| squares.max(f64::MIN_POSITIVE));
        0.5 * (without / with).ln() * log.samples as f64 / of_stage(log.stage) as f64
    };
    logs.iter().map(of_log).sum()
}

/// Standard error of the gain over the blocks of the logs, each left out once (jackknife). It holds for a gain that
/// hangs on a few blocks, too.
fn standard_error(cells: &[Cell]) -> f64 {
    let blocks: BTreeSet<(usize, usize)> = cells.iter().map(|cell| (cell.log, cell.block)).collect();
    let n = blocks.len().max(2) as f64;
    let gains: Vec<f64> = blocks.into_iter().map(|block| gain(cells, Some(block))).collect();
    let mean = gains.iter().sum::<f64>() / n;
    let squares: f64 = gains.iter().map(|gain| (gain - mean).powi(2)).sum();
    (squares * (n - 1.0) / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two stages of two logs, 24 blocks each, with Σr² per block of 100 without the effect and what `with` says with it.
    fn made(with: impl Fn(Stage, usize, usize) -> f64) -> Vec<Cell> {
        let mut cells = Vec::new();
        for stage in [Stage::Table, Stage::Force] {
            for (log, block) in (0..2).flat_map(|log| (0..BLOCKS).map(move |block| (log, block))) {
                let squares = [100.0, with(stage, log, block)];
                cells.push(Cell { stage, log, block, squares, samples: 100 });
            }
        }
        cells
    }

    fn refuted(cells: &[Cell]) -> bool {
        is_refuted(gain(cells, None), standard_error(cells))
    }

    /// A deviation of ±1 that differs from block to block and sums to zero over a log.
    fn sign(block: usize) -> f64 {
        if block.is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    #[test]
    fn the_gain_is_that_of_the_log_likelihood_and_its_error_that_of_the_mean_of_blocks() {
        // 4 % more of Σr² in the table: −½·ln 1.04 in one of two stages.
        let cells =
            made(|stage, _, block| if stage == Stage::Table { 104.0 + 10.0 * sign(block) } else { 100.0 });
        assert!((gain(&cells, None) + 0.5 * 1.04f64.ln()).abs() < 1e-12);
        // d(½ ln Σ) = ½·d/Σ: each block's ±10 of 104 makes ½·10/104 of its own, over √48 blocks; the mean's own error
        // has n − 1 in it: 48/47.
        let expected = 0.5 * 10.0 / 104.0 / 47f64.sqrt();
        assert!((standard_error(&cells) / expected - 1.0).abs() < 0.01, "{}", standard_error(&cells));
    }

    #[test]
    fn a_loss_is_held_against_chance_and_a_gross_one_is_not() {
        // 2 % more in both stages' rms, evenly: beyond chance. The same where every other block loses fifteen times as
        // much and the rest gain almost that: chance.
        assert!(refuted(&made(|_, _, _| 104.0)));
        assert!(!refuted(&made(|_, _, block| 104.0 + 60.0 * sign(block))));
        // Half a percent is what refitting shifts.
        assert!(!refuted(&made(|_, _, _| 100.4)));
        // All of the loss in one block: its error is as large as itself, but √2 times the residual is gross.
        assert!(refuted(&made(|_, _, block| if block == 3 { 2500.0 } else { 100.0 })));
        assert!(!refuted(&made(|_, _, _| 96.0)));
    }

    #[test]
    fn what_helps_one_stage_much_may_cost_another_a_trifle() {
        let cost = |table: f64| move |stage, _, _| if stage == Stage::Table { table } else { 110.0 };
        assert!(!refuted(&made(cost(25.0))), "half of the table's residual gone, 5 % more of the force's");
        assert!(refuted(&made(cost(99.0))), "half a percent of the table's for 5 % of the force's");
    }
}
