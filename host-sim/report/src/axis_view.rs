//! The plotted residuals: those of an axis on the validation logs, before and after the search.

use model::effects::Stage;
use trace::AxisIdentification;
use trace::Identification;
use trace::fit::axis_model::AxisModel;
use trace::fit::fit_data::{FitData, ResidualSeries};
use trace::judge::StageResidual;

/// An axis with its residuals on the validation logs.
pub struct AxisView<'a> {
    /// The result of the trace.
    pub trace: &'a AxisIdentification,
    /// The validation logs.
    pub data: FitData<'a>,
    /// Residuals of the declared model, fitted within its tolerance.
    pub before: Vec<ResidualSeries>,
    /// Residuals of the model with the effects found.
    pub after: Vec<ResidualSeries>,
}

impl<'a> AxisView<'a> {
    /// One for each axis of a trace.
    pub fn all(trace: &'a Identification) -> Vec<Self> {
        let of_axis = |(index, axis): (usize, &'a AxisIdentification)| {
            let data = FitData { bias: &axis.bias, ..trace.data(trace.validate_logs(), index) };
            let residuals = |model: &AxisModel| {
                axis.scopes.iter().flat_map(|scope| data.residuals(model, scope)).collect()
            };
            let (before, after) = (residuals(&axis.baseline), residuals(&axis.model));
            Self { trace: axis, data, before, after }
        };
        trace.axes().iter().enumerate().map(of_axis).collect()
    }

    /// The validation log on which the residual of a stage is largest before.
    pub fn log_with_largest_residual(&self, stage: Stage) -> Option<usize> {
        let error = |series: &ResidualSeries| self.data.rms(std::slice::from_ref(series), stage);
        let of_stage = self.before.iter().filter(|series| series.stage == stage && !series.values.is_empty());
        // Reversed, as `max_by` takes the last of equal ones: of equal logs, the first counts.
        of_stage.rev().max_by(|a, b| error(a).total_cmp(&error(b))).map(|series| series.log)
    }

    /// Samples of the residual of a stage over one log after settling, and the number of samples skipped before.
    pub fn settled<'p>(&self, all: &'p [ResidualSeries], stage: Stage, log: usize) -> (usize, &'p [f64]) {
        let values = series(all, stage, log).map_or(&[][..], |series| &series.values);
        let settling = self.data.settling(log).min(values.len());
        (settling, &values[settling..])
    }

    /// Whether the effects found change the rms residual of a stage by more than 1 %.
    pub fn is_changed(&self, stage: Stage) -> bool {
        let [before, after] = [&self.before, &self.after].map(|all| self.data.rms(all, stage));
        (after - before).abs() > 0.01 * before
    }
}

/// Whether what remains of a stage is the noise of the sensors.
pub fn is_at_noise(axis: &AxisIdentification, error: &StageResidual) -> bool {
    /// Largest residual that counts as noise, in multiples of the noise's rms.
    const MAX_NOISE_MULTIPLE: f64 = 1.5;
    let is_noise = error.after.validate <= MAX_NOISE_MULTIPLE * error.noise;
    is_noise && !axis.unexplained.iter().any(|entry| entry.stage == error.stage)
}

/// The residual of a stage over one log.
pub fn series(all: &[ResidualSeries], stage: Stage, log: usize) -> Option<&ResidualSeries> {
    all.iter().find(|series| series.stage == stage && series.log == log)
}
