//! Load and waves of a curve over the position by least squares, and the noise beside the waves.

use std::f64::consts::{PI, TAU};

use nalgebra::{Complex, DMatrix, DVector, Dyn, linalg::SVD};

use super::plan::{Candidate, Grid};

/// Lines beside a wave from which its noise is estimated.
const LINES: usize = 8;

/// Distance of such a line from every wave that is looked for, in lines.
const BESIDE: f64 = 0.75;

/// Condition below which the positions do not determine the waves.
const LEAST_SINGULAR: f64 = 1e-9;

/// A wave amplitude·sin(2πx/period + phase) as amplitude·e^(i·phase).
pub type Wave = Complex<f64>;

/// The least-squares fit of a constant, a slope and waves to values over a grid.
pub struct Design<'a> {
    grid: &'a Grid,
    candidates: &'a [Candidate],
    columns: DMatrix<f64>,
    solver: SVD<f64, Dyn, Dyn>,
}

/// A fitted curve.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// Value in the middle of the grid.
    pub middle: f64,
    /// Change over the grid.
    pub change: f64,
    /// The waves of the candidates.
    pub waves: Vec<Wave>,
    /// What is left at each position.
    pub residual: Vec<f64>,
}

impl<'a> Design<'a> {
    /// The design for waves on a grid.
    #[must_use]
    pub fn new(grid: &'a Grid, candidates: &'a [Candidate]) -> Self {
        let columns = DMatrix::from_fn(grid.points, 2 + 2 * candidates.len(), |point, column| match column {
            0 => 1.0,
            1 => (point as f64 + 0.5) / grid.points as f64 - 0.5,
            _ => {
                let (sine, cosine) = sin_cos(grid, point, candidates[(column - 2) / 2].period_mm);
                if column % 2 == 0 { sine } else { cosine }
            }
        });
        let solver = columns.clone().svd(true, true);
        Self { grid, candidates, columns, solver }
    }

    /// Fits the values at the positions. What the means over the spacings of the positions take from each wave is given back.
    #[must_use]
    pub fn fit(&self, values: &[f64]) -> Fitted {
        let values = DVector::from_column_slice(values);
        let found = self.solver.solve(&values, LEAST_SINGULAR);
        let found = found.unwrap_or_else(|_| DVector::zeros(self.columns.ncols()));
        let residual = values - &self.columns * &found;
        let wave = |(index, candidate): (usize, &Candidate)| {
            let taken = Complex::new(found[2 + 2 * index], found[3 + 2 * index]);
            taken / mean_of_wave(self.grid.spacing_mm, candidate.period_mm)
        };
        Fitted {
            middle: found[0],
            change: found[1],
            waves: self.candidates.iter().enumerate().map(wave).collect(),
            residual: residual.iter().copied().collect(),
        }
    }

    /// Variance of sine and cosine of a wave by what is left of a curve at the nearest wave numbers that are not looked for, and its degrees
    /// of freedom. What repeats along the travel without a period counts as noise there.
    #[must_use]
    pub fn noise_beside(&self, residual: &[f64], candidate: &Candidate) -> (f64, usize) {
        let length_mm = self.grid.length_mm();
        let place = length_mm / candidate.period_mm;
        let is_beside = |line: f64| {
            self.candidates.iter().all(|other| (line - length_mm / other.period_mm).abs() >= BESIDE)
        };
        let mut lines: Vec<f64> =
            (1..self.grid.points / 4).map(|line| line as f64).filter(|line| is_beside(*line)).collect();
        lines.sort_by(|one, other| (one - place).abs().total_cmp(&(other - place).abs()));
        lines.truncate(LINES);
        let power = |line: &f64| {
            let sums = residual.iter().enumerate().map(|(point, value)| {
                let (sine, cosine) = sin_cos(self.grid, point, length_mm / line);
                Complex::new(value * sine, value * cosine)
            });
            (sums.sum::<Wave>() * 2.0 / residual.len() as f64).norm_sqr()
        };
        let variance = lines.iter().map(power).sum::<f64>() / (2 * lines.len()).max(1) as f64;
        (variance, 2 * lines.len())
    }
}

fn sin_cos(grid: &Grid, point: usize, period_mm: f64) -> (f64, f64) {
    libm::sincos(TAU * grid.position_mm(point) / period_mm)
}

/// Mean of a wave over a spacing around its greatest value, as a fraction of it: sin(πs/p)/(πs/p).
fn mean_of_wave(spacing_mm: f64, period_mm: f64) -> f64 {
    let half = PI * spacing_mm / period_mm;
    libm::sin(half) / half
}
