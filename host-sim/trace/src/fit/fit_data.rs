//! The data of a fit or a validation: logs, exclusions, and the error to be subtracted.

use serde::Serialize;
use shared::config::Rates;

use super::axis_model::AxisModel;
use super::exclusion::Exclusion;
use crate::input::signals::{AxisSignals, Signals};
use crate::options::TraceOptions;
use model::effects::Stage;

/// The logs of a fit or of a validation, for one axis.
#[derive(Clone, Copy, Debug)]
pub struct FitData<'a> {
    /// The logs.
    pub logs: &'a [Signals],
    /// Names of the machine's axes.
    pub names: &'a [String],
    /// Index of the axis.
    pub axis: usize,
    /// Rates of the loops.
    pub rates: Rates,
    /// Parts of the residuals that are excluded because no effect describes them.
    pub exclusions: &'a [Exclusion],
    /// Error of the tracer's own simulation, subtracted from the residuals: see [`super::model_bias`].
    pub bias: &'a [ResidualSeries],
    /// Models of all axes, for those that excite the tool of this one: the declared ones, after the search those found; empty: not known.
    pub axes: &'a [AxisModel],
    /// The thresholds of the trace.
    pub options: &'a TraceOptions,
}

/// The residual of one stage over one log, sample by sample.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualSeries {
    /// Stage.
    pub stage: Stage,
    /// Index of the log.
    pub log: usize,
    /// µm, or N for the force stage. Samples that do not count are zero.
    pub values: Vec<f64>,
}

/// Rms of a residual on the logs that were fitted and on those that were held out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FitAndValidationRms {
    /// Fit logs.
    pub fit: f64,
    /// Validation logs.
    pub validate: f64,
}

impl<'a> FitData<'a> {
    /// The logs for one axis, without exclusions.
    #[must_use]
    pub const fn new(
        logs: &'a [Signals],
        names: &'a [String],
        axis: usize,
        rates: Rates,
        options: &'a TraceOptions,
    ) -> Self {
        Self { logs, names, axis, rates, exclusions: &[], bias: &[], axes: &[], options }
    }

    /// Name of the axis.
    #[must_use]
    pub fn name(&self) -> &'a str {
        &self.names[self.axis]
    }

    /// Signals of the axis in a log.
    #[must_use]
    pub fn signals(&self, log: usize) -> &'a AxisSignals {
        &self.logs[log].axes[self.axis]
    }

    /// Whether a log contains the channels of a stage: the measured one, and the one that drives the prediction. Otherwise the
    /// residual of the stage over this log has no samples.
    #[must_use]
    pub fn has(&self, stage: Stage, log: usize) -> bool {
        let signals = self.signals(log);
        match stage {
            Stage::Motor => signals.command.is_some() && signals.motor.is_some(),
            Stage::Table => signals.motor.is_some() && signals.table.is_some(),
            Stage::Tool => signals.tool.is_some() && signals.table_or_motor().is_some(),
            Stage::Force => signals.motor.is_some() && signals.force.is_some(),
        }
    }

    /// The logs that contain the channels of a stage.
    pub fn logs_with(&self, stage: Stage) -> impl Iterator<Item = usize> {
        (0..self.logs.len()).filter(move |&log| self.has(stage, log))
    }

    /// Least and greatest position of the table, or of the motor without a table channel, mm.
    #[must_use]
    pub fn travel_mm(&self) -> [f64; 2] {
        let positions = (0..self.logs.len()).filter_map(|log| self.signals(log).table_or_motor());
        let positions = positions.flat_map(|smooth| smooth.value.iter().map(|m| 1e3 * m));
        numerics::min_max(positions)
    }

    /// Number of samples at the start of a log that are excluded from all residuals.
    #[must_use]
    pub fn settling(&self, log: usize) -> usize {
        let log = &self.logs[log];
        if log.lead_in > 0 {
            return log.lead_in.min(log.len());
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0.3 s of samples")]
        let samples = (self.options.samples.settling_s / log.sample_s) as usize;
        samples.min(log.len() / 4)
    }

    /// Smallest number of samples of a block of a log.
    #[must_use]
    pub fn shortest_block(&self, log: usize) -> usize {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a fraction of a second of samples"
        )]
        let samples = (self.options.search.min_block_s / self.logs[log].sample_s).round() as usize;
        samples.max(1)
    }

    /// Whether a sample of a stage of a log counts. Samples count after the settling, outside exclusions; in the table and
    /// force stages, which depend on friction, only in motion; in the force stage only below the force limit. Samples that a
    /// fault of the data spoils do not count.
    pub fn counting(&self, stage: Stage, log: usize) -> impl Fn(usize) -> bool {
        let signals = self.signals(log);
        let depends_on_friction = match stage {
            Stage::Table | Stage::Force => true,
            Stage::Tool => signals.table.is_none() && signals.motor.is_some(),
            Stage::Motor => false,
        };
        let end = self.logs[log].len().saturating_sub(self.logs[log].lead_out);
        let settling = self.settling(log).max(if depends_on_friction { signals.sliding_from } else { 0 });
        let standstill = if depends_on_friction { &signals.standstill[..] } else { &[] };
        let saturated = if stage == Stage::Force { &signals.saturated[..] } else { &[] };
        let faulty = signals.faulty(stage);
        let is = |flags: &[bool], sample: usize| flags.get(sample).copied().unwrap_or(false);
        let position_mm = move |sample: usize| {
            signals.table_or_motor().and_then(|signal| signal.value.get(sample)).map(|m| 1e3 * m)
        };
        let is_excluded = move |sample: usize| {
            self.exclusions.iter().any(|exclusion| exclusion.covers(stage, || position_mm(sample)))
        };
        move |sample| {
            (settling..end).contains(&sample)
                && !is(standstill, sample)
                && !is(saturated, sample)
                && !is(faulty, sample)
                && !is_excluded(sample)
        }
    }

    /// Root mean square of a stage's residuals over all samples that count; NaN if there are none.
    #[must_use]
    pub fn rms(&self, residuals: &[ResidualSeries], stage: Stage) -> f64 {
        let (mut squares, mut count) = (0.0, 0usize);
        for series in residuals.iter().filter(|series| series.stage == stage) {
            squares += series.values.iter().map(|r| r * r).sum::<f64>();
            let counts = self.counting(stage, series.log);
            count += (0..series.values.len()).filter(|&i| counts(i)).count();
        }
        if count == 0 { f64::NAN } else { (squares / count as f64).sqrt() }
    }
}
