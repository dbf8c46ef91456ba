//! Least squares of all terms and of what is unknown of the instruments.
//!
//! A combination of unknowns that no reading shows is left at zero. A term that has a part of it is not determined, nor is one whose
//! standard error exceeds [`OPEN_UM`].

use nalgebra::{DMatrix, DVector};

use super::field::{Geometry, Term};
use super::measurement::{Group, Row, fitted};
use super::vector::dot;

/// Standard error from which on a term counts as not determined, µm where it moves the tool most at any reading.
pub const OPEN_UM: f64 = 1.0;

/// Standard error from which on a combination of unknowns counts as shown by no reading, µm.
const UNSEEN_UM: f64 = 1e3;

/// Smallest part of a term that must be determined: the root of what lacks, 3 %, is what it may take of another error.
const MIN_RESOLUTION: f64 = 0.999;

/// Standard deviation below which no measurement is believed, µm.
const FINEST_UM: f64 = 0.02;

/// Rounds in which the noise of each measurement is estimated.
const ROUNDS: usize = 4;

/// Half of a 95 % interval, in standard deviations.
const HALF_95: f64 = 1.96;

/// Smallest ratio of eigenvalues that is no rounding error.
const ROUNDING: f64 = 1e-9;

/// The fitted terms.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The terms.
    pub terms: Vec<Term>,
    /// Their values, µm or µrad.
    pub values: Vec<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Whether the data determine each.
    pub is_determined: Vec<bool>,
}

/// The equations of all measurements of a fit.
struct Equations {
    /// Of the terms first, then of the instruments; each column is scaled to 1 at most.
    matrix: DMatrix<f64>,
    scales: Vec<f64>,
    values_um: DVector<f64>,
    /// The measurement of each row.
    group: Vec<usize>,
}

impl Fit {
    /// Fits terms to measurements, those that are held out excluded.
    #[must_use]
    pub fn of(geometry: &Geometry, terms: Vec<Term>, groups: &[Group]) -> Self {
        let fitted: Vec<&Group> = fitted(groups).collect();
        let equations = Equations::of(geometry, &terms, &fitted);
        let floor = |group: &&Group| group.scatter_um.max(FINEST_UM);
        let mut noise_um: Vec<f64> = fitted.iter().map(|group| floor(group).max(1.0)).collect();
        let mut solved = equations.solved(&noise_um);
        for _ in 0..ROUNDS {
            for (index, group) in fitted.iter().enumerate() {
                noise_um[index] =
                    floor(group).max(equations.noise_um(&solved.left_um, index, solved.freedom));
            }
            solved = equations.solved(&noise_um);
        }
        let count = terms.len();
        let values = (0..count).map(|term| solved.unknowns[term] / equations.scales[term]).collect();
        let covariance = DMatrix::from_fn(count, count, |a, b| {
            solved.covariance[(a, b)] / (equations.scales[a] * equations.scales[b])
        });
        let is_determined = |term: usize| {
            solved.resolution[term] >= MIN_RESOLUTION && solved.covariance[(term, term)] <= OPEN_UM * OPEN_UM
        };
        let is_determined = (0..count).map(is_determined).collect();
        Self { terms, values, covariance, is_determined }
    }

    /// The sum of terms, by their indices, each times its factor, and half of its 95 % interval.
    #[must_use]
    pub fn sum(&self, terms: &[usize], factors: &[f64]) -> (f64, f64) {
        let value = factors.iter().zip(terms).map(|(factor, term)| factor * self.values[*term]).sum();
        let mut variance = 0.0;
        for (one, first) in factors.iter().zip(terms) {
            for (other, second) in factors.iter().zip(terms) {
                variance += one * other * self.covariance[(*first, *second)];
            }
        }
        (value, HALF_95 * variance.max(0.0).sqrt())
    }
}

/// A solution in scaled unknowns.
struct Solved {
    unknowns: DVector<f64>,
    covariance: DMatrix<f64>,
    /// The part of each unknown that is determined, 0 to 1.
    resolution: Vec<f64>,
    left_um: DVector<f64>,
    /// Rows for each degree of freedom.
    freedom: f64,
}

