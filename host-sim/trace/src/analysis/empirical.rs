//! An unexplained residual as a table over the variable that explains most of it.
//!
//! A table is not a physical model: it is valid only for similar motions. It is accepted if the table computed from two thirds
//! of the logs lowers the residual of the remaining third, for each third.

use super::variable::{Variable, values};
use crate::fit::fit_data::{FitAndValidationRms, FitData, ResidualSeries};
use crate::fit::normal_equations::FOLDS;
use model::effects::Stage;
use model::residual_table::{ResidualTable, TableChannel, between};

/// Number of evenly spaced points of a table.
const POINTS: usize = 32;

/// An unexplained residual as a function of a variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Empirical {
    /// Stage.
    pub stage: Stage,
    /// Axis.
    pub axis: String,
    /// The variable: mm, m/s, m/s², N, or −1 to 1 for the direction.
    pub variable: Variable,
    /// Variable and residual (µm or N), sorted by the variable; linear in between.
    pub table: Vec<[f64; 2]>,
    /// Whether the table is part of the model: it also lowers the residual of the validation logs.
    pub is_confirmed: bool,
    /// Rms without the table, µm or N.
    pub before: FitAndValidationRms,
    /// Rms with the table; for the fit logs, each third with the table of the other two.
    pub after: FitAndValidationRms,
}

/// One sample of a residual.
#[derive(Clone, Copy)]
struct Sample {
    variable: f64,
    residual: f64,
    fold: usize,
}

/// The table of a stage's residual, if held-out data support it.
#[must_use]
pub fn empirical(
    [fit, validate]: [&FitData<'_>; 2],
    [of_fit, of_validation]: [&[ResidualSeries]; 2],
    stage: Stage,
    variable: Variable,
) -> Option<Empirical> {
    let fitted = samples(fit, of_fit, stage, variable)?;
    let held_out = samples(validate, of_validation, stage, variable)?;
    let min_samples = fit.options.analysis.min_table_samples;
    let of_fold = |fold: usize| {
        let table = table(fitted.iter().filter(|sample| sample.fold != fold), min_samples);
        let own = || fitted.iter().filter(move |sample| sample.fold == fold);
        [squares(own(), &[]), squares(own(), &table)]
    };
    let folds: Vec<[f64; 2]> = (0..FOLDS).map(of_fold).collect();
    let [before, after] = [0, 1].map(|which| folds.iter().map(|fold| fold[which]).sum::<f64>());
    let is_better = folds.iter().all(|[before, after]| after < before);
    if !is_better || after > (1.0 - fit.options.search.min_reduction) * before {
        return None;
    }
    let table = table(fitted.iter(), min_samples);
    let rms = |squares: f64, of: &[Sample]| (squares / of.len().max(1) as f64).sqrt();
    let [held_out_before, held_out_after] = [&[][..], &table].map(|table| squares(held_out.iter(), table));
    Some(Empirical {
        stage,
        axis: fit.name().to_owned(),
        variable,
        before: FitAndValidationRms { fit: rms(before, &fitted), validate: rms(held_out_before, &held_out) },
        after: FitAndValidationRms { fit: rms(after, &fitted), validate: rms(held_out_after, &held_out) },
        is_confirmed: held_out_after < held_out_before,
        table,
    })
}

impl Empirical {
    /// The table for the model; `None` if the validation logs do not confirm it.
    #[must_use]
    pub fn confirmed(&self) -> Option<ResidualTable> {
        let variable = self.variable.of_table().filter(|_| self.is_confirmed && self.table.len() > 1)?;
        Some(ResidualTable::new(TableChannel::of(self.stage), variable, &self.table))
    }
}

/// All samples of a stage that count; `None` if the variable was not measured.
fn samples(
    data: &FitData<'_>,
    residuals: &[ResidualSeries],
    stage: Stage,
    variable: Variable,
) -> Option<Vec<Sample>> {
    let mut all = Vec::new();
    for series in residuals.iter().filter(|series| series.stage == stage) {
        let n = series.values.len().max(1);
        let of = values(data, series.log, variable)?;
        let counts = data.counting(stage, series.log);
        let counted = (0..series.values.len()).filter(|&i| counts(i));
        all.extend(counted.map(|i| Sample {
            variable: of[i],
            residual: series.values[i],
            fold: i * FOLDS / n,
        }));
    }
    (!all.is_empty()).then_some(all)
}

/// Mean residual at evenly spaced points. Each sample is distributed linearly to the two nearest points. Points with a total
/// weight below `min_samples` are left out.
fn table<'a>(samples: impl Iterator<Item = &'a Sample> + Clone, min_samples: usize) -> Vec<[f64; 2]> {
    let [min, max] = numerics::min_max(samples.clone().map(|s| s.variable));
    let width = (max - min) / (POINTS - 1) as f64;
    if !width.is_finite() || width <= 0.0 {
        return Vec::new();
    }
    let mut sums = [[0.0; 2]; POINTS];
    for sample in samples {
        let at = (sample.variable - min) / width;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to POINTS")]
        let point = (at as usize).min(POINTS - 2);
        let fraction = at - point as f64;
        for (point, weight) in [(point, 1.0 - fraction), (point + 1, fraction)] {
            sums[point][0] += weight;
            sums[point][1] += weight * sample.residual;
        }
    }
    let used = sums.iter().enumerate().filter(|(_, [weight, _])| *weight >= min_samples as f64);
    used.map(|(i, [weight, sum])| [min + i as f64 * width, sum / weight]).collect()
}

/// Σ (residual − table)².
fn squares<'a>(samples: impl Iterator<Item = &'a Sample>, table: &[[f64; 2]]) -> f64 {
    samples.map(|sample| (sample.residual - at(table, sample.variable)).powi(2)).sum()
}

/// The table at a value: linear between its points, constant beyond them.
fn at(table: &[[f64; 2]], value: f64) -> f64 {
    let above = table.partition_point(|[x, _]| *x < value);
    between(above.checked_sub(1).map(|i| table[i]), table.get(above).copied(), value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(i: u32, residual: impl Fn(f64) -> f64) -> Sample {
        // Over ±50 mm seven times, in three consecutive folds.
        let mm = 50.0 * (f64::from(i) * 0.044).sin();
        Sample { variable: mm, residual: residual(mm), fold: (i / 334) as usize }
    }

    #[test]
    fn a_table_reproduces_a_smooth_curve() {
        let curve = |mm: f64| 2.0 * (-(mm / 15.0).powi(2)).exp();
        let samples: Vec<Sample> = (0..1000).map(|i| sample(i, curve)).collect();
        let table = table(samples.iter(), 8);
        // The points are 3.2 mm apart. The error of linear interpolation at the top is the curvature 2·2/15² times 3.2²/8,
        // 0.023; averaging over the samples of a point adds the same amount.
        for mm in [-40.0, -10.0, 0.0, 3.0, 25.0] {
            assert!((at(&table, mm) - curve(mm)).abs() < 0.06, "{mm}: {} {}", at(&table, mm), curve(mm));
        }
        let ratio = squares(samples.iter(), &table) / squares(samples.iter(), &[]);
        assert!((1e-6..1e-2).contains(&ratio), "{ratio}");
    }

    #[test]
    fn beyond_its_ends_a_table_is_constant() {
        let table = [[0.0, 1.0], [10.0, 3.0]];
        assert!(
            [(-5.0, 1.0), (5.0, 2.0), (25.0, 3.0)].iter().all(|(x, y)| (at(&table, *x) - y).abs() < 1e-12)
        );
    }
}
