//! Least squares: the coefficients of the terms, and what more terms would explain.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::samples::Samples;
use super::term::{Shape, Term};

/// Relative step of the numerical derivative by the parameter of a term.
const STEP: f64 = 1e-4;

/// Added to the diagonal of the normal equations, relative to it: terms that are the same on an incomplete circle then share their
/// coefficient, instead of a division by zero.
const RIDGE: f64 = 1e-11;

/// Terms, and those of them that share a parameter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// All terms.
    pub terms: Vec<Term>,
    /// Terms with one parameter in common, as indices.
    pub groups: Vec<Range<usize>>,
}

impl Model {
    /// Adds terms with a common parameter.
    pub fn add(&mut self, terms: &[Term]) {
        let start = self.terms.len();
        self.terms.extend_from_slice(terms);
        self.groups.push(start..self.terms.len());
    }

    /// The parameter of a group.
    #[must_use]
    pub fn parameter(&self, group: usize) -> f64 {
        self.terms[self.groups[group].start].parameter().unwrap_or(1.0)
    }

    /// This model with another shape of the spike of a group; itself if it is none.
    #[must_use]
    pub fn with_shape(&self, group: usize, shape: Shape) -> Self {
        let mut model = self.clone();
        for term in &mut model.terms[self.groups[group].clone()] {
            if let Term::Spike(axis, _, width) = *term {
                *term = Term::Spike(axis, shape, width);
            }
        }
        model
    }

    fn set_parameter(&mut self, group: usize, value: f64) {
        for term in &mut self.terms[self.groups[group].clone()] {
            *term = term.with_parameter(value);
        }
    }
}

/// The coefficients of a model, by least squares.
#[derive(Clone, Debug)]
pub struct Fit {
    /// One column for each term.
    pub matrix: DMatrix<f64>,
    /// Inverse of the matrix of the normal equations.
    pub inverse: DMatrix<f64>,
    /// Coefficients, µm.
    pub coefficients: DVector<f64>,
    /// Measured values less the sum of the terms, µm.
    pub residual: DVector<f64>,
}

impl Fit {
    /// Fits the terms to all samples.
    #[must_use]
    pub fn new(samples: &Samples, terms: &[Term]) -> Self {
        let values = DVector::from_vec(samples.values());
        let matrix = matrix(samples, terms);
        let inverse = inverse(&matrix.tr_mul(&matrix));
        let coefficients = &inverse * matrix.tr_mul(&values);
        let residual = values - &matrix * &coefficients;
        Self { matrix, inverse, coefficients, residual }
    }

    /// By how much the sum of squares falls, µm², if columns are added, and their coefficients.
    #[must_use]
    pub fn gain(&self, columns: &DMatrix<f64>) -> (f64, DVector<f64>) {
        let common = self.matrix.tr_mul(columns);
        let remaining = columns.tr_mul(columns) - common.tr_mul(&(&self.inverse * &common));
        let right = columns.tr_mul(&self.residual);
        let coefficients = inverse(&remaining) * &right;
        (right.dot(&coefficients), coefficients)
    }

    /// Variance of the part of the residual that the sample before does not predict, µm².
    #[must_use]
    pub fn unpredicted_variance(&self) -> f64 {
        let values = self.residual.as_slice();
        let square: f64 = self.residual.norm_squared();
        let product: f64 = values.iter().zip(values.iter().skip(1)).map(|(a, b)| a * b).sum();
        let correlation = product / square.max(1e-300);
        square / values.len().max(1) as f64 * (1.0 - correlation * correlation)
    }

    /// Rms of the residual, µm.
    #[must_use]
    pub fn rms_um(&self) -> f64 {
        numerics::rms(self.residual.iter().copied())
    }
}

/// The columns of terms.
#[must_use]
pub fn matrix(samples: &Samples, terms: &[Term]) -> DMatrix<f64> {
    let column = |term: &Term| samples.column(|at| term.displacement(at, samples.radius_mm));
    let columns: Vec<f64> = terms.iter().flat_map(column).collect();
    let rows = if terms.is_empty() { 0 } else { columns.len() / terms.len() };
    DMatrix::from_vec(rows, terms.len(), columns)
}

/// The derivatives of the fitted sum by the parameter of each group, per relative change.
#[must_use]
pub fn derivatives(samples: &Samples, model: &Model, fit: &Fit) -> DMatrix<f64> {
    let column = |group: &Range<usize>| {
        samples.column(|at| {
            let mut sum = [0.0; 2];
            for i in group.clone() {
                let (term, coefficient) = (model.terms[i], fit.coefficients[i]);
                let parameter = term.parameter().unwrap_or(1.0);
                for (step, sign) in [(STEP, 1.0), (-STEP, -1.0)] {
                    let moved = term.with_parameter(parameter * (1.0 + step));
                    let value = moved.displacement(at, samples.radius_mm);
                    let weight = sign * coefficient / (2.0 * STEP);
                    sum = [sum[0] + weight * value[0], sum[1] + weight * value[1]];
                }
            }
            sum
        })
    };
    let columns: Vec<f64> = model.groups.iter().flat_map(column).collect();
    DMatrix::from_vec(fit.residual.len(), model.groups.len(), columns)
}

/// Fits the coefficients and the parameters of a model together (Gauss-Newton).
#[must_use]
pub fn refined(samples: &Samples, model: &mut Model) -> Fit {
    const ROUNDS: usize = 6;
    const SMALL: f64 = 1e-6;
    /// Largest relative change of a width in a round.
    const MAX_CHANGE: f64 = 0.2;
    let mut fit = Fit::new(samples, &model.terms);
    for _ in 0..ROUNDS {
        if model.groups.is_empty() {
            break;
        }
        let (_, changes) = fit.gain(&derivatives(samples, model, &fit));
        let mut changed = model.clone();
        for (group, change) in changes.iter().enumerate().filter(|(_, change)| change.is_finite()) {
            let change = change.clamp(-MAX_CHANGE, MAX_CHANGE);
            changed.set_parameter(group, model.parameter(group) * (1.0 + change));
        }
        let next = Fit::new(samples, &changed.terms);
        if next.residual.norm_squared() > fit.residual.norm_squared() {
            break;
        }
        (*model, fit) = (changed, next);
        if changes.amax() < SMALL {
            break;
        }
    }
    fit
}

/// Inverse of a matrix of normal equations, whose columns are scaled to the same norm first.
#[must_use]
pub fn inverse(normal: &DMatrix<f64>) -> DMatrix<f64> {
    let scale = DVector::from_iterator(
        normal.nrows(),
        normal.diagonal().iter().map(|d| if *d > 0.0 { d.sqrt().recip() } else { 0.0 }),
    );
    let mut scaled =
        DMatrix::from_fn(normal.nrows(), normal.ncols(), |i, j| normal[(i, j)] * scale[i] * scale[j]);
    for i in 0..scaled.nrows() {
        scaled[(i, i)] += RIDGE;
    }
    let inverse =
        scaled.clone().try_inverse().unwrap_or_else(|| DMatrix::zeros(scaled.nrows(), scaled.ncols()));
    DMatrix::from_fn(normal.nrows(), normal.ncols(), |i, j| inverse[(i, j)] * scale[i] * scale[j])
}
