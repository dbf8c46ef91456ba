//! A known force that was added to the controller's output, such as a test signal.
//!
//! The drive applies the sum of the controller's force and this one, limited together. The log's force is that sum, so
//! the output of the velocity loop is the difference. Like the force, it is that of the interval that ends at the sample:
//! what acts from a sample to the next is in the row of the next.

use super::smoothing::Smooth;
use model::effects::{Channel, Effect};

/// The added force of one axis of one log, N (rotary axes: N·m).
#[derive(Clone, Debug)]
pub struct AddedForce {
    logged: Smooth,
}

impl AddedForce {
    /// Of the logged values, with the filter (half width in samples) of the force.
    #[must_use]
    pub fn new(logged_n: Vec<f64>, sample_s: f64, half_window: usize) -> Self {
        Self { logged: Smooth::new(logged_n, sample_s, half_window) }
    }

    /// As logged and filtered, N.
    #[must_use]
    pub fn filtered_n(&self) -> &[f64] {
        &self.logged.position
    }

    /// From each sample to the next, N. A `latency` of the force among the effects, in whole samples, applies to it, too,
    /// as it is part of the logged force.
    #[must_use]
    pub fn from_sample_n(&self, effects: &[Effect], sample_s: f64) -> Vec<f64> {
        let late_ms = effects.iter().map(|effect| match effect {
            Effect::Latency(late) if late.channel == Channel::Force => late.ms,
            _ => 0.0,
        });
        let late = (1e-3 * late_ms.sum::<f64>() / sample_s).round();
        #[expect(clippy::cast_possible_truncation, reason = "a latency of at most a second in samples")]
        let offset = 1 + late as isize;
        let raw = &self.logged.raw;
        let at = |i: usize| i.checked_add_signed(offset).and_then(|row| raw.get(row)).copied();
        // Before the first and after the last row the added force is not known.
        (0..raw.len()).map(|i| at(i).unwrap_or(0.0)).collect()
    }
}
