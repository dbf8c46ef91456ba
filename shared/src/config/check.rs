//! Range checks of single settings, and their conversion to gains.

use super::error::ConfigError;
use crate::scalar::Scalar;

pub(crate) fn finite(name: &'static str, value: f64) -> Result<f64, ConfigError> {
    if value.is_finite() { Ok(value) } else { Err(ConfigError::NotFinite(name)) }
}

pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, ConfigError> {
    if finite(name, value)? > 0.0 { Ok(value) } else { Err(ConfigError::NotPositive(name)) }
}

pub(crate) fn ranged(name: &'static str, value: f64, min: f64, max: f64) -> Result<f64, ConfigError> {
    if (min..=max).contains(&finite(name, value)?) {
        Ok(value)
    } else {
        Err(ConfigError::OutOfRange { name, min, max })
    }
}

/// `si·unit` as a gain. Rejected, with the range in SI, if it exceeds the range of the format.
pub(crate) fn gain<S: Scalar>(name: &'static str, si: f64, unit: f64) -> Result<S::Gain, ConfigError> {
    let max = S::GAIN_LIMIT / unit;
    if finite(name, si)?.abs() < max {
        Ok(S::gain(si * unit))
    } else {
        Err(ConfigError::OutOfRange { name, min: 0.0, max })
    }
}

/// `si·unit` as a gain that may be negative. Rejected, with the range in SI, if it exceeds the range of the format.
pub(crate) fn signed_gain<S: Scalar>(name: &'static str, si: f64, unit: f64) -> Result<S::Gain, ConfigError> {
    gain::<S>(name, si, unit).map_err(|error| match error {
        ConfigError::OutOfRange { name, max, .. } => ConfigError::OutOfRange { name, min: -max, max },
        error => error,
    })
}

/// Least gain in steps of the format: the rounding error is then at most 1 %.
const MIN_GAIN_STEPS: f64 = 50.0;

/// `si·unit` as a positive gain with a rounding error of at most 1 %. Rejected, with the range in SI, if the format
/// cannot hold it.
pub(crate) fn resolved_gain<S: Scalar>(
    name: &'static str,
    si: f64,
    unit: f64,
) -> Result<S::Gain, ConfigError> {
    let min = MIN_GAIN_STEPS * S::GAIN_STEP / unit;
    match gain::<S>(name, si, unit) {
        Ok(gain) if si >= min => Ok(gain),
        Ok(_) | Err(ConfigError::OutOfRange { .. }) => {
            Err(ConfigError::OutOfRange { name, min, max: S::GAIN_LIMIT / unit })
        }
        Err(error) => Err(error),
    }
}

/// A gain that is inversely proportional to a time, with a rounding error of at most 1 %. Rejected with the range of
/// the time, s.
pub(crate) fn gain_over_time<S: Scalar>(
    name: &'static str,
    gain: f64,
    time_s: f64,
) -> Result<S::Gain, ConfigError> {
    let time_of = |limit: f64| time_s * gain / limit;
    resolved_gain::<S>(name, gain, 1.0).map_err(|error| match error {
        ConfigError::OutOfRange { name, min, max } => {
            ConfigError::OutOfRange { name, min: time_of(max), max: time_of(min) }
        }
        other => other,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Fixed;

    /// A gain of fixed point is below 128 in units of the loop: 64 in an SI unit that is two of them.
    #[test]
    fn a_gain_ends_below_its_limit() {
        let error = ConfigError::OutOfRange { name: "k", min: 0.0, max: 64.0 };
        assert_eq!(gain::<Fixed>("k", 64.0, 2.0), Err(error));
        assert_eq!(gain::<Fixed>("k", 63.99, 2.0), Ok(Fixed::gain(127.98)));
    }

    /// Half a step of 50 is 1 %.
    #[test]
    fn a_resolved_gain_has_the_range_of_its_unit() {
        let min = 50.0 * Fixed::GAIN_STEP / 2.0;
        let error = ConfigError::OutOfRange { name: "k", min, max: 64.0 };
        for value in [0.0, 0.99 * min, 64.0, 1e9] {
            assert_eq!(resolved_gain::<Fixed>("k", value, 2.0), Err(error), "{value}");
        }
        assert_eq!(resolved_gain::<Fixed>("k", min, 2.0), Ok(Fixed::gain(2.0 * min)));
    }
}
