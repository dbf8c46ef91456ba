//! Normal equations over whole logs.

use nalgebra::{DMatrix, DVector};

use super::WholeLogs;
use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::fitted_scope::FittedScope;
use crate::fit::least_squares::derivatives;
use crate::fit::model_bias;
use crate::fit::normal_equations::{Block, blocks};
use crate::judge::axis_findings::AxisFindings;
use model::effects::Stage;

/// Weighted Σr², `Jᵀr` and `JᵀJ` of the scope of an axis over the fitted parts.
#[derive(Clone, Debug)]
pub struct NormalSums {
    /// Weighted Σr².
    pub squares: f64,
    /// `Jᵀr`.
    pub gradient: DVector<f64>,
    /// `JᵀJ`.
    pub curvature: DMatrix<f64>,
}

impl NormalSums {
    fn of(blocks: &[Block], parameters: usize) -> Self {
        let mut sums = Self {
            squares: 0.0,
            gradient: DVector::zeros(parameters),
            curvature: DMatrix::zeros(parameters, parameters),
        };
        for block in blocks {
            sums.squares += block.squares;
            sums.gradient += &block.gradient;
            sums.curvature += &block.curvature;
        }
        sums
    }

    fn add(&mut self, other: &Self) {
        self.squares += other.squares;
        self.gradient += &other.gradient;
        self.curvature += &other.curvature;
    }
}

/// The normal equations of the scope of each axis with this number, at the models of the axes; `None` for an axis with fewer
/// scopes, or one whose model is not to be fitted.
#[must_use]
pub fn normal_sums(whole: &WholeLogs<'_>, axes: &[AxisFindings], number: usize) -> Vec<Option<NormalSums>> {
    let of_pieces = whole.map(0, |piece, signals| {
        let logs = [signals];
        let of_axis = |(index, axis)| of_piece(&whole.data(&logs, index), axis, number, piece.part);
        axes.iter().enumerate().map(of_axis).collect::<Vec<_>>()
    });
    let mut of_pieces = of_pieces.into_iter();
    let mut sums = of_pieces.next().unwrap_or_default();
    for piece in of_pieces {
        for (sum, of_axis) in sums.iter_mut().zip(&piece) {
            if let (Some(sum), Some(of_axis)) = (sum, of_axis) {
                sum.add(of_axis);
            }
        }
    }
    sums
}

fn of_piece(data: &FitData<'_>, axis: &AxisFindings, number: usize, part: usize) -> Option<NormalSums> {
    let FittedScope { scope, exclusions, .. } = axis.fitted_scopes.get(number)?;
    let weights = axis.fitted_scopes[number].weights_of_log(part);
    let parameters = axis.model.free_parameters(scope).len();
    if !may_be_refined(axis) || parameters == 0 || weights.is_empty() {
        return None;
    }
    let bias = bias(data, axis, &scope.stages);
    let data = FitData { bias: &bias, exclusions, ..*data };
    let residuals = data.residuals(&axis.model, scope);
    let all: Vec<usize> = (0..parameters).collect();
    let columns = derivatives(&data, &axis.model, scope, &all, &residuals);
    Some(NormalSums::of(&blocks(&data, &columns, &residuals, weights), parameters))
}

/// Whether a fit to whole logs may change the model: not if the machine file is that of another machine, or if an earlier trace wrote it
/// and nothing new was found.
fn may_be_refined(axis: &AxisFindings) -> bool {
    let has_nothing_new = axis.model.found().is_empty() && axis.model.was_fitted();
    !(axis.is_of_another_machine || has_nothing_new)
}

/// The error of the tracer's own simulation in some stages of a piece, if it is subtracted.
#[must_use]
pub fn bias(data: &FitData<'_>, axis: &AxisFindings, stages: &[Stage]) -> Vec<ResidualSeries> {
    if !axis.subtracts_bias {
        return Vec::new();
    }
    let of_stages =
        axis.scopes.iter().filter(|scope| scope.stages.iter().any(|stage| stages.contains(stage)));
    of_stages.flat_map(|scope| model_bias::of(data, &axis.model, scope)).collect()
}
