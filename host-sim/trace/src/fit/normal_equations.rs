//! Normal equations of a fit, block by block, and the step that solves them within bounds.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::axis_model::FreeParameter;
use super::fit_data::{FitData, ResidualSeries};
pub use crate::options::BLOCKS;
use model::effects::Stage;

/// Number of folds of the cross-validation, each of consecutive blocks; a divisor of [`BLOCKS`].
pub const FOLDS: usize = 3;

/// Normal equations of one block of one stage: Σr², `Jᵀr` and `JᵀJ`, weighted.
#[derive(Clone, Debug)]
pub struct Block {
    /// Stage.
    pub stage: Stage,
    /// Index of the log.
    pub log: usize,
    /// Index within the log, 0 to [`BLOCKS`] − 1.
    pub number: usize,
    /// Index of the fold that the block belongs to.
    pub fold: usize,
    /// Weight of the residuals.
    pub weight: f64,
    /// Number of samples that count.
    pub samples: usize,
    /// Σ r².
    pub squares: f64,
    /// `Jᵀr`.
    pub gradient: DVector<f64>,
    /// `JᵀJ`.
    pub curvature: DMatrix<f64>,
}

/// Ranges of samples of the blocks of a log with this number of samples: [`BLOCKS`], or fewer of the shortest length.
#[must_use]
pub fn block_ranges(samples: usize, shortest: usize) -> Vec<Range<usize>> {
    let count = (samples / shortest.max(1)).clamp(1, BLOCKS);
    let length = samples.div_ceil(count).max(1);
    (0..samples).step_by(length).map(move |start| start..(start + length).min(samples)).collect()
}

/// Derivatives of one series of residuals with respect to one free parameter.
#[derive(Clone, Debug)]
pub struct DerivativeSeries {
    /// Stage.
    pub stage: Stage,
    /// Index of the log.
    pub log: usize,
    /// Derivative at each sample, µm or N per unit of the coordinate. Those of all candidates take most of the memory of a search. They are
    /// one-sided differences, whose error is far above the rounding to single precision.
    pub values: Vec<f32>,
}

impl DerivativeSeries {
    /// The differences of a moved prediction from the residuals at a point, over the step.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "rounded to single precision")]
    pub fn of(base: &ResidualSeries, moved: &ResidualSeries, step: f64) -> Self {
        let values =
            moved.values.iter().zip(&base.values).map(|(value, base)| ((value - base) / step) as f32);
        Self { stage: base.stage, log: base.log, values: values.collect() }
    }
}

/// Derivatives of all residuals with respect to one free parameter. Shared by fits that start from the same point.
pub type Column = Arc<Vec<DerivativeSeries>>;

/// Normal equations by block from residuals and their derivatives.
#[must_use]
pub fn blocks(
    data: &FitData<'_>,
    columns: &[Column],
    residuals: &[ResidualSeries],
    weights: &[f64],
) -> Vec<Block> {
    renewed_blocks(data, columns, Known { blocks: &[], renewed: &[] }, residuals, weights)
}

/// Normal equations of the same data with some of the columns.
#[derive(Clone, Copy, Debug)]
pub struct Known<'a> {
    /// The normal equations.
    pub blocks: &'a [Block],
    /// Indices of the columns that are not in them, or have changed.
    pub renewed: &'a [usize],
}

/// Normal equations as of [`blocks`]; the products of columns are taken from those that are known.
#[must_use]
pub fn renewed_blocks(
    data: &FitData<'_>,
    columns: &[Column],
    known: Known<'_>,
    residuals: &[ResidualSeries],
    weights: &[f64],
) -> Vec<Block> {
    let n = columns.len();
    let is_known = |i: usize| !known.renewed.contains(&i);
    let of_series = |(index, series): (usize, &ResidualSeries)| {
        let weight = weights[index] * weights[index];
        let counts = data.counting(series.stage, series.log);
        let mut blocks = Vec::with_capacity(BLOCKS);
        let ranges = block_ranges(series.values.len(), data.shortest_block(series.log));
        let count = ranges.len();
        for (number, range) in ranges.into_iter().enumerate() {
            let residual = &series.values[range.clone()];
            let slices: Vec<&[f32]> =
                columns.iter().map(|column| &column[index].values[range.clone()]).collect();
            let is_this =
                |block: &&Block| (block.stage, block.log, block.number) == (series.stage, series.log, number);
            let known_block = known.blocks.iter().find(is_this);
            let mut gradient = DVector::zeros(n);
            let mut curvature = DMatrix::zeros(n, n);
            for i in 0..n {
                gradient[i] = weight * dot(residual, slices[i]);
                for j in 0..=i {
                    let product = match known_block.filter(|_| is_known(i) && is_known(j)) {
                        Some(known) => (weights[index] / known.weight).powi(2) * known.curvature[(i, j)],
                        None => weight * dot(slices[i], slices[j]),
                    };
                    curvature[(i, j)] = product;
                    curvature[(j, i)] = product;
                }
            }
            blocks.push(Block {
                stage: series.stage,
                log: series.log,
                number,
                fold: number * FOLDS / count,
                weight: weights[index],
                samples: range.filter(|&i| counts(i)).count(),
                squares: weight * dot(residual, residual),
                gradient,
                curvature,
            });
        }
        blocks
    };
    residuals.par_iter().enumerate().flat_map_iter(of_series).collect()
}

