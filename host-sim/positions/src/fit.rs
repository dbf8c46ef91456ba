//! Least squares of a form of the deviation, with the intervals of what is linear in its coefficients.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use numerics::distributions::{f_test_p_value, student_t_975};

use super::variant::{Drift, Grid, Mean, Place, Variant};

/// What is fitted: a deviation at each place, and the run that it is of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// Where and when.
    pub places: Vec<Place>,
    /// Deviations, µm.
    pub deviations_um: Vec<f64>,
    /// Index of the run.
    pub runs: Vec<usize>,
}

impl Samples {
    /// The samples of which a run is true.
    #[must_use]
    pub fn of_runs(&self, is: impl Fn(usize) -> bool) -> Self {
        let mut kept = Self::default();
        for (index, run) in self.runs.iter().enumerate().filter(|(_, run)| is(**run)) {
            kept.places.push(self.places[index]);
            kept.deviations_um.push(self.deviations_um[index]);
            kept.runs.push(*run);
        }
        kept
    }

    /// The runs that have samples.
    #[must_use]
    pub fn distinct_runs(&self) -> Vec<usize> {
        let mut runs = self.runs.clone();
        runs.sort_unstable();
        runs.dedup();
        runs
    }
}

/// A fitted form.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The form.
    pub variant: Variant,
    /// Coefficients of its columns, µm, or µm/m of straight lines.
    pub coefficients: DVector<f64>,
    /// What it leaves of each sample, µm.
    pub residuals_um: Vec<f64>,
    /// Degrees of freedom that are left.
    pub freedom: f64,
    /// How much a drift over position is held to a straight line.
    pub ridge: f64,
    inverse: DMatrix<f64>,
    /// Sum over the runs of the squared scores.
    scores: DMatrix<f64>,
    runs: usize,
}

/// Probability by chance below which runs count as different from each other.
const MAX_CHANCE: f64 = 0.05;

/// Relative addition to the diagonal: coefficients of which no sample tells are zero.
const LEAST: f64 = 1e-9;

impl Fit {
    /// Fits a form; `ridge` holds a drift over position to a straight line.
    #[must_use]
    pub fn of(variant: &Variant, grid: &Grid, samples: &Samples, ridge: f64) -> Option<Self> {
        let design = variant.design(grid, &samples.places);
        let deviations = DVector::from_column_slice(&samples.deviations_um);
        let normal = design.transpose() * &design;
        let penalised = &normal + ridge * variant.penalty(grid);
        let factor = factor(penalised)?;
        let coefficients = factor.solve(&(design.transpose() * &deviations));
        let residuals = deviations - &design * &coefficients;
        let inverse = factor.inverse();
        // The period of a wave is fitted as well, by the search.
        let periods = if let Mean::Waves(periods) = &variant.mean { periods.len() } else { 0 };
        let freedom = samples.runs.len() as f64 - (&inverse * normal).trace() - periods as f64;
        let mut scores = DMatrix::zeros(inverse.nrows(), inverse.nrows());
        let runs = samples.distinct_runs();
        for run in &runs {
            let mut score = DVector::zeros(inverse.nrows());
            for index in (0..samples.runs.len()).filter(|&index| samples.runs[index] == *run) {
                score += residuals[index] * design.row(index).transpose();
            }
            scores += &score * score.transpose();
        }
        Some(Self {
            variant: variant.clone(),
            coefficients,
            residuals_um: residuals.iter().copied().collect(),
            freedom,
            ridge,
            inverse,
            scores,
            runs: runs.len(),
        })
    }

    /// Deviation at a place, µm.
    #[must_use]
    pub fn at(&self, grid: &Grid, place: &Place) -> f64 {
        self.variant.row(grid, place).dot(&self.coefficients)
    }

    /// Sum of the squared residuals, µm².
    #[must_use]
    pub fn squares(&self) -> f64 {
        self.residuals_um.iter().map(|residual| residual * residual).sum()
    }

    /// Standard deviation of the scatter, µm: with the degrees of freedom that are left; `None` without any.
    #[must_use]
    pub fn scatter_um(&self) -> Option<f64> {
        (self.freedom > 0.5).then(|| (self.squares() / self.freedom).sqrt())
    }

    /// Covariance of some coefficients for a variance of 1 of the scatter.
    #[must_use]
    pub fn covariance(&self, columns: std::ops::Range<usize>) -> DMatrix<f64> {
        self.inverse.view((columns.start, columns.start), (columns.len(), columns.len())).into_owned()
    }

    /// Half width of the 95 % interval of a combination of the coefficients that all readings of a run tell, such as an offset; NaN without
    /// degrees of freedom. Readings count as independent, unless runs differ by more than that makes likely: then the runs are the
    /// witnesses, not the readings.
    #[must_use]
    pub fn half_width(&self, weights: &DVector<f64>) -> f64 {
        let Some(scatter_um) = self.scatter_um() else { return f64::NAN };
        let spread = &self.inverse * weights;
        let independent = scatter_um * scatter_um * weights.dot(&spread).max(0.0);
        let drifts = usize::from(self.variant.drift != Drift::None);
        let left = self.runs.saturating_sub(1 + drifts);
        if left > 0 {
            let factor = self.runs as f64 / left as f64;
            let of_runs = factor * spread.dot(&(&self.scores * &spread)).max(0.0);
            let is_more = of_runs > independent
                && f_test_p_value(of_runs / independent, left, whole(self.freedom)) < MAX_CHANCE;
            if is_more {
                return student_t_975(left) * of_runs.sqrt();
            }
        }
        self.half_width_of_readings(weights)
    }

    /// Half width of the 95 % interval of a combination that few readings of a run tell, such as the value at a knot: they count as
    /// independent.
    #[must_use]
    pub fn half_width_of_readings(&self, weights: &DVector<f64>) -> f64 {
        let Some(scatter_um) = self.scatter_um() else { return f64::NAN };
        let variance = weights.dot(&(&self.inverse * weights)).max(0.0);
        student_t_975(whole(self.freedom)) * scatter_um * variance.sqrt()
    }
}

/// Degrees of freedom as a whole number of at least 1.
#[must_use]
pub fn whole(freedom: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
    let whole = freedom.max(1.0).round() as usize;
    whole
}

fn factor(mut normal: DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    let greatest = normal.diagonal().max().max(f64::MIN_POSITIVE);
    for index in 0..normal.nrows() {
        let own = normal[(index, index)];
        normal[(index, index)] = own + LEAST * own.max(1e-6 * greatest);
    }
    normal.cholesky()
}
