//! Least squares over the stages of a scope, within bounds (Levenberg and Marquardt).
//!
//! Each stage of each log is weighted by its own residual, so that the product of their errors is minimized, independently
//! of units and of the roughness of the motion. The normal equations are kept by block of the log: a fit without some
//! blocks then costs a small linear solve, not another fit ([`crate::search::held_out`]).

use std::sync::Arc;

use nalgebra::DVector;
use rayon::prelude::*;

use super::axis_model::{AxisModel, FreeParameter};
use super::fit_data::{FitData, ResidualSeries};
use super::normal_equations::{
    Block, Column, DerivativeSeries, Known, blocks, normal, renewed_blocks, stepped,
};
use super::scope::Scope;
use model::effects::Stage;

/// A fit ends when a step lowers the cost by less than this fraction.
const MIN_GAIN: f64 = 1e-4;

/// Largest number of steps of a fit to the optimum.
pub const STEPS: usize = 10;

/// Derivatives are reused as long as a step gains more than this fraction of the gain predicted by the normal equations.
const MIN_GAIN_OF_PREDICTED: f64 = 0.7;

/// Number of dampings that are tried in a step, each ten times the previous one, until the cost decreases.
const DAMPINGS: usize = 5;

/// A fitted model with the normal equations at its optimum.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The model at the optimum.
    pub model: AxisModel,
    /// Free parameters at the optimum.
    pub parameters: Vec<FreeParameter>,
    /// Normal equations at the optimum.
    pub blocks: Vec<Block>,
    /// Weight of each series of the residuals.
    pub weights: Vec<f64>,
    /// Residuals at the optimum.
    pub residuals: Vec<ResidualSeries>,
    /// Derivatives of the residuals, one column per parameter.
    pub columns: Vec<Column>,
}

impl Fitted {
    /// Frees the memory of everything that grows with the logs or with their blocks.
    pub fn forget_data(&mut self) {
        self.blocks = Vec::new();
        self.residuals = Vec::new();
        self.columns = Vec::new();
    }

    /// Weighted Σr² of a stage.
    #[must_use]
    pub fn squares(&self, stage: Stage) -> f64 {
        self.blocks.iter().filter(|block| block.stage == stage).map(|block| block.squares).sum()
    }

    /// Adds Jᵀ·W·e of an error e of one series of the residuals, by its index, to a gradient.
    pub fn add_gradient(
        &self,
        gradient: &mut DVector<f64>,
        series: usize,
        error: &(impl Iterator<Item = f64> + Clone),
    ) {
        let weight = self.weights[series].powi(2);
        for (sum, column) in gradient.iter_mut().zip(&self.columns) {
            let slopes = column[series].values.iter().map(|&slope| f64::from(slope));
            let products = slopes.zip(error.clone()).map(|(slope, error)| slope * error);
            *sum += weight * products.sum::<f64>();
        }
    }

    /// The derivatives that remain valid without a found effect of a model, by its index in [`AxisModel::found`]. None if
    /// the effect replaced a trim of timing, as the fit then has no derivative with respect to the trim.
    #[must_use]
    pub fn columns_without(&self, model: &AxisModel, scope: &Scope, index: usize) -> Vec<Column> {
        let effect = &model.found()[index];
        if !scope.holds(effect) {
            return self.columns.clone();
        }
        if effect.timing().is_some() {
            return Vec::new();
        }
        let indices = model.indices_of(scope, index);
        let others = self.columns.iter().enumerate().filter(|(parameter, _)| !indices.contains(parameter));
        others.map(|(_, column)| column.clone()).collect()
    }
}

/// The fit without a found effect, from the point and with the derivatives of the fit with it.
#[must_use]
pub fn fit_without(data: &FitData<'_>, full: &Fitted, scope: &Scope, index: usize) -> Fitted {
    let known = full.columns_without(&full.model, scope, index);
    fit_from(data, &full.model.without(index), scope, STEPS, &known)
}

