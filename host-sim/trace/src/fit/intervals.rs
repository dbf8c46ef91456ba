//! Confidence intervals of fitted parameters.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use numerics::distributions::student_t_975;

use super::least_squares::Fitted;
use super::normal_equations::normal;
use model::effects::{Coordinate, Effect};

/// Covariance of the free parameters of a fit, estimated from the blocks of the logs.
#[derive(Clone, Debug)]
pub struct Covariance {
    matrix: DMatrix<f64>,
    /// Number of blocks less one.
    degrees_of_freedom: usize,
}

/// Covariance of the free parameters of a fit, H⁻¹·(Σ g·gᵀ)·H⁻¹ over the blocks of the logs (sandwich estimator): valid
/// for errors that are correlated within a block.
#[must_use]
pub fn covariance(fitted: &Fitted) -> Covariance {
    let n = fitted.parameters.len();
    let (curvature, _) = normal(&fitted.blocks, &fitted.parameters);
    let mut regular =
        curvature.clone() + DMatrix::from_diagonal(&(curvature.diagonal() * 1e-9).add_scalar(1e-12));
    // A parameter at a bound is treated as known.
    for (i, parameter) in fitted.parameters.iter().enumerate() {
        let Coordinate { value, lower, upper, .. } = parameter.coordinate;
        let near = 1e-6 * (upper - lower);
        if value - lower < near || upper - value < near {
            regular[(i, i)] += 1e9 * (1.0 + curvature[(i, i)]);
        }
    }
    let inverse = regular.cholesky().map_or_else(|| DMatrix::zeros(n, n), |c| c.inverse());
    // The gradients of all stages over one block of one log are summed. Blocks without a sample that counts are skipped.
    let mut sums: Vec<((usize, usize), DVector<f64>)> = Vec::new();
    for block in fitted.blocks.iter().filter(|block| block.samples > 0) {
        let key = (block.log, block.number);
        match sums.iter_mut().find(|(k, _)| *k == key) {
            Some((_, sum)) => *sum += &block.gradient,
            None => sums.push((key, block.gradient.clone())),
        }
    }
    let outer_products = sums.iter().fold(DMatrix::zeros(n, n), |sum, (_, g)| sum + g * g.transpose());
    Covariance {
        matrix: &inverse * outer_products * &inverse,
        degrees_of_freedom: sums.len().saturating_sub(1),
    }
}

impl Covariance {
    /// Half width of the 95 % confidence interval of a free parameter, by Student's t.
    #[must_use]
    pub fn half_width(&self, index: usize) -> f64 {
        student_t_975(self.degrees_of_freedom) * self.matrix[(index, index)].max(0.0).sqrt()
    }
}

/// Half widths of the 95 % confidence intervals of an effect's parameters, by Student's t. `indices` are those of the
/// effect's coordinates in the covariance.
#[must_use]
pub fn half_widths(effect: &Effect, covariance: &Covariance, indices: Range<usize>) -> Vec<f64> {
    let of_effect = covariance.matrix.view((indices.start, indices.start), (indices.len(), indices.len()));
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
    let of_parameters = &jacobian * of_effect * jacobian.transpose();
    let t = student_t_975(covariance.degrees_of_freedom);
    of_parameters.diagonal().iter().map(|variance| t * variance.max(0.0).sqrt()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::axis_model::{AxisModel, FreeParameter};
    use crate::fit::normal_equations::{BLOCKS, Block};
    use crate::options::ModelOptions;
    use model::effects::{ServoMismatch, Stage};
    use model::machine::Axis;
    use shared::config::Rates;

    /// A fit of one parameter to `logs` logs: each block has curvature 1 and a gradient of ±1; the first block of each log
    /// has no counting sample.
    fn fitted(logs: usize) -> Fitted {
        let rates = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
        let block = |(log, number): (usize, usize)| Block {
            stage: Stage::Motor,
            log,
            number,
            weight: 1.0,
            samples: if number == 0 { 0 } else { 100 },
            squares: 1.0,
            gradient: DVector::from_element(1, if number == 0 { 0.0 } else { 1.0 }),
            curvature: DMatrix::from_element(1, 1, if number == 0 { 0.0 } else { 1.0 }),
        };
        let blocks = (0..logs).flat_map(|log| (0..BLOCKS).map(move |number| (log, number))).map(block);
        let coordinate = Coordinate::between(0.0, 0.1, -100.0, 100.0);
        Fitted {
            model: AxisModel::new(&Axis::default(), rates, ModelOptions::default()),
            parameters: vec![FreeParameter { coordinate, prior: None }],
            blocks: blocks.collect(),
            weights: Vec::new(),
            residuals: Vec::new(),
            columns: Vec::new(),
        }
    }

    /// Variance Σg²/H² = 1/n of n blocks; t(22) = 2.074 for one log, t(68) = 1.995 for three.
    #[test]
    fn the_degrees_of_freedom_follow_from_the_blocks_with_samples() {
        let effect = Effect::ServoMismatch(ServoMismatch { percent: 10.0 });
        for (logs, blocks, t) in [(1, 23.0, 2.074), (3, 69.0, 1.995)] {
            let half = half_widths(&effect, &covariance(&fitted(logs)), 0..1)[0];
            assert!((half * f64::sqrt(blocks) / t - 1.0).abs() < 5e-4, "{logs}: {half}");
        }
    }
}
