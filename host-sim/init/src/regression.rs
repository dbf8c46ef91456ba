//! Linear least squares over several logs, each with a constant of its own.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

/// Samples at either end of a log, where filters and differences have no neighbours.
const MARGIN: usize = 20;

/// The samples of a log of this length that take part.
#[must_use]
pub fn inner(samples: usize) -> Range<usize> {
    MARGIN..samples.saturating_sub(MARGIN).max(MARGIN)
}

/// Sums of products of N columns and a right-hand side, without the means of each log.
#[derive(Clone, Debug)]
pub struct Regression<const N: usize> {
    products: SMatrix<f64, N, N>,
    right: SVector<f64, N>,
    squares: f64,
    samples: usize,
}

/// Coefficients of a regression.
#[derive(Clone, Copy, Debug)]
pub struct Solution<const N: usize> {
    /// One coefficient for each column.
    pub values: [f64; N],
    /// Rms of what remains.
    pub rms: f64,
    /// Part of the right-hand side's standard deviation that remains, 0 to 1.
    pub left: f64,
}

impl<const N: usize> Default for Regression<N> {
    fn default() -> Self {
        Self { products: SMatrix::zeros(), right: SVector::zeros(), squares: 0.0, samples: 0 }
    }
}

impl<const N: usize> Regression<N> {
    /// Adds the rows of a log: columns and right-hand side of each sample.
    pub fn add_log(&mut self, rows: impl Iterator<Item = ([f64; N], f64)> + Clone) {
        let mut sum = (SVector::<f64, N>::zeros(), 0.0);
        let mut count = 0_usize;
        for (columns, right) in rows.clone() {
            sum.0 += SVector::from(columns);
            sum.1 += right;
            count += 1;
        }
        let scale = 1.0 / count.max(1) as f64;
        for (columns, right) in rows {
            let columns = SVector::from(columns) - sum.0 * scale;
            let right = right - sum.1 * scale;
            self.products += columns * columns.transpose();
            self.right += columns * right;
            self.squares += right * right;
        }
        self.samples += count;
    }

    /// A regression on the data of this one with M other columns, each a sum of these columns with the factors of a column of `factors`.
    #[must_use]
    pub fn combined<const M: usize>(&self, factors: &SMatrix<f64, N, M>) -> Regression<M> {
        Regression {
            products: factors.transpose() * self.products * factors,
            right: factors.transpose() * self.right,
            squares: self.squares,
            samples: self.samples,
        }
    }

    /// The coefficients of least squares; `None` if the columns are dependent, or there are too few samples.
    #[must_use]
    pub fn solve(&self) -> Option<Solution<N>> {
        if self.samples <= 2 * N {
            return None;
        }
        // Columns of very different units are scaled to the same length first.
        let scale = SVector::<f64, N>::from_fn(|i, _| self.products[(i, i)].sqrt().recip());
        if !scale.iter().all(|factor| factor.is_finite()) {
            return None;
        }
        let scaled = SMatrix::<f64, N, N>::from_fn(|i, j| self.products[(i, j)] * scale[i] * scale[j]);
        let inverse = scaled.try_inverse()?;
        let values = (inverse * self.right.component_mul(&scale)).component_mul(&scale);
        let left = self.squares - values.dot(&self.right);
        let rms = (left.max(0.0) / self.samples as f64).sqrt();
        let left = (left.max(0.0) / self.squares).sqrt();
        values.iter().all(|value| value.is_finite()).then_some(Solution { values: values.into(), rms, left })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = 2·a − 3·b + a constant of each log, with an error of ±0.1 in turn: the coefficients to 1 %, the rest 0.1.
    #[test]
    fn coefficients_are_found_beside_constants_of_the_logs() {
        let mut regression = Regression::<2>::default();
        for (log, constant) in [(1.0, 5.0), (2.0, -40.0)] {
            let row = move |i: u32| {
                let t = f64::from(i) * 0.01 * log;
                let (a, b) = (t.sin(), (1.7 * t).cos() + 100.0);
                let error = if i.is_multiple_of(2) { 0.1 } else { -0.1 };
                ([a, b], 2.0 * a - 3.0 * b + constant + error)
            };
            regression.add_log((0..3000).map(row));
        }
        let Solution { values: [a, b], rms, left } = regression.solve().unwrap();
        assert!(
            (a - 2.0).abs() < 0.02 && (b + 3.0).abs() < 0.02 && (rms - 0.1).abs() < 1e-3,
            "{a} {b} {rms}"
        );
        // Two sines of the amplitudes 2 and 3 have a standard deviation of √(2 + 4.5).
        assert!((left - 0.1 / 6.5_f64.sqrt()).abs() < 2e-3, "{left}");
        // The sum of both columns alone: one coefficient, between the two.
        let sum = regression.combined(&SMatrix::<f64, 2, 1>::new(1.0, 1.0)).solve().unwrap();
        assert!((-3.0..2.0).contains(&sum.values[0]) && sum.rms > 0.5);
    }

    #[test]
    fn dependent_columns_have_no_solution() {
        let mut regression = Regression::<2>::default();
        regression.add_log((0..100).map(|i| ([f64::from(i), 0.0], f64::from(i))));
        assert!(regression.solve().is_none());
    }
}
