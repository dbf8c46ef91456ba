//! Subtraction of a local defect from the residuals of a stage.

use super::exclusion::Bump;
use super::fit_data::{FitData, ResidualSeries};
use model::effects::Stage;

/// A bump over the position that is subtracted from a stage.
pub struct BumpSubtraction<'a> {
    /// The logs.
    pub data: &'a FitData<'a>,
    /// The stage.
    pub stage: Stage,
    /// The bump.
    pub bump: Bump,
    /// Whether the means of logs with an own zero are subtracted from their residuals.
    pub has_means_subtracted: bool,
}

impl BumpSubtraction<'_> {
    /// Subtracts the bump with its least-squares height from all samples that count, less its mean over all of them, so that the
    /// zero of the sensor, a parameter of the model, stays the same.
    pub fn subtract_from(&self, residuals: &mut [ResidualSeries]) {
        let of_stage = || residuals.iter().enumerate().filter(|(_, series)| series.stage == self.stage);
        let shapes: Vec<(usize, Vec<Option<f64>>)> =
            of_stage().map(|(index, series)| (index, self.shape(series))).collect();
        let pairs = || {
            shapes.iter().flat_map(|(index, shape)| {
                let samples = shape.iter().zip(&residuals[*index].values);
                samples.filter_map(|(shape, value)| Some(((*shape)?, *value)))
            })
        };
        let count = pairs().count() as f64;
        let (shape_sum, value_sum) =
            pairs().fold((0.0, 0.0), |(a, b), (shape, value)| (a + shape, b + value));
        let (shape_mean, value_mean) = (shape_sum / count, value_sum / count);
        let (squares, products) = pairs().fold((0.0, 0.0), |(a, b), (shape, value)| {
            (a + (shape - shape_mean).powi(2), b + (shape - shape_mean) * (value - value_mean))
        });
        // Logs that do not pass the place of the bump have nothing to subtract.
        if count == 0.0 || squares < 1e-9 * count {
            return;
        }
        let height = products / squares;
        for (index, shape) in &shapes {
            for (value, shape) in residuals[*index].values.iter_mut().zip(shape) {
                *value -= shape.map_or(0.0, |shape| height * (shape - shape_mean));
            }
        }
    }

    /// The bump at each sample, less its mean if that of the log is subtracted; `None` at samples that do not count or have no
    /// position.
    fn shape(&self, series: &ResidualSeries) -> Vec<Option<f64>> {
        let counts = self.data.counting(series.stage, series.log);
        let signals = &self.data.logs[series.log].axes[self.data.axis];
        let position = signals.table_or_motor().map_or(&[][..], |signal| &signal.value);
        let at =
            |sample: usize| position.get(sample).filter(|_| counts(sample)).map(|m| self.bump.at(1e3 * m));
        let shape: Vec<Option<f64>> = (0..series.values.len()).map(at).collect();
        if !(self.has_means_subtracted && self.data.logs[series.log].has_own_zero) {
            return shape;
        }
        let mean = numerics::mean(shape.iter().flatten().copied());
        shape.into_iter().map(|at| at.map(|at| at - mean)).collect()
    }
}
