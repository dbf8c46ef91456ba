//! The samples of a residual, and normal equations of terms block by block.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::reversals::near_reversals;
use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::normal_equations::{Column, FOLDS, block_ranges};
use crate::input::signals::AxisSignals;
use crate::prediction::law_terms::LogVariables;
use model::effects::Stage;
use model::residual_law::{Term, WavePosition};
use model::residual_table::TableVariable;

/// Largest number of samples that are used: neighbours differ little.
const MOST_SAMPLES: usize = 24_000;

/// A block of consecutive samples of one log.
#[derive(Clone, Debug)]
pub struct SampleBlock {
    /// Index of the log.
    pub log: usize,
    /// Index of the fold of the cross-validation.
    pub fold: usize,
    /// Samples of the log that count.
    pub samples: Vec<usize>,
    /// The residual at each, µm or N.
    pub residual: Vec<f64>,
    /// Its derivatives with respect to the parameters that stay free beside the law.
    pub free: Vec<Vec<f64>>,
}

/// The samples of a residual of one stage, with the variables of a law.
#[derive(Clone, Debug)]
pub struct Samples<'a> {
    /// Blocks of all logs.
    pub blocks: Vec<SampleBlock>,
    /// The variables, by log.
    pub variables: Vec<LogVariables<'a>>,
}

impl<'a> Samples<'a> {
    /// The samples of a stage that count, with the derivatives with respect to the parameters that stay free.
    #[must_use]
    pub fn of(
        data: &FitData<'a>,
        (residuals, free): (&[ResidualSeries], &[Column]),
        stage: Stage,
        variables: &[TableVariable],
    ) -> Self {
        let of_stage =
            || residuals.iter().filter(|series| series.stage == stage && !series.values.is_empty());
        let all: usize = of_stage().map(|series| series.values.len()).sum();
        let stride = all.div_ceil(MOST_SAMPLES).max(1);
        let mut blocks = Vec::new();
        for series in of_stage() {
            let counts = data.counting(stage, series.log);
            let axes = &data.logs[series.log].axes;
            let motions = axes.iter().filter_map(AxisSignals::table_or_motor);
            let reversals: Vec<Vec<bool>> = motions.map(near_reversals).collect();
            let reverses =
                |sample: usize| reversals.iter().any(|near| near.get(sample).copied().unwrap_or(false));
            let ranges = block_ranges(series.values.len(), data.shortest_block(series.log));
            let number = ranges.len();
            for (i, range) in ranges.into_iter().enumerate() {
                let samples: Vec<usize> =
                    range.step_by(stride).filter(|&sample| counts(sample) && !reverses(sample)).collect();
                let residual = samples.iter().map(|&sample| series.values[sample]).collect();
                let of_column = |column: &Column| {
                    let of_log = column.iter().find(|other| (other.stage, other.log) == (stage, series.log));
                    let value =
                        |sample: &usize| of_log.and_then(|of_log| of_log.values.get(*sample)).copied();
                    samples.iter().map(|sample| value(sample).map_or(0.0, f64::from)).collect()
                };
                let free = free.iter().map(of_column).collect();
                blocks.push(SampleBlock {
                    log: series.log,
                    fold: i * FOLDS / number,
                    samples,
                    residual,
                    free,
                });
            }
        }
        blocks.retain(|block| !block.samples.is_empty());
        let of_log = |log| LogVariables::new(&data.logs[log], data.axis, stage, variables);
        Self { blocks, variables: (0..data.logs.len()).map(of_log).collect() }
    }

