//! Weighted least squares of a friction law over some of the runs of a map (Levenberg and Marquardt).

use nalgebra::{DMatrix, DVector};

use super::law::Term;
use super::{FrictionMap, Run};

/// A friction law with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// What it has beside Coulomb and viscous friction.
    pub terms: Vec<Term>,
    /// Coulomb, viscous, then the size of each term.
    pub sizes: Vec<f64>,
    /// Shape of each term; 1 where it has none.
    pub shapes: Vec<f64>,
    /// Fastest speed of the map.
    pub top: f64,
}

impl Law {
    /// Force at a velocity.
    #[must_use]
    pub fn force(&self, velocity: f64) -> f64 {
        self.columns(velocity).iter().zip(&self.sizes).map(|(column, size)| column * size).sum()
    }

    /// What each size is multiplied with.
    fn columns(&self, velocity: f64) -> Vec<f64> {
        let terms = self.terms.iter().zip(&self.shapes);
        let of_terms = terms.map(|(term, &shape)| term.basis(velocity, shape, self.top));
        [velocity.signum(), velocity].into_iter().chain(of_terms).collect()
    }

    /// Derivatives of the force by the sizes, then by the logarithms of the shapes that are free.
    fn gradient(&self, velocity: f64) -> Vec<f64> {
        const STEP: f64 = 1e-5;
        let mut row = self.columns(velocity);
        for (i, (term, &shape)) in self.terms.iter().zip(&self.shapes).enumerate() {
            if term.width() == 2 {
                let at = |shape: f64| term.basis(velocity, shape, self.top);
                let rise = at(shape * (1.0 + STEP)) - at(shape * (1.0 - STEP));
                row.push(self.sizes[i + 2] * rise / (2.0 * STEP));
            }
        }
        row
    }
}

/// A law that was fitted.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The law.
    pub law: Law,
    /// Σ of the squares of the weighted residuals.
    pub squares: f64,
    /// Numbers that were free.
    pub width: usize,
    /// Covariance of sizes and of the logarithms of shapes for a residual variance of 1.
    pub covariance: DMatrix<f64>,
    /// What a residual becomes when its own run is left out, to first order: divided by one minus this.
    pub leverage: Vec<f64>,
    /// Weighted residuals.
    pub residuals: Vec<f64>,
}

impl Fitted {
    /// Degrees of freedom that are left.
    #[must_use]
    pub fn free(&self) -> usize {
        self.residuals.len().saturating_sub(self.width)
    }

    /// Standard deviation of a weighted residual: 1 where the weights say all and the law is true.
    #[must_use]
    pub fn scatter(&self) -> f64 {
        (self.squares / self.free().max(1) as f64).sqrt()
    }

    /// Σ of the squares of what is predicted wrongly for a run from all others, weighted, to first order.
    #[must_use]
    pub fn left_out(&self) -> f64 {
        let one = |(residual, leverage): (&f64, &f64)| (residual / (1.0 - leverage).max(1e-3)).powi(2);
        self.residuals.iter().zip(&self.leverage).map(one).sum()
    }
}

/// Weight of each run: one over the standard error of its mean; 1 where the map does not tell.
#[must_use]
pub fn weights(runs: &[Run]) -> Vec<f64> {
    let error = |run: &Run| run.error.filter(|error| *error > 0.0);
    let told = runs.iter().all(|run| error(run).is_some());
    runs.iter().map(|run| if told { error(run).map_or(1.0, f64::recip) } else { 1.0 }).collect()
}

/// Places on the logarithmic range of a shape from which a fit is started.
const STARTS: u32 = 12;

/// Most steps of a fit.
const MOST_STEPS: u32 = 40;

/// A fit ends when a step lowers the squares by less than this share.
const ENOUGH: f64 = 1e-7;

/// Fits a law with one term more than another, started from all over the range of its shape.
#[must_use]
pub fn fit_with(map: &FrictionMap, runs: &[Run], base: &Law, term: Term) -> Option<Fitted> {
    let mut law = base.clone();
    law.terms.push(term);
    law.sizes.push(0.0);
    law.shapes.push(1.0);
    let Some(shape) = term.shape(map) else { return fit(map, runs, &law) };
    let last = law.shapes.len() - 1;
    let span = (shape.upper / shape.lower).ln();
    let start = |i: u32| {
        let mut law = law.clone();
        law.shapes[last] = shape.lower * (span * (f64::from(i) + 0.5) / f64::from(STARTS)).exp();
        sized(runs, &law)
    };
    // With the shape held the sizes are a linear problem: the best such start is polished.
    let (best, _) = (0..STARTS).filter_map(start).min_by(|a, b| a.1.total_cmp(&b.1))?;
    fit(map, runs, &best)
}

