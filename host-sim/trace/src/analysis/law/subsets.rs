//! The subsets of a library of terms that describe a residual best.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::library::parameters;
use super::samples::{Normal, columns_of};
use model::residual_law::Term;

/// Number of subsets of each size that are kept and extended by a further term.
const KEPT: usize = 60;

/// Smallest part of a column's square that is not a combination of the other columns of its subset.
const MIN_INDEPENDENT: f64 = 1e-3;

/// A subset of the library, fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Subset {
    /// Indices of the terms, ascending.
    pub terms: Vec<usize>,
    /// Columns and their coefficients; first those that are in every subset: the constant, and parameters that stay free.
    pub coefficients: Vec<(usize, f64)>,
    /// Σ r² that remains.
    pub squares: f64,
    /// [`Self::squares`] with the price of each value that is fitted.
    pub score: f64,
}

/// A library of terms and the columns of each.
#[derive(Clone, Debug)]
pub struct Library {
    /// The terms.
    pub terms: Vec<Term>,
    /// Number of columns that are in every subset.
    pub always: usize,
    columns: Vec<Range<usize>>,
}

impl Library {
    /// A library of these terms; the columns before them are in every subset.
    #[must_use]
    pub fn new(terms: Vec<Term>, always: usize) -> Self {
        let mut next = always;
        let of_term = |term: &Term| {
            let first = next;
            next += columns_of(term);
            first..next
        };
        let columns = terms.iter().map(of_term).collect();
        Self { terms, always, columns }
    }

    /// The best subsets of 0 to `most` terms, by size, best first. `price`: the factor on Σ r² that a further value has to reduce.
    #[must_use]
    pub fn best(&self, normal: &Normal, most: usize, price: f64) -> Vec<Vec<Subset>> {
        let empty = self.fitted(normal, Vec::new(), price);
        let mut by_size = vec![empty.into_iter().collect::<Vec<_>>()];
        for size in 1..=most {
            let mut found: Vec<Subset> = Vec::new();
            for smaller in &by_size[size - 1] {
                for term in (0..self.terms.len()).filter(|term| !smaller.terms.contains(term)) {
                    let mut terms = smaller.terms.clone();
                    terms.push(term);
                    terms.sort_unstable();
                    if found.iter().all(|known| known.terms != terms) {
                        found.extend(self.fitted(normal, terms, price));
                    }
                }
                found.sort_by(|a, b| a.score.total_cmp(&b.score));
                found.truncate(KEPT);
            }
            by_size.push(found);
        }
        by_size
    }

    /// A subset, fitted; `None` if its terms do not differ enough on the samples.
    #[must_use]
    pub fn fitted(&self, normal: &Normal, terms: Vec<usize>, price: f64) -> Option<Subset> {
        let columns: Vec<usize> =
            (0..self.always).chain(terms.iter().flat_map(|&term| self.columns[term].clone())).collect();
        let values = solved(normal, &columns)?;
        let coefficients: Vec<(usize, f64)> = columns.into_iter().zip(values).collect();
        let squares = normal.squares_with(&coefficients);
        let values: i32 = terms.iter().map(|&term| parameters(&self.terms[term])).sum();
        Some(Subset { terms, coefficients, squares, score: squares * price.powi(values) })
    }

    /// By how many standard errors each term of a subset differs from zero on some blocks, to which the coefficients are fitted
    /// again. The errors are those of independent blocks, whatever the samples within a block have in common (White, 1980). Zero, if
    /// the blocks do not determine the coefficients, or determine them with the other sign.
    #[must_use]
    pub fn t_of_terms(&self, blocks: &[Normal], subset: &Subset) -> Vec<f64> {
        let fitted = || {
            let columns: Vec<usize> = subset.coefficients.iter().map(|(column, _)| *column).collect();
            let total = Normal::sum(blocks.iter())?;
            let values = solved(&total, &columns)?;
            let covariance = covariance(blocks, &total, &columns, &values)?;
            Some((columns, values, covariance))
        };
        let Some((columns, values, covariance)) = fitted() else { return vec![0.0; subset.terms.len()] };
        let t_of_term = |&term: &usize| {
            let range = &self.columns[term];
            let own: Vec<usize> = (0..columns.len()).filter(|&i| range.contains(&columns[i])).collect();
            let value = DVector::from_fn(own.len(), |i, _| values[own[i]]);
            let known = DVector::from_fn(own.len(), |i, _| subset.coefficients[own[i]].1);
            let of_term = DMatrix::from_fn(own.len(), own.len(), |i, j| covariance[(own[i], own[j])]);
            let solution = of_term.cholesky().map(|factor| factor.solve(&value));
            let squares = solution.map_or(0.0, |solution| solution.dot(&value));
            if value.dot(&known) > 0.0 { squares.sqrt() } else { 0.0 }
        };
        subset.terms.iter().map(t_of_term).collect()
    }

