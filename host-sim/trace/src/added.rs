//! A known force that was added to the controller's output, so that the machine answers to it.
//!
//! The drive is given the controller's force and this one, both within its limit, and the log's force is their sum: the
//! velocity loop's own output is the difference. Like the force it is that of the interval that ends at the sample, so
//! what acts behind a sample stands in the row after it.

use super::signals::Smooth;
use model::effects::{Channel, Effect};

/// The added force of one axis of one log, N (rotary axes: N·m).
#[derive(Clone, Debug)]
pub struct AddedForce {
    logged: Smooth,
}

impl AddedForce {
    /// As logged, with the filter (`half` samples to either side) that the force passes.
    #[must_use]
    pub fn new(logged_n: Vec<f64>, sample_s: f64, half: usize) -> Self {
        Self { logged: Smooth::new(logged_n, sample_s, half) }
    }

    /// As logged and filtered, N.
    #[must_use]
    pub fn filtered_n(&self) -> &[f64] {
        &self.logged.position
    }

    /// From each sample to the next, N. A log whose force is late or early by whole samples has this one late or early,
    /// too, as it is a part of it.
    #[must_use]
    pub fn from_sample_n(&self, effects: &[Effect], sample_s: f64) -> Vec<f64> {
        let late_ms = effects.iter().map(|effect| match effect {
            Effect::Latency(late) if late.channel == Channel::Force => late.ms,
            _ => 0.0,
        });
        let late = (1e-3 * late_ms.sum::<f64>() / sample_s).round();
        #[expect(clippy::cast_possible_truncation, reason = "a latency of at most a second in samples")]
        let row_behind = 1 + late as isize;
        let raw = &self.logged.raw;
        let at = |i: usize| i.checked_add_signed(row_behind).and_then(|row| raw.get(row)).copied();
        // What was added before the first row and behind the last is not known.
        (0..raw.len()).map(|i| at(i).unwrap_or(0.0)).collect()
    }
}
