//! Samples that a fault spoils, excluded from the residuals.

use crate::input::signals::Signals;
use model::effects::Stage;

/// A stretch of a log that is excluded from stages of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Excluded {
    /// Source of the log.
    pub log: String,
    /// Name of the axis.
    pub axis: String,
    /// The stages.
    pub stages: &'static [Stage],
    /// Start on the session's clock, s.
    pub from_s: f64,
    /// End on the session's clock, s.
    pub to_s: f64,
}

/// Sets [`AxisSignals::faulty`](crate::input::signals::AxisSignals::faulty) in the samples that are excluded. `names` are
/// the axes of the machine.
pub fn mark(excluded: &[Excluded], names: &[String], logs: &mut [Signals]) {
    for stretch in excluded {
        let Some(axis) = names.iter().position(|name| *name == stretch.axis) else { continue };
        for log in logs.iter_mut().filter(|log| log.source == stretch.log) {
            let count = log.len();
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "0 to the length of the log"
            )]
            let sample = |time_s: f64| {
                ((time_s - log.start_s) / log.sample_s).ceil().clamp(0.0, count as f64) as usize
            };
            let samples = sample(stretch.from_s)..sample(stretch.to_s);
            if samples.is_empty() {
                continue;
            }
            for &stage in stretch.stages {
                log.axes[axis].mark_faulty(stage, samples.clone(), count);
            }
        }
    }
}
