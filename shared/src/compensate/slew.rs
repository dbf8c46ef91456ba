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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Fixed;

    /// Steps are 2⁻¹⁴. 50 are held to 1 % whatever the rest; one and a half are rounded by a third of themselves, although less than 1 %
    /// of a unit. A rate of the whole range is not held.
    #[test]
    fn a_rate_is_held_to_a_hundredth_or_refused() {
        let of = |signal: f64| Slew::<Fixed>::per_tick("rate", 4.0 * signal, 4.0);
        let step = Fixed::SIGNAL_STEP;
        for signal in [49.0 * step, 50.49 * step, 200.3 * step, 100.3, 131_000.0] {
            let held = of(signal).unwrap().value();
            assert!((held - signal).abs() <= 0.51 * step, "{signal}: {held}");
        }
        // 4·50·2⁻¹⁴ to 4·131 072.
        let error = ConfigError::OutOfRange { name: "rate", min: 200.0 * step, max: 524_288.0 };
        for signal in [1.5 * step, 20.4 * step, 131_072.0, 200_000.0] {
            assert_eq!(of(signal), Err(error), "{signal}");
        }
    }

    /// Towards a target within the bound at the rate, and no further than either, from both sides; nowhere for what is no number.
    #[test]
    fn a_value_approaches_its_target() {
        let slew = Slew { bound: 2.5, per_tick: 1.0 };
        for sign in [1.0, -1.0] {
            let mut value = 0.0f64;
            for (target, expected) in [
                (0.5, 0.5),
                (9.0, 1.5),
                (2.4, 2.4),
                (9.0, 2.5),
                (2.6, 2.5),
                (f64::NAN, 2.5),
                (1.0, 1.5),
                (1.0, 1.0),
            ] {
                let output: f64 = slew.step(&mut value, sign * target);
                assert_eq!(output.to_bits(), (sign * expected).to_bits(), "{target}");
            }
        }
    }
}
