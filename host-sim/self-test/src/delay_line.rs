//! A signal delayed by a fixed time, as fine as the steps of the plant.

use super::plant::STEP_S;

/// A signal delayed by a fixed time, interpolated linearly between the steps.
pub(super) struct DelayLine {
    /// The last values as a ring, the newest at `newest`.
    past: Vec<f64>,
    newest: usize,
    whole_steps: usize,
    fraction: f64,
}

impl DelayLine {
    /// At rest at `start`.
    pub(super) fn new(delay_s: f64, start: f64) -> Self {
        let steps = delay_s / STEP_S;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some ms, not negative")]
        let whole_steps = steps.floor() as usize;
        Self { past: vec![start; whole_steps + 2], newest: 0, whole_steps, fraction: steps.fract() }
    }

    /// The value after a further step of the plant.
    pub(super) fn push(&mut self, value: f64) {
        self.newest = (self.newest + 1) % self.past.len();
        self.past[self.newest] = value;
    }

    /// The delayed value.
    pub(super) fn value(&self) -> f64 {
        let length = self.past.len();
        let back = |steps: usize| self.past[(self.newest + length - steps) % length];
        (1.0 - self.fraction) * back(self.whole_steps) + self.fraction * back(self.whole_steps + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delayed_signal_has_its_earlier_value() {
        // A ramp of 1 per step, delayed by 2.4 steps.
        let mut delayed = DelayLine::new(2.4 * STEP_S, 0.0);
        (1..=10).for_each(|i| delayed.push(f64::from(i)));
        assert!((delayed.value() - 7.6).abs() < 1e-9, "{}", delayed.value());
        let mut undelayed = DelayLine::new(0.0, 0.0);
        undelayed.push(3.0);
        assert_eq!(undelayed.value().to_bits(), 3.0_f64.to_bits());
    }
}
