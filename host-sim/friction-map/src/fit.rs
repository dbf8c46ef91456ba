//! Weighted least squares of a friction law over runs of a map (Levenberg and Marquardt).

use nalgebra::{DMatrix, DVector};
use numerics::distributions::student_t_975;

use super::law::Law;
use super::map::{FrictionMap, Run};
use super::term::Term;

/// A fitted law.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The law.
    pub law: Law,
    /// Sum of the squared weighted residuals.
    pub squares: f64,
    /// Number of free parameters.
    pub parameter_count: usize,
    /// Covariance of the sizes and of the logarithms of the free shapes, for weighted residuals of variance 1.
    pub covariance: DMatrix<f64>,
    /// Leverage of each run (diagonal of the hat matrix), 0 to 1.
    pub leverage: Vec<f64>,
    /// Weighted residuals: (measured − law) divided by the standard error of the mean.
    pub residuals: Vec<f64>,
}

impl Fit {
    /// Degrees of freedom of the fit.
    #[must_use]
    pub fn degrees_of_freedom(&self) -> usize {
        self.residuals.len().saturating_sub(self.parameter_count)
    }

    /// Standard deviation of the weighted residuals: near 1 if the weights and the law are correct.
    #[must_use]
    pub fn residual_deviation(&self) -> f64 {
        (self.squares / self.degrees_of_freedom().max(1) as f64).sqrt()
    }

    /// PRESS statistic: sum of the squared weighted errors of each run predicted from all other runs, to first order
    /// residual/(1 − leverage).
    #[must_use]
    pub fn press(&self) -> f64 {
        let one = |(residual, leverage): (&f64, &f64)| (residual / (1.0 - leverage).max(1e-3)).powi(2);
        self.residuals.iter().zip(&self.leverage).map(one).sum()
    }

    /// Half widths of the 95 % intervals of the sizes, then of the logarithms of the free shapes.
    #[must_use]
    pub fn half_widths(&self) -> Vec<f64> {
        let spread = student_t_975(self.degrees_of_freedom()) * self.residual_deviation();
        self.covariance.diagonal().iter().map(|variance| spread * variance.max(0.0).sqrt()).collect()
    }
}

/// Weight of each run: 1 / standard error of its mean; 1 for all runs if any of them has no standard error.
#[must_use]
pub fn weights(runs: &[Run]) -> Vec<f64> {
    let error = |run: &Run| run.error.filter(|error| *error > 0.0);
    let are_known = runs.iter().all(|run| error(run).is_some());
    runs.iter().map(|run| if are_known { error(run).map_or(1.0, f64::recip) } else { 1.0 }).collect()
}

/// Number of initial values of a shape, evenly spaced on a logarithmic scale over its range.
const STARTS: u32 = 12;

/// Maximum number of steps of a fit.
const MAX_STEPS: u32 = 40;

/// A fit has converged when a step lowers the squares by less than this fraction.
const CONVERGED: f64 = 1e-7;

/// Fits `base` with an additional term, from the best of several initial values of its shape.
#[must_use]
pub fn fit_with(map: &FrictionMap, runs: &[Run], base: &Law, term: Term) -> Option<Fit> {
    let law = base.with(term);
    let Some(range) = term.shape_range(map) else { return fit(map, runs, &law) };
    let last = law.shapes.len() - 1;
    let span = libm::log(range.max / range.min);
    let start = |i: u32| {
        let mut law = law.clone();
        law.shapes[last] = range.min * libm::exp(span * (f64::from(i) + 0.5) / f64::from(STARTS));
        fit_sizes(runs, &law)
    };
    // At given shapes, the sizes are the solution of a linear problem.
    let (best, _) = (0..STARTS).filter_map(start).min_by(|a, b| a.1.total_cmp(&b.1))?;
    fit(map, runs, &best)
}

/// Fits sizes and shapes, starting at the shapes of `start`. `None` if the runs do not determine them.
#[must_use]
pub fn fit(map: &FrictionMap, runs: &[Run], start: &Law) -> Option<Fit> {
    let (mut best, mut squares) = fit_sizes(runs, start)?;
    if start.terms.iter().all(|term| term.parameter_count() == 1) {
        return evaluated(runs, best);
    }
    let ranges: Vec<_> = start.terms.iter().map(|term| term.shape_range(map)).collect();
    let mut damping = 1e-3;
    for _ in 0..MAX_STEPS {
        let Some(step) = step(runs, &best, damping) else { break };
        let mut law = best.clone();
        let mut steps = step.iter().skip(law.sizes.len());
        for (shape, range) in law.shapes.iter_mut().zip(&ranges) {
            if let Some(range) = range {
                let step = steps.next().map_or(0.0, |step| step.clamp(-1.0, 1.0));
                *shape = (*shape * libm::exp(step)).clamp(range.min, range.max);
            }
        }
        match fit_sizes(runs, &law) {
            Some((next, next_squares)) if next_squares < squares => {
                let has_converged = next_squares > squares * (1.0 - CONVERGED);
                (best, squares) = (next, next_squares);
                damping = (0.2 * damping).max(1e-9);
                if has_converged {
                    break;
                }
            }
            _ if damping > 1e4 => break,
            _ => damping *= 10.0,
        }
    }
    evaluated(runs, best)
}

