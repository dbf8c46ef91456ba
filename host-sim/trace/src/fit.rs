//! Least squares over the stages of a scope, within bounds (Levenberg and Marquardt).
//!
//! Each stage of each log is weighted by its own residual, so that the product of their errors becomes
//! small, whatever their units and however rough the motion. The normal equations are kept by block of the log: leaving blocks out
//! then costs a small linear solve, not another fit ([`super::held_out`]).

use std::ops::Range;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::axis_model::{AxisModel, Slot};
use super::residual::{Evidence, Part, rms};
use super::scope::Scope;
use model::effects::Stage;

/// Blocks that each log is cut into.
pub const BLOCKS: usize = 24;

/// A fit ends when a step lowers the error by less than this share.
const ENOUGH: f64 = 1e-4;

/// Steps of a fit that is to end at its optimum.
pub const STEPS: usize = 10;

/// Derivatives are kept while steps bring this share of what they promised.
const KEPT_WHILE: f64 = 0.7;

/// Normal equations of one block of one stage: Σr², `Jᵀr` and `JᵀJ`, weighted.
#[derive(Clone, Debug)]
pub struct Block {
    /// Stage.
    pub stage: Stage,
    /// Number of the log.
    pub log: usize,
    /// Number within the log, 0 to [`BLOCKS`] − 1.
    pub part: usize,
    /// Weight of its residuals.
    pub weight: f64,
    /// Samples that count.
    pub samples: usize,
    /// Σ r².
    pub squares: f64,
    /// `Jᵀr`.
    pub gradient: DVector<f64>,
    /// `JᵀJ`.
    pub curvature: DMatrix<f64>,
}

/// A fitted model with what is around its optimum.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// At its optimum.
    pub model: AxisModel,
    /// Its slots there.
    pub slots: Vec<Slot>,
    /// The normal equations there.
    pub blocks: Vec<Block>,
    /// Weight of each part of the residuals.
    pub weights: Vec<f64>,
    /// The residuals there.
    pub parts: Vec<Part>,
    /// Their derivatives, one column a slot.
    pub columns: Vec<Column>,
}

/// Derivatives of all residuals for one slot. Fits beside each other share it.
pub type Column = Arc<Vec<Part>>;

impl Fitted {
    /// Weighted Σr² of a stage.
    #[must_use]
    pub fn squares(&self, stage: Stage) -> f64 {
        self.blocks.iter().filter(|block| block.stage == stage).map(|block| block.squares).sum()
    }

    /// Samples that count in a stage.
    #[must_use]
    pub fn samples(&self, stage: Stage) -> usize {
        self.blocks.iter().filter(|block| block.stage == stage).map(|block| block.samples).sum()
    }
}

/// Weight of each part: 1/max(rms, noise) of its stage over its log.
#[must_use]
pub fn weights(evidence: &Evidence<'_>, model: &AxisModel, parts: &[Part]) -> Vec<f64> {
    let weight = |part: &Part| {
        let error = rms(std::slice::from_ref(part), part.stage, evidence);
        error.max(evidence.noise_of_log(model, part.stage, part.log)).max(1e-12).recip()
    };
    parts.iter().map(weight).collect()
}

/// Fits a scope's slots, from where the model stands.
#[must_use]
pub fn fit(evidence: &Evidence<'_>, start: &AxisModel, scope: &Scope, steps: usize) -> Fitted {
    fit_from(evidence, start, scope, steps, &[])
}

/// Fits a scope's slots where the derivatives for the first of them are known from nearby.
///
/// A derivative costs a simulation. Those of the declared values hardly change on the way, so they are taken anew only
/// where a step does not bring what they promised; those of the last effect, whose parameters are yet to be found, in
/// each step.
#[must_use]
pub fn fit_from(
    evidence: &Evidence<'_>,
    start: &AxisModel,
    scope: &Scope,
    steps: usize,
    known: &[Column],
) -> Fitted {
    let mut model = start.clone();
    let mut parts = evidence.residuals(&model, scope);
    let mut weights = weights(evidence, &model, &parts);
    let mut damping = 1e-3;
    let count = model.slots(scope).len();
    let mut columns = known.to_vec();
    columns.extend(derivatives(evidence, &model, scope, known.len()..count, &parts));
    let moving = if known.is_empty() { model.last_slots(scope) } else { known.len()..count };
    let mut blocks = blocks(evidence, &columns, &parts, &weights);
    let mut kept = !known.is_empty();
    for _ in 0..steps {
        let slots = model.slots(scope);
        let cost = cost(&parts, &weights, &slots);
        let (curvature, gradient) = normal(&blocks, &slots);
        let (mut gained, mut promised) = (0.0, f64::INFINITY);
        // A handful of dampings: then the optimum is as near as differences can tell.
        for _ in 0..5 {
            let moved = stepped(&slots, &curvature, &gradient, damping);
            let candidate = model.at(scope, &moved);
            let candidate_parts = evidence.residuals(&candidate, scope);
            let candidate_cost = self::cost(&candidate_parts, &weights, &candidate.slots(scope));
            if candidate_cost < cost {
                let step = DVector::from_iterator(
                    slots.len(),
                    slots.iter().zip(&moved).map(|(slot, moved)| moved - slot.coordinate.value),
                );
                promised = -2.0 * gradient.dot(&step) - step.dot(&(&curvature * &step));
                promised /= cost;
                gained = 1.0 - candidate_cost / cost;
                (model, parts) = (candidate, candidate_parts);
                damping = (0.1 * damping).max(1e-9);
                break;
            }
            if kept {
                break;
            }
            damping *= 10.0;
        }
        weights = self::weights(evidence, &model, &parts);
        let done = gained < ENOUGH;
        if done && !(kept && gained == 0.0) {
            if gained > 0.0 {
                blocks = self::blocks(evidence, &columns, &parts, &weights);
            }
            break;
        }
        let fresh = if gained > KEPT_WHILE * promised { moving.clone() } else { 0..count };
        kept = fresh.len() < count;
        let new = derivatives(evidence, &model, scope, fresh.clone(), &parts);
        columns.splice(fresh, new);
        blocks = self::blocks(evidence, &columns, &parts, &weights);
    }
    Fitted { slots: model.slots(scope), model, blocks, weights, parts, columns }
}

