//! Slew-rate limiter: a correction approaches its target at a limited rate and within a bound.
//!
//! # Example
//!
//! ```
//! use shared::compensate::slew::Slew;
//!
//! let slew = Slew { bound: 2.5, per_tick: 1.0 };
//! let mut value = 0.0;
//! let outputs = [100.0, 100.0, 100.0, 0.0].map(|target| slew.step(&mut value, target));
//! assert_eq!(outputs, [1.0, 2.0, 2.5, 1.5]);
//! ```

use crate::config::ConfigError;
use crate::scalar::Scalar;

/// Bound and rate.
#[derive(Clone, Copy, Debug)]
pub struct Slew<S: Scalar> {
    /// Greatest magnitude.
    pub bound: S,
    /// Greatest change per tick.
    pub per_tick: S,
}

impl<S: Scalar> Slew<S> {
    /// Stays at zero.
    pub const ZERO: Self = Self { bound: S::ZERO, per_tick: S::ZERO };

    /// A rate per second as a change of `rate/unit` per tick. Rejected if the format does not hold it to 1 %.
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

    /// One tick towards a target. A NaN leaves the value unchanged.
    pub fn step(&self, value: &mut S, target: S) -> S {
        // The usual case, in fewer instructions.
        if !target.exceeds(self.bound) && !(target - *value).exceeds(self.per_tick) {
            *value = target;
            return target;
        }
        let step = (target.clamp_magnitude(self.bound) - *value).clamp_magnitude(self.per_tick);
        // Of a NaN the order is not known.
        if step.partial_cmp(&self.per_tick).is_some() {
            *value = *value + step;
        }
        *value
    }
}
