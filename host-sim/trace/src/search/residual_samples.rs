//! The residual of a driven stage over the motion of its motor, without its linear dependence on the motion.

use nalgebra::{DMatrix, DVector};

use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::normal_equations::{BLOCKS, FOLDS};
use model::effects::Stage;

/// A sample of a residual.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Position of the motor, mm.
    pub position_mm: f64,
    /// Direction of motion, −1 or 1.
    pub direction: f64,
    /// Residual without its dependence on velocity, acceleration and direction, and without a line, µm or N.
    pub residual: f64,
    /// Fold of the cross-validation. Blocks alternate, unlike those of [`super::held_out`]: a map can predict only positions
    /// that the fitted data contain, and a log may visit the ends of its travel once.
    pub fold: usize,
}

/// The samples of a stage that count.
#[must_use]
pub fn samples(data: &FitData<'_>, residuals: &[ResidualSeries], stage: Stage) -> Vec<Sample> {
    let mut rows = Vec::new();
    let mut samples = Vec::new();
    for series in residuals.iter().filter(|series| series.stage == stage) {
        let Some(motor) = &data.signals(series.log).motor else { continue };
        let counts = data.counting(stage, series.log);
        let fold_of = |i: usize| i * BLOCKS / series.values.len() % FOLDS;
        for i in (0..series.values.len()).filter(|&i| counts(i)) {
            let (position_mm, velocity) = (1e3 * motor.value[i], motor.velocity[i]);
            let direction = 1.0f64.copysign(velocity);
            rows.push([1.0, position_mm, direction, velocity, motor.acceleration[i]]);
            samples.push(Sample { position_mm, direction, residual: series.values[i], fold: fold_of(i) });
        }
    }
    remove(&rows, &mut samples);
    samples
}

/// The samples of the tool stage that count, over position and direction of any axis; without a linear dependence on position, velocity and
/// acceleration of that axis and of their own.
#[must_use]
pub fn samples_over(data: &FitData<'_>, residuals: &[ResidualSeries], axis: usize) -> Vec<Sample> {
    let mut rows = Vec::new();
    let mut samples = Vec::new();
    for series in residuals.iter().filter(|series| series.stage == Stage::Tool) {
        let log = &data.logs[series.log];
        let both = [data.axis, axis].map(|axis| log.axes[axis].table_or_motor());
        let [Some(own), Some(source)] = both else { continue };
        let counts = data.counting(Stage::Tool, series.log);
        let fold_of = |i: usize| i * BLOCKS / series.values.len() % FOLDS;
        for i in (0..series.values.len()).filter(|&i| counts(i)) {
            let (position_mm, velocity) = (1e3 * source.value[i], source.velocity[i]);
            rows.push([
                1.0,
                position_mm,
                velocity,
                source.acceleration[i],
                1e3 * own.value[i],
                own.velocity[i],
                own.acceleration[i],
            ]);
            let direction = 1.0f64.copysign(velocity);
            samples.push(Sample { position_mm, direction, residual: series.values[i], fold: fold_of(i) });
        }
    }
    remove(&rows, &mut samples);
    samples
}

/// Subtracts the best linear combination of some columns from the residuals.
fn remove<const N: usize>(rows: &[[f64; N]], samples: &mut [Sample]) {
    let (mut curvature, mut gradient) = (DMatrix::zeros(N, N), DVector::zeros(N));
    for (row, sample) in rows.iter().zip(samples.iter()) {
        for i in 0..N {
            gradient[i] += row[i] * sample.residual;
            for j in 0..N {
                curvature[(i, j)] += row[i] * row[j];
            }
        }
    }
    let Some(solution) = solve(curvature, &gradient) else { return };
    for (row, sample) in rows.iter().zip(samples) {
        sample.residual -= row.iter().zip(&solution).map(|(value, factor)| value * factor).sum::<f64>();
    }
}

/// Solution of normal equations; parameters without influence remain zero.
#[must_use]
pub fn solve(mut curvature: DMatrix<f64>, gradient: &DVector<f64>) -> Option<DVector<f64>> {
    for i in 0..gradient.len() {
        curvature[(i, i)] += 1e-9 * curvature[(i, i)] + 1e-12;
    }
    curvature.cholesky().map(|factors| factors.solve(gradient))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// 6000 samples in three folds, each of which moves back and forth over 150 mm.
    pub fn moved(residual: impl Fn(f64, f64) -> f64) -> Vec<Sample> {
        let noise = |i: u32| 0.1 * libm::sin(f64::from(i) * 12.9898);
        let sample = |i: u32| {
            let angle = f64::from(i) * std::f64::consts::TAU / 1000.0;
            let (position_mm, direction) = (75.0 * libm::sin(angle), 1.0f64.copysign(libm::cos(angle)));
            let residual = residual(position_mm, direction) + noise(i);
            Sample { position_mm, direction, residual, fold: (i / 2000) as usize }
        };
        (0..6000).map(sample).collect()
    }
}
