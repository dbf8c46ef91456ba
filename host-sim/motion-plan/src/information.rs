//! What a motion tells of the unknowns: sums over its samples, which add up over motions.

use model::machine::Machine;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::candidates::Candidate;
use crate::response;
use crate::unknowns::{HALF_WIDTH, Unknown, Unknowns, Variable};

/// Knowledge of a variable that nothing else is known of, so that sums can be inverted: it may move by this many of its steps.
const UNKNOWN_STEPS: f64 = 1e4;

/// Sums over samples. Variables count in their steps, channels in standard deviations of their noise.
#[derive(Clone, Debug)]
pub struct Information {
    /// Products of the sensitivities.
    normal: DMatrix<f64>,
    /// For each pair, products of the sensitivities and its difference.
    with_pairs: Vec<DVector<f64>>,
    /// For each pair, the sum of the squares of its difference.
    squares: Vec<f64>,
}

impl Information {
    /// What is known before any motion: tolerances.
    #[must_use]
    pub fn known(unknowns: &Unknowns) -> Self {
        let variables = unknowns.variables.iter();
        let weights = variables.map(|unknown| unknown.known_steps.min(UNKNOWN_STEPS).powi(-2));
        let diagonal = DVector::from_iterator(unknowns.variables.len(), weights);
        Self {
            with_pairs: vec![DVector::zeros(diagonal.len()); unknowns.pairs.len()],
            squares: vec![0.0; unknowns.pairs.len()],
            normal: DMatrix::from_diagonal(&diagonal),
        }
    }

    /// What a part tells; `None` if the model cannot be simulated on it.
    #[must_use]
    pub fn of(model: &Machine, unknowns: &Unknowns, candidate: &Candidate) -> Option<Self> {
        let base = response::of(model, &candidate.motion)?;
        let difference = |machine: &Machine| -> Option<Vec<f64>> {
            let other = response::of(machine, &candidate.motion)?;
            Some(base.iter().zip(&other).map(|(base, other)| other - base).collect())
        };
        let moves = |axis: usize| candidate.moving.contains(&axis);
        let columns: Vec<Vec<f64>> = unknowns
            .variables
            .par_iter()
            .map(|unknown| {
                let acts = moves(unknown.axis) || has_source(unknown, model);
                if acts { difference(&unknown.moved(model)) } else { None }.unwrap_or_default()
            })
            .collect();
        let pairs: Vec<Vec<f64>> = unknowns
            .pairs
            .par_iter()
            .map(|pair| difference(&pair.exchanged(model)).unwrap_or_default())
            .collect();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let count = columns.len();
        Some(Self {
            normal: DMatrix::from_fn(count, count, |row, column| product(&columns[row], &columns[column])),
            with_pairs: pairs
                .iter()
                .map(|pair| DVector::from_fn(count, |row, _| product(&columns[row], pair)))
                .collect(),
            squares: pairs.iter().map(|pair| product(pair, pair)).collect(),
        })
    }

    /// With another motion, a number of times.
    #[must_use]
    pub fn with(&self, other: &Self, times: f64) -> Self {
        let pairs = self.with_pairs.iter().zip(&other.with_pairs);
        Self {
            normal: &self.normal + times * &other.normal,
            with_pairs: pairs.map(|(own, other)| own + times * other).collect(),
            squares: self
                .squares
                .iter()
                .zip(&other.squares)
                .map(|(own, other)| own + times * other)
                .collect(),
        }
    }

    /// For each pair, its difference that no variable can take up, in standard deviations: r² − cᵀN⁻¹c is what a fit of all variables
    /// leaves of its squares r².
    #[must_use]
    pub fn distances(&self) -> Vec<f64> {
        let Some(inverse) = self.normal.clone().cholesky() else { return vec![0.0; self.squares.len()] };
        let left = |(with, squares): (&DVector<f64>, &f64)| {
            (squares - with.dot(&inverse.solve(with))).max(0.0).sqrt()
        };
        self.with_pairs.iter().zip(&self.squares).map(left).collect()
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

/// Whether an effect acts where another axis moves.
fn has_source(unknown: &Unknown, model: &Machine) -> bool {
    match unknown.variable {
        Variable::Effect(effect, _) => {
            model.axis[unknown.axis].effect[effect].distinction().source().is_some()
        }
        Variable::Declared(_) => false,
    }
}