/// Weighted Jacobian and residuals.
fn linearised(runs: &[Run], law: &Law) -> (DMatrix<f64>, DVector<f64>) {
    let weights = weights(runs);
    let rows: Vec<Vec<f64>> = runs.iter().map(|run| law.gradient(run.velocity)).collect();
    let width = rows.first().map_or(0, Vec::len);
    let jacobian = DMatrix::from_fn(runs.len(), width, |i, j| weights[i] * rows[i][j]);
    let residual = |(run, weight): (&Run, &f64)| weight * (run.force - law.force(run.velocity));
    let residuals = runs.iter().zip(&weights).map(residual);
    (jacobian, DVector::from_iterator(runs.len(), residuals))
}

/// One damped Gauss–Newton step of all free parameters; damping applies to columns scaled to length 1.
fn step(runs: &[Run], at: &Law, damping: f64) -> Option<DVector<f64>> {
    let (jacobian, residuals) = linearised(runs, at);
    let (scaled, norms) = unit_columns(jacobian);
    let mut curvature = scaled.transpose() * &scaled;
    for i in 0..norms.len() {
        curvature[(i, i)] += damping;
    }
    let step = curvature.cholesky()?.solve(&(scaled.transpose() * residuals));
    Some(step.component_div(&norms))
}

/// The matrix with columns scaled to length 1, and their original lengths.
fn unit_columns(mut matrix: DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let norms = DVector::from_iterator(matrix.ncols(), matrix.column_iter().map(|c| c.norm().max(1e-300)));
    for (mut column, norm) in matrix.column_iter_mut().zip(&norms) {
        column /= *norm;
    }
    (matrix, norms)
}

/// Minimum pivot of the Cholesky factor for columns of length 1: the sine of the angle between a column and the span of the
/// previous ones. Below it, two terms are indistinguishable on these runs.
const MIN_SINE: f64 = 1e-5;

/// Fits the sizes at given shapes; returns the law and the sum of the squared weighted residuals.
fn fit_sizes(runs: &[Run], law: &Law) -> Option<(Law, f64)> {
    let weights = weights(runs);
    let rows: Vec<Vec<f64>> = runs.iter().map(|run| law.basis(run.velocity)).collect();
    let matrix = DMatrix::from_fn(runs.len(), law.sizes.len(), |i, j| weights[i] * rows[i][j]);
    let forces = runs.iter().zip(&weights).map(|(run, weight)| weight * run.force);
    let forces = DVector::from_iterator(runs.len(), forces);
    let (scaled, norms) = unit_columns(matrix);
    let factor = (scaled.transpose() * &scaled).cholesky()?;
    if factor.l_dirty().diagonal().min() < MIN_SINE {
        return None;
    }
    let solution = factor.solve(&(scaled.transpose() * &forces));
    let squares = (forces - scaled * &solution).norm_squared();
    let sizes = solution.component_div(&norms).iter().copied().collect();
    Some((Law { sizes, ..law.clone() }, squares))
}

/// Residuals, covariance and leverage of a law.
fn evaluated(runs: &[Run], law: Law) -> Option<Fit> {
    let (jacobian, residuals) = linearised(runs, &law);
    let (scaled, norms) = unit_columns(jacobian);
    let count = norms.len();
    // The shape of a term of size 0 has no influence; the small constant keeps the matrix invertible.
    let curvature = scaled.transpose() * &scaled + 1e-12 * DMatrix::<f64>::identity(count, count);
    let inverse = curvature.cholesky()?.inverse();
    let leverage = scaled.row_iter().map(|row| (row * &inverse * row.transpose())[(0, 0)]).collect();
    let covariance = DMatrix::from_fn(count, count, |i, j| inverse[(i, j)] / (norms[i] * norms[j]));
    Some(Fit {
        squares: residuals.norm_squared(),
        residuals: residuals.iter().copied().collect(),
        law,
        parameter_count: count,
        covariance,
        leverage,
    })
}
