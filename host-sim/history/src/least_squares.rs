//! Linear regression with the covariance of its coefficients.

use nalgebra::{DMatrix, DVector};
use numerics::distributions::student_t_975;

/// Columns whose smallest singular value is this fraction of the largest cannot be told apart.
const SINGULAR: f64 = 1e-9;

/// A regression of values on rows of regressors.
#[derive(Clone, Debug)]
pub struct Regression {
    /// A coefficient for each column.
    pub coefficients: DVector<f64>,
    /// Inverse of the matrix of the normal equations.
    inverse: DMatrix<f64>,
    /// Sum of the squared residuals.
    pub squares: f64,
    /// Rows less columns.
    pub freedom: usize,
}

impl Regression {
    /// The least-squares fit; `None` if the columns cannot be told apart, or if there are fewer rows than columns.
    #[must_use]
    pub fn of(rows: &[Vec<f64>], values: &[f64]) -> Option<Self> {
        let columns = rows.first()?.len();
        if rows.len() < columns {
            return None;
        }
        let x = DMatrix::from_fn(rows.len(), columns, |row, column| rows[row][column]);
        // Columns of one size: days and degrees are far apart.
        let sizes: Vec<f64> = x.column_iter().map(|column| column.norm()).collect();
        if sizes.contains(&0.0) {
            return None;
        }
        let scaled = DMatrix::from_fn(rows.len(), columns, |row, column| x[(row, column)] / sizes[column]);
        let singular = scaled.singular_values();
        if singular.min() < SINGULAR * singular.max() {
            return None;
        }
        let of_scaled = (scaled.transpose() * &scaled).try_inverse()?;
        let y = DVector::from_column_slice(values);
        let solution = &of_scaled * (scaled.transpose() * &y);
        let squares = (&y - &scaled * &solution).norm_squared();
        let inverse = DMatrix::from_fn(columns, columns, |a, b| of_scaled[(a, b)] / (sizes[a] * sizes[b]));
        let coefficients = DVector::from_fn(columns, |column, _| solution[column] / sizes[column]);
        Some(Self { coefficients, inverse, squares, freedom: rows.len() - columns })
    }

    /// The fitted value at a row.
    #[must_use]
    pub fn at(&self, row: &[f64]) -> f64 {
        row.iter().zip(self.coefficients.iter()).map(|(x, coefficient)| x * coefficient).sum()
    }

    /// Variance of the fitted value at a row, as a multiple of the variance of one value.
    #[must_use]
    pub fn leverage(&self, row: &[f64]) -> f64 {
        let row = DVector::from_column_slice(row);
        row.dot(&(&self.inverse * &row))
    }

    /// Covariance factor between the fitted values at two rows.
    #[must_use]
    pub fn joint_leverage(&self, a: &[f64], b: &[f64]) -> f64 {
        DVector::from_column_slice(a).dot(&(&self.inverse * DVector::from_column_slice(b)))
    }

    /// Variance of one value; infinite without a degree of freedom.
    #[must_use]
    pub fn variance(&self) -> f64 {
        if self.freedom == 0 { f64::INFINITY } else { self.squares / self.freedom as f64 }
    }

    /// Half width of the 95 % interval of the fitted value at a row.
    #[must_use]
    pub fn half_width(&self, row: &[f64]) -> f64 {
        student_t_975(self.freedom) * (self.variance() * self.leverage(row)).sqrt()
    }
}