/// Weighted Σr² with the pull of what is known beforehand.
fn cost(parts: &[Part], weights: &[f64], slots: &[Slot]) -> f64 {
    let squares = |part: &Part| part.values.iter().map(|r| r * r).sum::<f64>();
    let data: f64 = parts.iter().zip(weights).map(|(part, weight)| weight * weight * squares(part)).sum();
    let pull = |slot: &Slot| {
        slot.prior.map_or(0.0, |(centre, spread)| ((slot.coordinate.value - centre) / spread).powi(2))
    };
    data + slots.iter().map(pull).sum::<f64>()
}

/// Derivatives of all residuals for a range of a model's slots, by one-sided differences, in parallel.
#[must_use]
pub fn derivatives(
    evidence: &Evidence<'_>,
    model: &AxisModel,
    scope: &Scope,
    range: Range<usize>,
    parts: &[Part],
) -> Vec<Column> {
    let slots = model.slots(scope);
    let values: Vec<f64> = slots.iter().map(|slot| slot.coordinate.value).collect();
    range
        .into_par_iter()
        .map(|j| {
            let coordinate = &slots[j].coordinate;
            let inside = coordinate.value + coordinate.step <= coordinate.upper;
            let step = if inside { coordinate.step } else { -coordinate.step };
            let mut moved = values.clone();
            moved[j] += step;
            let mut column = evidence.residuals(&model.at(scope, &moved), scope);
            for (part, base) in column.iter_mut().zip(parts) {
                for (value, base) in part.values.iter_mut().zip(&base.values) {
                    *value = (*value - base) / step;
                }
            }
            Arc::new(column)
        })
        .collect()
}

/// Normal equations by block from residuals and their derivatives.
#[must_use]
pub fn blocks(evidence: &Evidence<'_>, columns: &[Column], parts: &[Part], weights: &[f64]) -> Vec<Block> {
    let n = columns.len();
    let of_part = |(p, part): (usize, &Part)| {
        let weight = weights[p] * weights[p];
        let length = part.values.len().div_ceil(BLOCKS).max(1);
        let counts = evidence.counting(part.stage, part.log);
        let mut blocks = Vec::with_capacity(BLOCKS);
        for (number, start) in (0..part.values.len()).step_by(length).enumerate() {
            let range = start..(start + length).min(part.values.len());
            let residual = &part.values[range.clone()];
            let slices: Vec<&[f64]> = columns.iter().map(|column| &column[p].values[range.clone()]).collect();
            let mut gradient = DVector::zeros(n);
            let mut curvature = DMatrix::zeros(n, n);
            for i in 0..n {
                gradient[i] = weight * dot(slices[i], residual);
                for j in 0..=i {
                    let product = weight * dot(slices[i], slices[j]);
                    curvature[(i, j)] = product;
                    curvature[(j, i)] = product;
                }
            }
            blocks.push(Block {
                stage: part.stage,
                log: part.log,
                part: number,
                weight: weights[p],
                samples: range.filter(|&i| counts(i)).count(),
                squares: weight * dot(residual, residual),
                gradient,
                curvature,
            });
        }
        blocks
    };
    parts.par_iter().enumerate().flat_map_iter(of_part).collect()
}

/// Scalar product, in four sums beside each other: one alone waits for itself.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (fours_a, rest_a) = a.as_chunks::<4>();
    let (fours_b, rest_b) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in fours_a.iter().zip(fours_b) {
        for lane in 0..4 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f64>() + rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum::<f64>()
}