/// Fits sizes and shapes, from where the shapes stand. `None` where the runs do not determine them.
#[must_use]
pub fn fit(map: &FrictionMap, runs: &[Run], start: &Law) -> Option<Fitted> {
    let (mut best, mut squares) = sized(runs, start)?;
    if start.terms.iter().all(|term| term.width() == 1) {
        return told(runs, best);
    }
    let ranges: Vec<_> = start.terms.iter().map(|term| term.shape(map)).collect();
    let mut damping = 1e-3;
    for _ in 0..MOST_STEPS {
        let Some(step) = step(runs, &best, damping) else { break };
        let mut law = best.clone();
        let mut steps = step.iter().skip(law.sizes.len());
        for (shape, range) in law.shapes.iter_mut().zip(&ranges) {
            if let Some(range) = range {
                let step = steps.next().map_or(0.0, |step| step.clamp(-1.0, 1.0));
                *shape = (*shape * step.exp()).clamp(range.lower, range.upper);
            }
        }
        match sized(runs, &law) {
            Some((next, left)) if left < squares => {
                let is_enough = left > squares * (1.0 - ENOUGH);
                (best, squares) = (next, left);
                damping = (0.2 * damping).max(1e-9);
                if is_enough {
                    break;
                }
            }
            _ if damping > 1e4 => break,
            _ => damping *= 10.0,
        }
    }
    told(runs, best)
}

/// Weighted derivatives and residuals.
fn linearised(runs: &[Run], law: &Law) -> (DMatrix<f64>, DVector<f64>) {
    let weights = weights(runs);
    let rows: Vec<Vec<f64>> = runs.iter().map(|run| law.gradient(run.velocity)).collect();
    let width = rows.first().map_or(0, Vec::len);
    let jacobian = DMatrix::from_fn(runs.len(), width, |i, j| weights[i] * rows[i][j]);
    let left = runs.iter().zip(&weights).map(|(run, weight)| weight * (run.force - law.force(run.velocity)));
    (jacobian, DVector::from_iterator(runs.len(), left))
}

/// One damped step of all free numbers.
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

/// Columns of length 1, and the lengths that they had.
fn unit_columns(mut matrix: DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let norms = DVector::from_iterator(matrix.ncols(), matrix.column_iter().map(|c| c.norm().max(1e-300)));
    for (mut column, norm) in matrix.column_iter_mut().zip(&norms) {
        column /= *norm;
    }
    (matrix, norms)
}

/// Terms that are the same on these runs cannot be told apart: a pivot of columns of length 1 is the sine of the angle
/// between one and the others.
const LEAST_SINE: f64 = 1e-5;

/// The sizes at given shapes, and the weighted squares that they leave.
fn sized(runs: &[Run], law: &Law) -> Option<(Law, f64)> {
    let weights = weights(runs);
    let rows: Vec<Vec<f64>> = runs.iter().map(|run| law.columns(run.velocity)).collect();
    let matrix = DMatrix::from_fn(runs.len(), law.sizes.len(), |i, j| weights[i] * rows[i][j]);
    let forces = runs.iter().zip(&weights).map(|(run, weight)| weight * run.force);
    let forces = DVector::from_iterator(runs.len(), forces);
    let (scaled, norms) = unit_columns(matrix);
    let root = (scaled.transpose() * &scaled).cholesky()?;
    if root.l_dirty().diagonal().min() < LEAST_SINE {
        return None;
    }
    let solution = root.solve(&(scaled.transpose() * &forces));
    let left = (forces - scaled * &solution).norm_squared();
    let sizes = solution.component_div(&norms).iter().copied().collect();
    Some((Law { sizes, ..law.clone() }, left))
}

/// A law with all that is known around it.
fn told(runs: &[Run], law: Law) -> Option<Fitted> {
    let (jacobian, residuals) = linearised(runs, &law);
    let (scaled, norms) = unit_columns(jacobian);
    let width = norms.len();
    // A shape whose size is nothing has no influence: the small constant leaves it undetermined, not the rest.
    let curvature = scaled.transpose() * &scaled + 1e-12 * DMatrix::<f64>::identity(width, width);
    let inverse = curvature.cholesky()?.inverse();
    let leverage = scaled.row_iter().map(|row| (row * &inverse * row.transpose())[(0, 0)]).collect();
    let covariance = DMatrix::from_fn(width, width, |i, j| inverse[(i, j)] / (norms[i] * norms[j]));
    Some(Fitted {
        squares: residuals.norm_squared(),
        residuals: residuals.iter().copied().collect(),
        law,
        width,
        covariance,
        leverage,
    })
}