    /// The values of a position with the residuals.
    #[must_use]
    pub fn pairs(&self, over: WavePosition) -> Vec<(f64, f64)> {
        let position = Term::Product { of: vec![over.variable()], coefficient: 1.0 };
        let of_term = &self.along(std::slice::from_ref(&position))[0];
        let of_block = |block: &'_ SampleBlock| {
            let [at, _] = &of_term[block.log];
            let at: Vec<f64> = block.samples.iter().map(|&sample| at[sample]).collect();
            at.into_iter().zip(block.residual.clone())
        };
        self.blocks.iter().flat_map(of_block).collect()
    }

    /// The parts of each term along each log.
    fn along(&self, terms: &[Term]) -> Vec<Vec<[Vec<f64>; 2]>> {
        terms.par_iter().map(|term| self.variables.iter().map(|log| log.parts(term)).collect()).collect()
    }

    /// Number of columns that are in every subset: the constant, and the parameters that stay free.
    #[must_use]
    pub fn always(&self) -> usize {
        1 + self.blocks.first().map_or(0, |block| block.free.len())
    }

    /// The samples with only some of the free parameters.
    #[must_use]
    pub fn with_free(mut self, kept: &[usize]) -> Self {
        for block in &mut self.blocks {
            block.free = kept.iter().filter_map(|&index| block.free.get(index).cloned()).collect();
        }
        self
    }

    /// These samples without a sum of terms, and without the parts of the columns that are in every subset.
    #[must_use]
    pub fn without(&self, always: &[f64], terms: &[Term]) -> Self {
        let along = self.along(terms);
        let mut rest = self.clone();
        for block in &mut rest.blocks {
            let SampleBlock { log, samples, residual, free, .. } = block;
            for (i, (&sample, residual)) in samples.iter().zip(residual).enumerate() {
                let columns = std::iter::once(1.0).chain(free.iter().map(|column| column[i]));
                *residual -= columns.zip(always).map(|(column, value)| column * value).sum::<f64>();
                for (term, along) in terms.iter().zip(&along) {
                    let ([a, b], [x, y]) = (term.coefficients(), &along[*log]);
                    *residual -= a * x[sample] + b * y[sample];
                }
            }
        }
        rest
    }

    /// The normal equations of what is always in a law and of some terms, block by block.
    #[must_use]
    pub fn normal(&self, terms: &[Term]) -> Vec<Normal> {
        let along = self.along(terms);
        let of_block = |block: &SampleBlock| {
            let mut columns: Vec<Vec<f64>> = vec![vec![1.0; block.samples.len()]];
            columns.extend(block.free.iter().cloned());
            for (term, along) in terms.iter().zip(&along) {
                let parts = &along[block.log][..columns_of(term)];
                columns.extend(
                    parts.iter().map(|part| block.samples.iter().map(|&sample| part[sample]).collect()),
                );
            }
            Normal::of(block, &columns)
        };
        self.blocks.par_iter().map(of_block).collect()
    }
}

/// Number of columns of a term: two of a wave, otherwise one.
#[must_use]
pub const fn columns_of(term: &Term) -> usize {
    match term {
        Term::Wave { .. } => 2,
        Term::Product { .. } | Term::Hysteresis { .. } => 1,
    }
}

/// Normal equations of a constant (first), the parameters that stay free, and terms, over some samples.
#[derive(Clone, Debug)]
pub struct Normal {
    /// Fold of the cross-validation.
    pub fold: usize,
    /// Number of samples.
    pub samples: usize,
    /// Σ r².
    pub squares: f64,
    /// `Jᵀr`.
    pub gradient: DVector<f64>,
    /// `JᵀJ`.
    pub curvature: DMatrix<f64>,
}

impl Normal {
    fn of(block: &SampleBlock, columns: &[Vec<f64>]) -> Self {
        let (n, samples) = (columns.len(), block.samples.len());
        let matrix = DMatrix::from_fn(samples, n, |row, column| columns[column][row]);
        let residual = DVector::from_column_slice(&block.residual);
        Self {
            fold: block.fold,
            samples,
            squares: residual.norm_squared(),
            gradient: matrix.tr_mul(&residual),
            curvature: matrix.tr_mul(&matrix),
        }
    }

    /// The sum of some blocks; `None` without any.
    pub fn sum<'a>(blocks: impl Iterator<Item = &'a Self>) -> Option<Self> {
        blocks.fold(None, |sum: Option<Self>, block| {
            Some(sum.map_or_else(
                || block.clone(),
                |sum| Self {
                    samples: sum.samples + block.samples,
                    squares: sum.squares + block.squares,
                    gradient: sum.gradient + &block.gradient,
                    curvature: sum.curvature + &block.curvature,
                    ..sum
                },
            ))
        })
    }

    /// Σ r² with these coefficients, of which most are zero: columns and values.
    #[must_use]
    pub fn squares_with(&self, coefficients: &[(usize, f64)]) -> f64 {
        let of_row = |&(i, a): &(usize, f64)| {
            let products = coefficients.iter().map(|&(j, b)| b * self.curvature[(i, j)]);
            a * (products.sum::<f64>() - 2.0 * self.gradient[i])
        };
        (self.squares + coefficients.iter().map(of_row).sum::<f64>()).max(0.0)
    }
}
