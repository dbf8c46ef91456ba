//! What a motion tells of the unknowns: sums over its samples, which add up over motions.

use model::machine::Machine;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::candidates::Candidate;
use crate::response;
use crate::unknowns::{HALF_WIDTH, Pair, Unknowns, Variable};

/// Knowledge of a variable that nothing else is known of, so that sums can be inverted: it may move by this many of its steps.
const UNKNOWN_STEPS: f64 = 1e4;

/// Sums over samples. Variables count in their steps, channels in standard deviations of their noise.
#[derive(Clone, Debug)]
pub struct Information {
    /// Products of the sensitivities of the model.
    normal: DMatrix<f64>,
    pairs: Vec<OfPair>,
}

/// Sums of a pair of rivals. The variables of the rival are free, too: it may have other values than those that were fitted.
#[derive(Clone, Debug)]
struct OfPair {
    /// Products of all sensitivities: of the model, then of the rival.
    normal: DMatrix<f64>,
    /// Products of all sensitivities and the difference.
    with: DVector<f64>,
    /// Sum of the squares of the difference.
    squares: f64,
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn products(columns: &[Vec<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(columns.len(), columns.len(), |row, column| product(&columns[row], &columns[column]))
}

impl Information {
    /// What is known before any motion: tolerances.
    #[must_use]
    pub fn known(unknowns: &Unknowns) -> Self {
        let weights =
            || unknowns.variables.iter().map(|unknown| unknown.known_steps.min(UNKNOWN_STEPS).powi(-2));
        let diagonal = |more: usize| {
            let all: Vec<f64> = weights().chain(std::iter::repeat_n(UNKNOWN_STEPS.powi(-2), more)).collect();
            DMatrix::from_diagonal(&DVector::from_vec(all))
        };
        let of_pair = |pair: &Pair| {
            let normal = diagonal(pair.rival.coordinates().len());
            OfPair { with: DVector::zeros(normal.nrows()), normal, squares: 0.0 }
        };
        Self { normal: diagonal(0), pairs: unknowns.pairs.iter().map(of_pair).collect() }
    }

    /// What a part tells; `None` if the model cannot be simulated on it.
    #[must_use]
    pub fn of(model: &Machine, unknowns: &Unknowns, candidate: &Candidate) -> Option<Self> {
        let response = |machine: &Machine| response::of(machine, &candidate.motion);
        let base = response(model)?;
        let difference = |other: Option<Vec<f64>>, base: &[f64]| -> Vec<f64> {
            let other = other.unwrap_or_default();
            base.iter().zip(&other).map(|(base, other)| other - base).collect()
        };
        let columns: Vec<Vec<f64>> = unknowns
            .variables
            .par_iter()
            .map(|unknown| difference(response(&unknown.moved(model)), &base))
            .collect();
        let of_pair = |pair: &Pair| {
            let exchanged = response(&pair.exchanged(model));
            let own = exchanged.as_deref().unwrap_or_default();
            let moved = pair.moved().into_iter();
            let moved = moved.map(|pair| difference(response(&pair.exchanged(model)), own));
            let columns: Vec<Vec<f64>> = columns.iter().cloned().chain(moved).collect();
            let apart = difference(exchanged.clone(), &base);
            OfPair {
                normal: products(&columns),
                with: DVector::from_iterator(
                    columns.len(),
                    columns.iter().map(|column| product(column, &apart)),
                ),
                squares: product(&apart, &apart),
            }
        };
        let pairs = unknowns.pairs.par_iter().map(of_pair).collect();
        Some(Self { normal: products(&columns), pairs })
    }

    /// With another motion, a number of times.
    #[must_use]
    pub fn with(&self, other: &Self, times: f64) -> Self {
        let sum = |(own, other): (&OfPair, &OfPair)| OfPair {
            normal: &own.normal + times * &other.normal,
            with: &own.with + times * &other.with,
            squares: own.squares + times * other.squares,
        };
        Self {
            normal: &self.normal + times * &other.normal,
            pairs: self.pairs.iter().zip(&other.pairs).map(sum).collect(),
        }
    }

    /// For each pair, its difference that no variable can take up, in standard deviations: r² − cᵀN⁻¹c is what a fit of all variables
    /// leaves of its squares r².
    #[must_use]
    pub fn distances(&self) -> Vec<f64> {
        let distance = |pair: &OfPair| {
            let Some(factor) = pair.normal.clone().cholesky() else { return 0.0 };
            (pair.squares - pair.with.dot(&factor.solve(&pair.with))).max(0.0).sqrt()
        };
        self.pairs.iter().map(distance).collect()
    }

    /// Half widths of the 95 % intervals of the values of an effect, in the order of its values.
    #[must_use]
    pub fn half_widths(&self, model: &Machine, unknowns: &Unknowns, axis: usize, effect: usize) -> Vec<f64> {
        let own = &model.axis[axis].effect[effect];
        let values = own.values();
        let Some(inverse) = self.normal.clone().cholesky().map(|factor| factor.inverse()) else {
            return vec![f64::INFINITY; values.len()];
        };
        let x: Vec<f64> = own.coordinates().iter().map(|coordinate| coordinate.value).collect();
        let mut gradients = vec![DVector::zeros(unknowns.variables.len()); values.len()];
        for (column, unknown) in unknowns.variables.iter().enumerate() {
            let Variable::Effect(of, coordinate) = unknown.variable else { continue };
            if (unknown.axis, of) != (axis, effect) {
                continue;
            }
            let mut moved = x.clone();
            moved[coordinate] += unknown.step;
            for (gradient, (moved, value)) in
                gradients.iter_mut().zip(own.at(&moved).values().iter().zip(&values))
            {
                gradient[column] = moved - value;
            }
        }
        let half = |gradient: &DVector<f64>| HALF_WIDTH * gradient.dot(&(&inverse * gradient)).sqrt();
        gradients.iter().map(half).collect()
    }
}
