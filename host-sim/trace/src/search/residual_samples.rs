//! The residual of a driven stage over the motion of its motor, without its linear dependence on the motion.

use nalgebra::{DMatrix, DVector};

use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::normal_equations::{BLOCKS, FOLDS};
use crate::input::smoothing::Smooth;
use model::effects::Stage;

/// A sample of a residual.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Position of the motor, or of the axis over which the residual is taken, mm.
    pub position_mm: f64,
    /// Direction of motion, −1 or 1.
    pub direction: f64,
    /// Velocity of that axis, m/s.
    pub velocity: f64,
    /// Its acceleration, m/s².
    pub acceleration: f64,
    /// Residual without its dependence on velocity, acceleration and direction, and without a line, µm or N; times a factor f.
    pub residual: f64,
    /// f², so that Σ residual / Σ weight is the best coefficient of f in the residual.
    pub weight: f64,
    /// Fold of the cross-validation. Blocks alternate, unlike those of [`super::held_out`]: a map can predict only positions
    /// that the fitted data contain, and a log may visit the ends of its travel once.
    pub fold: usize,
}

impl Sample {
    /// The sample with its residual as a multiple of a factor.
    #[must_use]
    pub fn as_multiple_of(&self, factor: f64) -> Self {
        Self { residual: factor * self.residual, weight: factor * factor * self.weight, ..*self }
    }
}

/// The samples of a stage that count.
#[must_use]
pub fn samples(data: &FitData<'_>, residuals: &[ResidualSeries], stage: Stage) -> Vec<Sample> {
    let motor = |log: usize| data.signals(log).motor.as_ref();
    gathered(data, residuals, stage, motor, |_, motor, i| {
        let velocity = motor.velocity[i];
        [1.0, 1e3 * motor.value[i], 1.0f64.copysign(velocity), velocity, motor.acceleration[i]]
    })
}

/// The samples of the tool stage that count, over position and direction of any axis; without a linear dependence on position, velocity and
/// acceleration of that axis and of the axis that is traced.
#[must_use]
pub fn samples_over(data: &FitData<'_>, residuals: &[ResidualSeries], axis: usize) -> Vec<Sample> {
    let of_axis = |log: usize, axis: usize| data.logs[log].axes[axis].table_or_motor();
    let state =
        |smooth: &Smooth, i: usize| [1e3 * smooth.value[i], smooth.velocity[i], smooth.acceleration[i]];
    gathered(
        data,
        residuals,
        Stage::Tool,
        |log| of_axis(log, axis),
        |log, source, i| {
            let [a, b, c] = state(source, i);
            let [d, e, f] = of_axis(log, data.axis).map_or([0.0; 3], |own| state(own, i));
            [1.0, a, b, c, d, e, f]
        },
    )
}

/// The samples of a stage that count over a motion, without their linear dependence on the columns of a row.
fn gathered<'a, const N: usize>(
    data: &FitData<'a>,
    residuals: &[ResidualSeries],
    stage: Stage,
    motion: impl Fn(usize) -> Option<&'a Smooth>,
    row: impl Fn(usize, &Smooth, usize) -> [f64; N],
) -> Vec<Sample> {
    let mut rows = Vec::new();
    let mut samples = Vec::new();
    for series in residuals.iter().filter(|series| series.stage == stage) {
        let Some(motion) = motion(series.log) else { continue };
        let counts = data.counting(stage, series.log);
        let fold_of = |i: usize| i * BLOCKS / series.values.len() % FOLDS;
        for i in (0..series.values.len()).filter(|&i| counts(i)) {
            rows.push(row(series.log, motion, i));
            samples.push(Sample {
                position_mm: 1e3 * motion.value[i],
                direction: 1.0f64.copysign(motion.velocity[i]),
                velocity: motion.velocity[i],
                acceleration: motion.acceleration[i],
                residual: series.values[i],
                weight: 1.0,
                fold: fold_of(i),
            });
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
            let [velocity, acceleration] = [0.1 * libm::cos(angle), -libm::sin(angle)];
            Sample {
                position_mm,
                direction,
                velocity,
                acceleration,
                residual,
                weight: 1.0,
                fold: (i / 2000) as usize,
            }
        };
        (0..6000).map(sample).collect()
    }
}