/// Scalar product in four independent sums, which the processor computes in parallel.
fn dot<A: Copy + Into<f64>, B: Copy + Into<f64>>(a: &[A], b: &[B]) -> f64 {
    let (fours_a, end_a) = a.as_chunks::<4>();
    let (fours_b, end_b) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in fours_a.iter().zip(fours_b) {
        for lane in 0..4 {
            sums[lane] += a[lane].into() * b[lane].into();
        }
    }
    let end = end_a.iter().zip(end_b).map(|(&a, &b)| a.into() * b.into());
    sums.iter().sum::<f64>() + end.sum::<f64>()
}

/// Curvature and gradient summed over the blocks and the priors.
#[must_use]
pub fn normal<'a>(
    blocks: impl IntoIterator<Item = &'a Block>,
    parameters: &[FreeParameter],
) -> (DMatrix<f64>, DVector<f64>) {
    let n = parameters.len();
    let mut curvature = DMatrix::zeros(n, n);
    let mut gradient = DVector::zeros(n);
    for block in blocks {
        curvature += &block.curvature;
        gradient += &block.gradient;
    }
    for (i, parameter) in parameters.iter().enumerate() {
        if let Some((centre, spread)) = parameter.prior {
            curvature[(i, i)] += spread.powi(-2);
            gradient[i] += (parameter.coordinate.value - centre) / (spread * spread);
        }
    }
    (curvature, gradient)
}

/// The parameters' values after a damped Gauss–Newton step within their bounds: a parameter that reaches a bound is fixed
/// there, and the step of the others is solved again.
#[must_use]
pub fn stepped(
    parameters: &[FreeParameter],
    curvature: &DMatrix<f64>,
    gradient: &DVector<f64>,
    damping: f64,
) -> Vec<f64> {
    let n = parameters.len();
    let mut fixed: Vec<Option<f64>> = vec![None; n];
    loop {
        let free: Vec<usize> = (0..n).filter(|&i| fixed[i].is_none()).collect();
        let mut matrix = curvature.select_rows(&free).select_columns(&free);
        let mut right = -gradient.select_rows(&free);
        for (row, &i) in free.iter().enumerate() {
            // The small constants keep the matrix regular; a parameter without influence keeps its value.
            matrix[(row, row)] += damping * curvature[(i, i)] + 1e-12 + 1e-12 * curvature[(i, i)];
            for (j, step) in fixed.iter().enumerate() {
                right[row] -= step.map_or(0.0, |step| curvature[(i, j)] * step);
            }
        }
        let steps = matrix.cholesky().map_or_else(|| DVector::zeros(free.len()), |c| c.solve(&right));
        // The parameter that reaches its bound first is fixed at it. Only one is fixed at a time, as this may reverse the
        // steps of the others.
        let mut first: Option<(f64, usize, f64)> = None;
        for (&i, &step) in free.iter().zip(&steps) {
            let coordinate = &parameters[i].coordinate;
            let inside =
                (coordinate.value + step).clamp(coordinate.lower, coordinate.upper) - coordinate.value;
            let fraction = inside / step;
            // Tolerance for the rounding error of value + step.
            if fraction < 1.0 - 1e-9 && first.is_none_or(|(min, ..)| fraction < min) {
                first = Some((fraction, i, inside));
            }
        }
        if let Some((_, i, inside)) = first {
            fixed[i] = Some(inside);
        } else {
            let mut values: Vec<f64> =
                parameters.iter().map(|parameter| parameter.coordinate.value).collect();
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

    fn parameter(value: f64, lower: f64, upper: f64) -> FreeParameter {
        FreeParameter { coordinate: Coordinate::between(value, 0.1, lower, upper), prior: None }
    }

    /// ½xᵀHx + gᵀx with H = [[2, −1.9], [−1.9, 2]]: free, its minimum is at H⁻¹·(−g).
    fn curvature() -> DMatrix<f64> {
        DMatrix::from_row_slice(2, 2, &[2.0, -1.9, -1.9, 2.0])
    }

    #[test]
    fn without_bounds_steps_to_the_minimum() {
        let gradient = DVector::from_vec(vec![-1.0, 0.0]);
        let parameters = [parameter(0.0, -100.0, 100.0), parameter(0.0, -100.0, 100.0)];
        // Determinant 4 − 3.61 = 0.39: x = 2/0.39, y = 1.9/0.39.
        let moved = stepped(&parameters, &curvature(), &gradient, 0.0);
        assert!((moved[0] - 2.0 / 0.39).abs() < 1e-6 && (moved[1] - 1.9 / 0.39).abs() < 1e-6, "{moved:?}");
    }

    #[test]
    fn fixes_the_parameter_that_reaches_its_bound_first() {
        // Without bounds both would decrease; with the first fixed at −1 the second minimizes y² + 1.9·y + g·y.
        let gradient = DVector::from_vec(vec![1.0, -0.8]);
        let parameters = [parameter(0.0, -1.0, 100.0), parameter(0.0, -100.0, 100.0)];
        let moved = stepped(&parameters, &curvature(), &gradient, 0.0);
        // Free minimum: x = −(2 − 0.8·1.9)/0.39 < −1, y = −(1.9 − 1.6)/0.39; fixed: y = (0.8 − 1.9)/2.
        assert!((moved[0] + 1.0).abs() < 1e-9 && (moved[1] + 0.55).abs() < 1e-6, "{moved:?}");
    }
}
