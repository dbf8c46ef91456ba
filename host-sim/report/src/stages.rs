//! What the pictures show: residuals on the validation logs, before and after.

use model::effects::Stage;
use trace::Trace;
use trace::fit::axis_model::AxisModel;
use trace::fit::fit_data::{FitData, ResidualSeries};
use trace::outcome::AxisTrace;

/// An axis with its residuals on the validation logs.
pub struct AxisView<'a> {
    /// What was found.
    pub trace: &'a AxisTrace,
    /// The validation logs.
    pub evidence: FitData<'a>,
    /// With the declared model, fitted within its tolerance.
    pub before: Vec<ResidualSeries>,
    /// With the effects found.
    pub after: Vec<ResidualSeries>,
}

impl<'a> AxisView<'a> {
    /// One for each axis of a trace.
    pub fn all(trace: &'a Trace) -> Vec<Self> {
        let of_axis = |(index, axis): (usize, &'a AxisTrace)| {
            let evidence = FitData { bias: &axis.bias, ..trace.data(&trace.validate_logs, index) };
            let residuals = |model: &AxisModel| {
                axis.scopes.iter().flat_map(|scope| evidence.residuals(model, scope)).collect()
            };
            let (before, after) = (residuals(&axis.declared), residuals(&axis.model));
            Self { trace: axis, evidence, before, after }
        };
        trace.axes.iter().enumerate().map(of_axis).collect()
    }

    /// The validation log on which a stage's residual is largest before.
    pub fn telling_log(&self, stage: Stage) -> Option<usize> {
        let error = |part: &ResidualSeries| self.evidence.rms(std::slice::from_ref(part), stage);
        let parts = self.before.iter().filter(|part| part.stage == stage && !part.values.is_empty());
        // The first of several that are equal.
        parts.rev().max_by(|a, b| error(a).total_cmp(&error(b))).map(|part| part.log)
    }

    /// Samples that count of a stage's residual over one log, with the number of the first of them.
    pub fn settled<'p>(&self, parts: &'p [ResidualSeries], stage: Stage, log: usize) -> (usize, &'p [f64]) {
        let values = part(parts, stage, log).map_or(&[][..], |part| &part.values);
        let settling = self.evidence.settling(log).min(values.len());
        (settling, &values[settling..])
    }

    /// Whether the effects found change a stage's residual by more than a hundredth.
    pub fn is_changed(&self, stage: Stage) -> bool {
        let [before, after] = [&self.before, &self.after].map(|parts| self.evidence.rms(parts, stage));
        (after - before).abs() > 0.01 * before
    }
}

/// The residual of a stage over one log.
pub fn part(parts: &[ResidualSeries], stage: Stage, log: usize) -> Option<&ResidualSeries> {
    parts.iter().find(|part| part.stage == stage && part.log == log)
}