    /// Σ of the square of what each term of a subset adds to the samples of some blocks.
    #[must_use]
    pub fn squares_of_terms(&self, blocks: &[Normal], subset: &Subset) -> Vec<f64> {
        let of_term = |&term: &usize| {
            let own = || subset.coefficients.iter().filter(|(column, _)| self.columns[term].contains(column));
            let of_block = |block: &Normal| {
                let products =
                    own().flat_map(|&(i, a)| own().map(move |&(j, b)| a * b * block.curvature[(i, j)]));
                products.sum::<f64>()
            };
            blocks.iter().map(of_block).sum()
        };
        subset.terms.iter().map(of_term).collect()
    }

    /// The terms of a subset with their coefficients.
    #[must_use]
    pub fn with_coefficients(&self, subset: &Subset) -> Vec<Term> {
        let value = |column: usize| {
            let found = subset.coefficients.iter().find(|(known, _)| *known == column);
            found.map_or(0.0, |(_, value)| *value)
        };
        let of_term = |&term: &usize| {
            let Range { start, end } = self.columns[term];
            self.terms[term].with([value(start), if end - start > 1 { value(start + 1) } else { 0.0 }])
        };
        subset.terms.iter().map(of_term).collect()
    }
}

/// The indices of free parameters whose columns are no combination of the constant and the ones before them.
#[must_use]
pub fn independent(normal: &Normal) -> Vec<usize> {
    let mut kept = vec![0];
    for column in 1..normal.gradient.len() {
        kept.push(column);
        if solved(normal, &kept).is_none() {
            kept.pop();
        }
    }
    kept[1..].iter().map(|column| column - 1).collect()
}

/// The coefficients of some columns that minimise Σ r²; `None` if one of the columns is a combination of the others.
#[must_use]
pub fn solved(normal: &Normal, columns: &[usize]) -> Option<Vec<f64>> {
    solved_above(normal, columns, MIN_INDEPENDENT)
}

/// The coefficients of some columns that minimise Σ r²; `None` if a smaller part than this of a column's square is no combination of
/// the others.
#[must_use]
pub fn solved_above(normal: &Normal, columns: &[usize], min_independent: f64) -> Option<Vec<f64>> {
    let (scale, matrix) = scaled(normal, columns)?;
    let right = DVector::from_fn(columns.len(), |i, _| normal.gradient[columns[i]] / scale[i]);
    let factor = matrix.cholesky()?;
    if factor.l_dirty().diagonal().iter().any(|pivot| pivot * pivot < min_independent) {
        return None;
    }
    let solution = factor.solve(&right);
    Some(solution.iter().zip(&scale).map(|(value, scale)| value / scale).collect())
}

/// The lengths of some columns, and `JᵀJ` of the columns scaled to a length of 1; `None` if a column is zero.
fn scaled(normal: &Normal, columns: &[usize]) -> Option<(Vec<f64>, DMatrix<f64>)> {
    let scale: Vec<f64> = columns.iter().map(|&i| normal.curvature[(i, i)].sqrt()).collect();
    if scale.iter().any(|scale| !(*scale > 0.0 && scale.is_finite())) {
        return None;
    }
    let n = columns.len();
    let matrix =
        DMatrix::from_fn(n, n, |i, j| normal.curvature[(columns[i], columns[j])] / (scale[i] * scale[j]));
    Some((scale, matrix))
}

/// The covariance of coefficients by the scatter of the blocks: A⁻¹·Σ s·sᵀ·A⁻¹ with the gradients s of the blocks at these values.
fn covariance(blocks: &[Normal], total: &Normal, columns: &[usize], values: &[f64]) -> Option<DMatrix<f64>> {
    let n = columns.len();
    let (scale, matrix) = scaled(total, columns)?;
    let inverse = matrix.cholesky()?.inverse();
    let mut scatter = DMatrix::zeros(n, n);
    for block in blocks {
        let gradient = DVector::from_fn(n, |i, _| {
            let modelled =
                columns.iter().zip(values).map(|(&j, value)| value * block.curvature[(columns[i], j)]);
            (block.gradient[columns[i]] - modelled.sum::<f64>()) / scale[i]
        });
        scatter.ger(1.0, &gradient, &gradient, 1.0);
    }
    let count = blocks.len() as f64;
    let product = &inverse * scatter * &inverse * (count / (count - n as f64).max(1.0));
    Some(DMatrix::from_fn(n, n, |i, j| product[(i, j)] / (scale[i] * scale[j])))
}