/// Fits the free parameters of a scope, from their values in the model, in at most `steps` steps.
#[must_use]
pub fn fit(data: &FitData<'_>, start: &AxisModel, scope: &Scope, steps: usize) -> Fitted {
    fit_from(data, start, scope, steps, &[])
}

/// Fits like [`fit`], with known derivatives with respect to the first parameters, from a point nearby.
///
/// Each derivative requires a simulation. The derivatives with respect to the declared values hardly change during a fit and
/// are computed again only after a step that gains less than predicted. The derivatives with respect to the last effect,
/// whose parameters are less well known, are computed in each step. Those with respect to the parameters of a linear effect, such as a
/// map, are computed once.
#[must_use]
pub fn fit_from(
    data: &FitData<'_>,
    start: &AxisModel,
    scope: &Scope,
    steps: usize,
    known: &[Column],
) -> Fitted {
    let mut point = Point::new(data, start, scope, known);
    let count = point.columns.len();
    let last = if known.is_empty() { start.indices_of_last(scope) } else { known.len()..count };
    let all = point.nonlinear.clone();
    let of_last: Vec<usize> = all.iter().copied().filter(|parameter| last.contains(parameter)).collect();
    for _ in 0..steps {
        let Gain { gained, predicted } = point.step(data, scope);
        point.weights = weights(data, &point.model, &point.residuals);
        let is_done = gained < MIN_GAIN;
        if is_done && !(point.has_old_columns && gained == 0.0) {
            if gained > 0.0 {
                point.renew(data, scope, &[]);
            }
            break;
        }
        point.renew(data, scope, if gained > MIN_GAIN_OF_PREDICTED * predicted { &of_last } else { &all });
    }
    let Point { model, residuals, weights, columns, blocks, .. } = point;
    Fitted { parameters: model.free_parameters(scope), model, blocks, weights, residuals, columns }
}

/// Whether the predictions are linear in a free parameter, by its index.
fn is_linear(model: &AxisModel, scope: &Scope, parameter: usize) -> bool {
    model.found().iter().enumerate().any(|(index, effect)| {
        effect.kind().is_linear && scope.holds(effect) && model.indices_of(scope, index).contains(&parameter)
    })
}

/// A point of a fit.
struct Point {
    model: AxisModel,
    residuals: Vec<ResidualSeries>,
    weights: Vec<f64>,
    damping: f64,
    columns: Vec<Column>,
    /// Indices of the parameters whose columns change from point to point: all but those in which the predictions are linear.
    nonlinear: Vec<usize>,
    /// Whether some of these columns were computed at another point.
    has_old_columns: bool,
    blocks: Vec<Block>,
}

/// Relative decrease of the cost in a step, and the decrease predicted by the normal equations.
struct Gain {
    gained: f64,
    predicted: f64,
}

impl Point {
    fn new(data: &FitData<'_>, start: &AxisModel, scope: &Scope, known: &[Column]) -> Self {
        let model = start.clone();
        let residuals = data.residuals(&model, scope);
        let weights = weights(data, &model, &residuals);
        let count = model.free_parameters(scope).len();
        let mut columns = known.to_vec();
        let new: Vec<usize> = (known.len()..count).collect();
        columns.extend(derivatives(data, &model, scope, &new, &residuals));
        let blocks = blocks(data, &columns, &residuals, &weights);
        let nonlinear: Vec<usize> =
            (0..count).filter(|&parameter| !is_linear(&model, scope, parameter)).collect();
        let has_old_columns = nonlinear.iter().any(|&parameter| parameter < known.len());
        Self { model, residuals, weights, damping: 1e-3, columns, nonlinear, has_old_columns, blocks }
    }

