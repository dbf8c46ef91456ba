//! Correction of derivatives by the residuals of a step, which needs no further simulation.
//!
//! C. G. Broyden, "A class of methods for solving nonlinear simultaneous equations", Math. Comp. 19, 1965: the columns J change
//! by (Δr − J·s)·sᵀ/(s·s), so that they explain the change Δr of the residuals over the step s, and remain as they are in all
//! directions perpendicular to it.

use std::sync::Arc;

use nalgebra::DVector;

use super::fit_data::ResidualSeries;
use super::normal_equations::Column;

/// Corrects the columns by a step and the residuals before and after it. `units` contains the unit of each parameter, in which
/// steps are compared, as parameters have different dimensions.
pub fn update(
    columns: &mut [Column],
    step: &DVector<f64>,
    units: &[f64],
    [before, after]: [&[ResidualSeries]; 2],
) {
    let scaled: Vec<f64> = step.iter().zip(units).map(|(step, unit)| step / unit).collect();
    let squares: f64 = scaled.iter().map(|s| s * s).sum();
    if squares == 0.0 {
        return;
    }
    let unexplained: Vec<Vec<f64>> = (0..after.len())
        .map(|series| unexplained(columns, step, [&before[series], &after[series]], series))
        .collect();
    for ((column, scaled), unit) in
        columns.iter_mut().zip(&scaled).zip(units).filter(|((_, s), _)| **s != 0.0)
    {
        let weight = scaled / (squares * unit);
        for (series, unexplained) in Arc::make_mut(column).iter_mut().zip(&unexplained) {
            for (slope, unexplained) in series.values.iter_mut().zip(unexplained) {
                *slope += weight * unexplained;
            }
        }
    }
}

/// Δr − J·s of one series of the residuals.
fn unexplained(
    columns: &[Column],
    step: &DVector<f64>,
    [before, after]: [&ResidualSeries; 2],
    series: usize,
) -> Vec<f64> {
    let mut rest: Vec<f64> =
        after.values.iter().zip(&before.values).map(|(after, before)| after - before).collect();
    for (column, step) in columns.iter().zip(step.iter()).filter(|(_, step)| **step != 0.0) {
        for (value, slope) in rest.iter_mut().zip(&column[series].values) {
            *value -= slope * step;
        }
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::Stage;

    fn series(values: [f64; 3]) -> Vec<ResidualSeries> {
        vec![ResidualSeries { stage: Stage::Table, log: 0, values: values.to_vec() }]
    }

    /// J·s of the updated columns.
    fn change(columns: &[Column], step: [f64; 2]) -> Vec<f64> {
        (0..3)
            .map(|i| columns.iter().zip(step).map(|(column, step)| column[0].values[i] * step).sum())
            .collect()
    }

    #[test]
    fn the_columns_explain_the_step_and_do_not_change_across_it() {
        let units = [0.5, 2.0];
        let step = [1.0, -4.0];
        let mut columns: Vec<Column> =
            [[1.0, 2.0, 3.0], [0.5, -1.0, 4.0]].map(|values| Arc::new(series(values))).to_vec();
        // Perpendicular to the step in units of the parameters: (1/0.5, −4/2)·(u/0.5, w/2) = 0 for w = 4·u.
        let across = [1.0, 4.0];
        let before_across = change(&columns, across);
        let (before, after) = (series([10.0, 20.0, 30.0]), series([11.0, 27.0, 16.5]));
        update(&mut columns, &DVector::from_row_slice(&step), &units, [&before, &after]);
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(close(&change(&columns, step), &[1.0, 7.0, -13.5]), "{columns:?}");
        assert!(close(&change(&columns, across), &before_across), "{columns:?}");
    }

    #[test]
    fn no_step_changes_nothing() {
        let mut columns: Vec<Column> = vec![Arc::new(series([1.0, 2.0, 3.0]))];
        let old = columns.clone();
        let rest = series([0.0; 3]);
        update(&mut columns, &DVector::from_row_slice(&[0.0]), &[1.0], [&rest, &rest]);
        assert_eq!(columns, old);
    }
}
