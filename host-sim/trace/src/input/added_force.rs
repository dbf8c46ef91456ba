//! A known force that was added to the controller's output, such as a test signal.
//!
//! The drive applies the limited sum of the controller's force and the added force. The logged force is this sum, so that
//! the output of the velocity loop is the difference. Like the logged force, the added force of a row is that of the interval
//! that ends at the sample: the force that acts after a sample is in the next row.

use super::smoothing::Smooth;
use model::effects::{Channel, Effect, Timing};

/// The added force of one axis of one log, N (rotary axes: N·m).
#[derive(Clone, Debug)]
pub struct AddedForce {
    logged: Smooth,
}

impl AddedForce {
    /// Filters the logged values like the force, with a window of this half width in samples.
    #[must_use]
    pub fn new(logged_n: Vec<f64>, sample_s: f64, half_window: usize) -> Self {
        Self { logged: Smooth::new(logged_n, sample_s, half_window) }
    }

    /// The logged force after the filter, N.
    #[must_use]
    pub fn filtered_n(&self) -> &[f64] {
        &self.logged.value
    }

    /// The force from each sample to the next, N. As the added force is part of the logged force, a `latency` of the force
    /// applies to it as well, rounded to whole samples.
    #[must_use]
    pub fn from_sample_n(&self, effects: &[Effect], sample_s: f64) -> Vec<f64> {
        let late_ms = effects.iter().map(|effect| match effect.timing() {
            Some(Timing::Reading { channel: Channel::Force, late_ms }) => late_ms,
            _ => 0.0,
        });
        let late = (1e-3 * late_ms.sum::<f64>() / sample_s).round();
        #[expect(clippy::cast_possible_truncation, reason = "a latency of at most a second in samples")]
        let offset = 1 + late as isize;
        let raw = &self.logged.raw;
        let at = |i: usize| i.checked_add_signed(offset).and_then(|row| raw.get(row)).copied();
        // Before the first and after the last row, the added force is unknown and taken as zero.
        (0..raw.len()).map(|i| at(i).unwrap_or(0.0)).collect()
    }
}