/// The sum of blocks, with the pull of what is known beforehand.
#[must_use]
pub fn normal<'a>(
    blocks: impl IntoIterator<Item = &'a Block>,
    slots: &[Slot],
) -> (DMatrix<f64>, DVector<f64>) {
    let n = slots.len();
    let mut curvature = DMatrix::zeros(n, n);
    let mut gradient = DVector::zeros(n);
    for block in blocks {
        curvature += &block.curvature;
        gradient += &block.gradient;
    }
    for (i, slot) in slots.iter().enumerate() {
        if let Some((centre, spread)) = slot.prior {
            curvature[(i, i)] += spread.powi(-2);
            gradient[i] += (slot.coordinate.value - centre) / (spread * spread);
        }
    }
    (curvature, gradient)
}

/// The slots' values after a damped Gauss–Newton step, kept within bounds: what hits a bound is held
/// there and the rest solved again.
#[must_use]
pub fn stepped(slots: &[Slot], curvature: &DMatrix<f64>, gradient: &DVector<f64>, damping: f64) -> Vec<f64> {
    let n = slots.len();
    let mut fixed: Vec<Option<f64>> = vec![None; n];
    loop {
        let free: Vec<usize> = (0..n).filter(|&i| fixed[i].is_none()).collect();
        let mut matrix = curvature.select_rows(&free).select_columns(&free);
        let mut right = -gradient.select_rows(&free);
        for (row, &i) in free.iter().enumerate() {
            // The small constant lets a coordinate without any influence stay where it is.
            matrix[(row, row)] += damping * curvature[(i, i)] + 1e-12 + 1e-12 * curvature[(i, i)];
            for (j, step) in fixed.iter().enumerate() {
                right[row] -= step.map_or(0.0, |step| curvature[(i, j)] * step);
            }
        }
        let steps = matrix.cholesky().map_or_else(|| DVector::zeros(free.len()), |c| c.solve(&right));
        // Of the slots that would leave their bounds the one that gets there first is held; the others
        // may turn round when it is.
        let mut first: Option<(f64, usize, f64)> = None;
        for (&i, &step) in free.iter().zip(&steps) {
            let coordinate = &slots[i].coordinate;
            let inside =
                (coordinate.value + step).clamp(coordinate.lower, coordinate.upper) - coordinate.value;
            let share = inside / step;
            // The sum of value and step may miss the bound by a rounding.
            if share < 1.0 - 1e-9 && first.is_none_or(|(least, ..)| share < least) {
                first = Some((share, i, inside));
            }
        }
        if let Some((_, i, inside)) = first {
            fixed[i] = Some(inside);
        } else {
            let mut values: Vec<f64> = slots.iter().map(|slot| slot.coordinate.value).collect();
            for (i, step) in fixed.iter().enumerate() {
                values[i] += step.unwrap_or(0.0);
            }
            for (&i, step) in free.iter().zip(&steps) {
                values[i] += step;
            }
            return values;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::Coordinate;

    fn slot(value: f64, lower: f64, upper: f64) -> Slot {
        Slot { coordinate: Coordinate::between(value, 0.1, lower, upper), prior: None }
    }

    /// ½xᵀHx + gᵀx with H = [[2, −1.9], [−1.9, 2]]: free, its minimum is at H⁻¹·(−g).
    fn curvature() -> DMatrix<f64> {
        DMatrix::from_row_slice(2, 2, &[2.0, -1.9, -1.9, 2.0])
    }

    #[test]
    fn steps_to_the_minimum_where_it_may() {
        let gradient = DVector::from_vec(vec![-1.0, 0.0]);
        let slots = [slot(0.0, -100.0, 100.0), slot(0.0, -100.0, 100.0)];
        // Determinant 4 − 3.61 = 0.39: x = 2/0.39, y = 1.9/0.39.
        let moved = stepped(&slots, &curvature(), &gradient, 0.0);
        assert!((moved[0] - 2.0 / 0.39).abs() < 1e-6 && (moved[1] - 1.9 / 0.39).abs() < 1e-6, "{moved:?}");
    }

    #[test]
    fn holds_the_slot_that_meets_its_bound_first_and_lets_the_other_turn_round() {
        // Free, both would go down; with the first held at −1 the second minimises y² + 1.9·y + g·y.
        let gradient = DVector::from_vec(vec![1.0, -0.8]);
        let slots = [slot(0.0, -1.0, 100.0), slot(0.0, -100.0, 100.0)];
        let moved = stepped(&slots, &curvature(), &gradient, 0.0);
        // Free minimum: x = −(2 − 0.8·1.9)/0.39 < −1, y = −(1.9 − 1.6)/0.39; held: y = (0.8 − 1.9)/2.
        assert!((moved[0] + 1.0).abs() < 1e-9 && (moved[1] + 0.55).abs() < 1e-6, "{moved:?}");
    }
}
