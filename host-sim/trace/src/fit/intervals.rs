//! Confidence intervals of fitted parameters.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::least_squares::Fitted;
use super::normal_equations::normal;
use model::effects::{Coordinate, Effect};

/// 97.5 % quantile of Student's t at 71 degrees of freedom: blocks of three logs.
const T_975: f64 = 1.99;

/// Covariance of the free parameters of a fit, H⁻¹·(Σ g·gᵀ)·H⁻¹ over the blocks of the logs (sandwich estimator): valid
/// for errors that are correlated within a block.
#[must_use]
pub fn covariance(fitted: &Fitted) -> DMatrix<f64> {
    let n = fitted.parameters.len();
    let (curvature, _) = normal(&fitted.blocks, &fitted.parameters);
    let mut regular =
        curvature.clone() + DMatrix::from_diagonal(&(curvature.diagonal() * 1e-9).add_scalar(1e-12));
    // A parameter at its bound counts as known.
    for (i, parameter) in fitted.parameters.iter().enumerate() {
        let Coordinate { value, lower, upper, .. } = parameter.coordinate;
        let near = 1e-6 * (upper - lower);
        if value - lower < near || upper - value < near {
            regular[(i, i)] += 1e9 * (1.0 + curvature[(i, i)]);
        }
    }
    let inverse = regular.cholesky().map_or_else(|| DMatrix::zeros(n, n), |c| c.inverse());
    // The gradients of all stages over one block of one log are summed.
    let mut sums: Vec<((usize, usize), DVector<f64>)> = Vec::new();
    for block in &fitted.blocks {
        let key = (block.log, block.number);
        match sums.iter_mut().find(|(k, _)| *k == key) {
            Some((_, sum)) => *sum += &block.gradient,
            None => sums.push((key, block.gradient.clone())),
        }
    }
    let outer_products = sums.iter().fold(DMatrix::zeros(n, n), |sum, (_, g)| sum + g * g.transpose());
    &inverse * outer_products * &inverse
}

/// Half widths of the 95 % intervals of an effect's parameters, whose coordinates have these indices in the covariance.
#[must_use]
pub fn half_widths(effect: &Effect, covariance: &DMatrix<f64>, indices: Range<usize>) -> Vec<f64> {
    let of_effect = covariance.view((indices.start, indices.start), (indices.len(), indices.len()));
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
    let of_parameters = &jacobian * of_effect * jacobian.transpose();
    of_parameters.diagonal().iter().map(|variance| T_975 * variance.max(0.0).sqrt()).collect()
}
