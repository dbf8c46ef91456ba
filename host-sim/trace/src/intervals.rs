//! How certain fitted parameters are.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::fit::{Fitted, normal};
use model::effects::{Coordinate, Effect};

/// 97.5 % point of Student's t at 71 degrees of freedom: blocks of three logs.
const T_975: f64 = 1.99;

/// Covariance of a fit's slots: H⁻¹·(Σ g gᵀ)·H⁻¹ over the blocks of the logs, which holds for errors
/// that are correlated within a block.
#[must_use]
pub fn covariance(fitted: &Fitted) -> DMatrix<f64> {
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

/// Half widths of the 95 % intervals of an effect's parameters, whose coordinates stand in `slots` of the covariance.
#[must_use]
pub fn half_widths(effect: &Effect, covariance: &DMatrix<f64>, slots: Range<usize>) -> Vec<f64> {
    let own = covariance.view((slots.start, slots.start), (slots.len(), slots.len()));
    let coordinates = effect.coordinates();
    let values: Vec<f64> = coordinates.iter().map(|c| c.value).collect();
    let parameters = effect.values();
    let mut jacobian = DMatrix::zeros(parameters.len(), values.len());
    for (j, coordinate) in coordinates.iter().enumerate() {
        let mut moved = values.clone();
        let step = 1e-3 * coordinate.step;
        moved[j] += step;
        for (i, value) in effect.at(&moved).values().into_iter().enumerate() {
            let mut change = value - parameters[i];
            if let Some(period) = effect.declared_parameters()[i].period {
                change = (change + 0.5 * period).rem_euclid(period) - 0.5 * period;
            }
            jacobian[(i, j)] = change / step;
        }
    }
    let spread = &jacobian * own * jacobian.transpose();
    spread.diagonal().iter().map(|variance| T_975 * variance.max(0.0).sqrt()).collect()
}