impl Equations {
    fn of(geometry: &Geometry, terms: &[Term], groups: &[&Group]) -> Self {
        let rows: Vec<&Row> = groups.iter().flat_map(|group| &group.rows).collect();
        let instruments: usize = groups.iter().map(|group| group.unknowns.len()).sum();
        let mut matrix = DMatrix::zeros(rows.len(), terms.len() + instruments);
        for (column, term) in terms.iter().enumerate() {
            for (index, row) in rows.iter().enumerate() {
                matrix[(index, column)] = dot(row.direction, geometry.effect_um(*term, row.at_mm));
            }
        }
        let (mut first, mut column, mut group) = (0, terms.len(), Vec::new());
        for (number, of) in groups.iter().enumerate() {
            for values in &of.unknowns {
                for (index, value) in values.iter().enumerate() {
                    matrix[(first + index, column)] = *value;
                }
                column += 1;
            }
            first += of.rows.len();
            group.extend(std::iter::repeat_n(number, of.rows.len()));
        }
        let mut scales = Vec::new();
        for mut column in matrix.column_iter_mut() {
            let largest = column.amax();
            let scale = if largest > 0.0 { largest } else { 1.0 };
            column /= scale;
            scales.push(scale);
        }
        let values_um = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.value_um));
        Self { matrix, scales, values_um, group }
    }

    /// Weighted least squares without the directions that the data do not determine.
    fn solved(&self, noise_um: &[f64]) -> Solved {
        let weight = |row: usize| 1.0 / noise_um[self.group[row]];
        let weighted = DMatrix::from_fn(self.matrix.nrows(), self.matrix.ncols(), |row, column| {
            self.matrix[(row, column)] * weight(row)
        });
        let values = DVector::from_fn(self.values_um.len(), |row, _| self.values_um[row] * weight(row));
        let unknowns = self.matrix.ncols();
        // The eigenvectors of the normal equations are the directions; their number is small.
        let normal = (weighted.transpose() * &weighted).symmetric_eigen();
        let right = weighted.transpose() * values;
        let largest = normal.eigenvalues.max();
        let mut solution = DVector::zeros(unknowns);
        let mut covariance = DMatrix::zeros(unknowns, unknowns);
        let mut resolution = vec![0.0; unknowns];
        let mut determined = 0.0;
        for (index, eigenvalue) in normal.eigenvalues.iter().enumerate() {
            let is_open = *eigenvalue < 1.0 / (UNSEEN_UM * UNSEEN_UM) || *eigenvalue < ROUNDING * largest;
            if is_open {
                continue;
            }
            determined += 1.0;
            let direction = normal.eigenvectors.column(index);
            solution += direction * (direction.dot(&right) / eigenvalue);
            covariance += direction * direction.transpose() / *eigenvalue;
            for (part, component) in resolution.iter_mut().zip(direction.iter()) {
                *part += component * component;
            }
        }
        let left_um = &self.values_um - &self.matrix * &solution;
        let rows = self.values_um.len() as f64;
        let freedom = rows / (rows - determined).max(1.0);
        Solved { unknowns: solution, covariance, resolution, left_um, freedom }
    }

    fn of_group(&self, left_um: &DVector<f64>, group: usize) -> Vec<f64> {
        let own = left_um.iter().zip(&self.group).filter(|(_, of)| **of == group);
        own.map(|(left_um, _)| *left_um).collect()
    }

    /// The noise of a measurement as independent values would have it: what is left, with its correlation from row to row.
    fn noise_um(&self, left_um: &DVector<f64>, group: usize, freedom: f64) -> f64 {
        let left_um = self.of_group(left_um, group);
        let square = numerics::mean(left_um.iter().map(|um| um * um));
        if square <= 0.0 {
            return 0.0;
        }
        let neighbours = numerics::mean(left_um.windows(2).map(|two| two[0] * two[1]));
        let correlation = (neighbours / square).clamp(0.0, 0.95);
        (square * freedom * (1.0 + correlation) / (1.0 - correlation)).sqrt()
    }
}