    /// Moves to a point of lower cost, if one of the dampings leads to one.
    fn step(&mut self, data: &FitData<'_>, scope: &Scope) -> Gain {
        let parameters = self.model.free_parameters(scope);
        let cost = cost(&self.residuals, &self.weights, &parameters);
        let (curvature, gradient) = normal(&self.blocks, &parameters);
        for _ in 0..DAMPINGS {
            let moved = stepped(&parameters, &curvature, &gradient, self.damping);
            let candidate = self.model.at(scope, &moved);
            let residuals = data.residuals(&candidate, scope);
            let candidate_cost = self::cost(&residuals, &self.weights, &candidate.free_parameters(scope));
            if candidate_cost < cost {
                let step = DVector::from_iterator(
                    parameters.len(),
                    parameters
                        .iter()
                        .zip(&moved)
                        .map(|(parameter, moved)| moved - parameter.coordinate.value),
                );
                let predicted = (-2.0 * gradient.dot(&step) - step.dot(&(&curvature * &step))) / cost;
                (self.model, self.residuals) = (candidate, residuals);
                self.damping = (0.1 * self.damping).max(1e-9);
                return Gain { gained: 1.0 - candidate_cost / cost, predicted };
            }
            if self.has_old_columns {
                break;
            }
            self.damping *= 10.0;
        }
        Gain { gained: 0.0, predicted: f64::INFINITY }
    }

    /// Computes the derivatives with respect to some of the parameters, and the normal equations.
    fn renew(&mut self, data: &FitData<'_>, scope: &Scope, parameters: &[usize]) {
        self.has_old_columns = !self.nonlinear.iter().all(|parameter| parameters.contains(parameter));
        let new = derivatives(data, &self.model, scope, parameters, &self.residuals);
        for (&index, column) in parameters.iter().zip(new) {
            self.columns[index] = column;
        }
        let known = Known { blocks: &self.blocks, renewed: parameters };
        self.blocks = renewed_blocks(data, &self.columns, known, &self.residuals, &self.weights);
    }
}

/// Weight of each series: 1/max(rms, noise) of its stage over its log.
#[must_use]
pub fn weights(data: &FitData<'_>, model: &AxisModel, residuals: &[ResidualSeries]) -> Vec<f64> {
    let weight = |series: &ResidualSeries| {
        let error = data.rms(std::slice::from_ref(series), series.stage);
        error.max(data.noise_of_log(model, series.stage, series.log)).max(1e-12).recip()
    };
    residuals.iter().map(weight).collect()
}

/// Weighted Σr² plus the priors' ((value − mean)/standard deviation)².
fn cost(residuals: &[ResidualSeries], weights: &[f64], parameters: &[FreeParameter]) -> f64 {
    let squares = |series: &ResidualSeries| series.values.iter().map(|r| r * r).sum::<f64>();
    let of_data: f64 =
        residuals.iter().zip(weights).map(|(series, weight)| weight * weight * squares(series)).sum();
    let of_prior = |parameter: &FreeParameter| {
        parameter
            .prior
            .map_or(0.0, |(centre, spread)| ((parameter.coordinate.value - centre) / spread).powi(2))
    };
    of_data + parameters.iter().map(of_prior).sum::<f64>()
}

/// Derivatives of all residuals with respect to some of a model's free parameters, by their indices, by one-sided differences,
/// in parallel.
#[must_use]
pub fn derivatives(
    data: &FitData<'_>,
    model: &AxisModel,
    scope: &Scope,
    indices: &[usize],
    residuals: &[ResidualSeries],
) -> Vec<Column> {
    let parameters = model.free_parameters(scope);
    let values: Vec<f64> = parameters.iter().map(|parameter| parameter.coordinate.value).collect();
    indices
        .par_iter()
        .map(|&j| {
            let coordinate = &parameters[j].coordinate;
            let is_inside = coordinate.value + coordinate.step <= coordinate.upper;
            let step = if is_inside { coordinate.step } else { -coordinate.step };
            let mut moved = values.clone();
            moved[j] += step;
            let moved = data.residuals(&model.at(scope, &moved), scope);
            let series = residuals.iter().zip(&moved);
            Arc::new(series.map(|(base, moved)| DerivativeSeries::of(base, moved, step)).collect())
        })
        .collect()
}
