//! Covariance of coefficients under residuals that are correlated in time.
//!
//! The residual of each sensor is modelled as autoregressive noise, A(q)·e = white noise of variance σ² (Yule-Walker equations, solved by
//! Levinson's recursion). With e = A⁻¹·ε, the covariance of least-squares coefficients is H·(Σ u·uᵀ)·σ²·H, where H is the inverse of
//! the normal equations and u = A⁻ᵀ·x a column, filtered backwards. The estimate is made twice: at the full rate, for columns that
//! oscillate, and on means over half a degree, for slow noise. The larger variance counts.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::fit::inverse;
use super::samples::Samples;

/// Order of the noise model at the full rate, and on means.
const ORDERS: [usize; 2] = [16, 8];

/// Angle over which samples are averaged, rad.
const BLOCK_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// Both estimates of the covariance, µm².
#[derive(Clone, Debug)]
pub struct Covariance([DMatrix<f64>; 2]);

impl Covariance {
    /// The covariance of the coefficients of columns that leave a residual.
    #[must_use]
    pub fn new(samples: &Samples, columns: &DMatrix<f64>, residual: &DVector<f64>) -> Self {
        let inverse = inverse(&columns.tr_mul(columns));
        let segments = samples.segments();
        let blocks = Blocks::new(samples, &segments);
        let sandwich =
            |columns: &DMatrix<f64>, residual: &DVector<f64>, segments: &[Vec<Range<usize>>], order| {
                let filtered = filtered(columns, residual, segments, order);
                &inverse * filtered.tr_mul(&filtered) * &inverse
            };
        let full = sandwich(columns, residual, &segments, ORDERS[0]);
        let Some(blocks) = blocks else { return Self([full.clone(), full]) };
        let (sums, means) = blocks.of(columns, residual);
        let blocked = sandwich(&sums, &means, &blocks.segments, ORDERS[1]);
        Self([full, blocked])
    }

    /// Variance of Σ weight·coefficient.
    #[must_use]
    pub fn variance(&self, weights: &[(usize, f64)]) -> f64 {
        let of = |matrix: &DMatrix<f64>| -> f64 {
            let pairs = weights.iter().flat_map(|a| weights.iter().map(move |b| (a, b)));
            pairs.map(|((i, wi), (j, wj))| wi * wj * matrix[(*i, *j)]).sum()
        };
        numerics::max(self.0.iter().map(of)).max(0.0)
    }
}

/// Columns filtered backwards by the noise model of each sensor, times its σ.
fn filtered(
    columns: &DMatrix<f64>,
    residual: &DVector<f64>,
    segments: &[Vec<Range<usize>>],
    order: usize,
) -> DMatrix<f64> {
    let free = residual.len() as f64 / (residual.len() as f64 - columns.ncols() as f64).max(1.0);
    let noise: Vec<(Vec<f64>, f64)> =
        segments.iter().map(|sensor| autoregressive(residual.as_slice(), sensor, order)).collect();
    let filter = |column: &[f64]| {
        let mut out = vec![0.0; column.len()];
        for (sensor, (weights, variance)) in segments.iter().zip(&noise) {
            for segment in sensor {
                backwards(&column[segment.clone()], weights, &mut out[segment.clone()]);
                let sigma = (free * variance).sqrt();
                out[segment.clone()].iter_mut().for_each(|value| *value *= sigma);
            }
        }
        out
    };
    let rows = columns.nrows();
    let all: Vec<f64> = columns.as_slice().par_chunks(rows.max(1)).flat_map_iter(filter).collect();
    DMatrix::from_vec(rows, columns.ncols(), all)
}

/// u with u(i) = x(i) + Σ weight(k)·u(i + k).
fn backwards(x: &[f64], weights: &[f64], u: &mut [f64]) {
    if x.iter().all(|value| *value == 0.0) {
        return;
    }
    for i in (0..x.len()).rev() {
        let later = &u[i + 1..];
        let sum: f64 = weights.iter().zip(later).map(|(weight, value)| weight * value).sum();
        u[i] = x[i] + sum;
    }
}

/// Weights of the previous values, and variance of what they do not predict.
fn autoregressive(values: &[f64], segments: &[Range<usize>], order: usize) -> (Vec<f64>, f64) {
    let count: usize = segments.iter().map(Range::len).sum();
    let product = |lag: usize| {
        let of = |segment: &Range<usize>| -> f64 {
            let part = &values[segment.clone()];
            part.iter().zip(part.iter().skip(lag)).map(|(a, b)| a * b).sum()
        };
        segments.iter().map(of).sum::<f64>() / count.max(1) as f64
    };
    let correlation: Vec<f64> = (0..=order).map(product).collect();
    let (mut weights, mut variance) = (Vec::new(), correlation[0]);
    for k in 1..=order {
        if variance <= 1e-9 * correlation[0] {
            break;
        }
        let predicted: f64 = (0..k - 1).map(|j| weights[j] * correlation[k - 1 - j]).sum();
        let reflection = (correlation[k] - predicted) / variance;
        let mirrored: Vec<f64> = weights.iter().rev().copied().collect();
        for (weight, other) in weights.iter_mut().zip(&mirrored) {
            *weight -= reflection * other;
        }
        weights.push(reflection);
        variance *= 1.0 - reflection * reflection;
    }
    (weights, variance.max(0.0))
}

/// Rows joined to blocks.
struct Blocks {
    rows: Vec<Range<usize>>,
    segments: Vec<Vec<Range<usize>>>,
}

impl Blocks {
    /// `None` if a block is a single sample.
    fn new(samples: &Samples, segments: &[Vec<Range<usize>>]) -> Option<Self> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of samples")]
        let length = (BLOCK_RAD / samples.step_rad().max(1e-9)).round() as usize;
        if length < 2 {
            return None;
        }
        let mut blocks = Self { rows: Vec::new(), segments: Vec::new() };
        for sensor in segments {
            let mut joined = Vec::new();
            for segment in sensor {
                let start = blocks.rows.len();
                let starts = segment.clone().step_by(length);
                blocks.rows.extend(starts.map(|from| from..(from + length).min(segment.end)));
                joined.push(start..blocks.rows.len());
            }
            blocks.segments.push(joined);
        }
        Some(blocks)
    }

    /// The sums of the columns and the means of the residual.
    fn of(&self, columns: &DMatrix<f64>, residual: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
        let sum = |values: &[f64], rows: &Range<usize>| values[rows.clone()].iter().sum::<f64>();
        let mean = |rows: &Range<usize>| sum(residual.as_slice(), rows) / rows.len() as f64;
        let means = DVector::from_iterator(self.rows.len(), self.rows.iter().map(mean));
        let each = columns.as_slice().chunks(columns.nrows().max(1));
        let all: Vec<f64> =
            each.flat_map(|column| self.rows.iter().map(move |rows| sum(column, rows))).collect();
        (DMatrix::from_vec(self.rows.len(), columns.ncols(), all), means)
    }
}
