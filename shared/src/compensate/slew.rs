//! What makes any correction bounded and bumpless: it goes to its target no faster than a declared rate, and
//! no further than a declared bound.

use crate::config::ConfigError;
use crate::scalar::Scalar;

/// Bound and rate.
#[derive(Clone, Copy, Debug)]
pub struct Slew<S: Scalar> {
    /// Greatest value either way.
    pub bound: S,
    /// Greatest change in a tick.
    pub per_tick: S,
}

impl<S: Scalar> Slew<S> {
    /// A rate per second as a step of `rate/unit` a tick, refused where the format does not hold it to 1 %.
    ///
    /// # Errors
    /// [`ConfigError::OutOfRange`] with the range of the rate.
    pub fn per_tick(name: &'static str, rate: f64, unit: f64) -> Result<S, ConfigError> {
        let (exact, step) = (rate / unit, S::signal(rate / unit));
        if (step.value() - exact).abs() <= 0.01 * exact && exact < S::SIGNAL_LIMIT {
            return Ok(step);
        }
        let min = 50.0 * S::SIGNAL_STEP * unit;
        Err(ConfigError::OutOfRange { name, min, max: S::SIGNAL_LIMIT * unit })
    }

    /// One tick towards a target. A target that is no number stops where it is.
    pub fn step(&self, value: &mut S, target: S) -> S {
        let step = (target.clamp_magnitude(self.bound) - *value).clamp_magnitude(self.per_tick);
        if !step.exceeds(self.per_tick) {
            *value = *value + step;
        }
        *value
    }
}
