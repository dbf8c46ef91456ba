//! Why settings were rejected.

use core::fmt;

/// Why settings were rejected, with the name of the setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConfigError {
    /// Not a finite number.
    NotFinite(&'static str),
    /// Must be greater than zero.
    NotPositive(&'static str),
    /// Cannot be changed once the machine has been configured, or while the drives are on.
    NotWhileRunning(&'static str),
    /// A setting that is of no use without another one, which is missing.
    Requires {
        /// Setting.
        name: &'static str,
        /// The missing setting.
        other: &'static str,
    },
    /// Outside its range, which may depend on the number format.
    OutOfRange {
        /// Setting.
        name: &'static str,
        /// Least value, in the unit of the setting.
        min: f64,
        /// Greatest value, in the unit of the setting.
        max: f64,
    },
    /// Too few values of a table, or too many.
    Count {
        /// Setting.
        name: &'static str,
        /// Greatest number of values.
        max: u16,
    },
    /// The number of an axis that is not another axis of the machine.
    NotAnotherAxis {
        /// Setting.
        name: &'static str,
        /// Number of axes of the machine.
        axes: u8,
    },
    /// Above its ceiling in the envelope of the board.
    AboveCeiling {
        /// Setting.
        name: &'static str,
        /// Its value, in the unit of the setting.
        value: f64,
        /// Greatest value.
        ceiling: f64,
    },
    /// Below its floor in the envelope of the board.
    BelowFloor {
        /// Setting.
        name: &'static str,
        /// Its value, in the unit of the setting.
        value: f64,
        /// Least value.
        floor: f64,
    },
    /// A limit that is missing, and that the envelope of the board requires.
    NotMonitored {
        /// Setting.
        name: &'static str,
        /// Greatest value, in the unit of the setting.
        ceiling: f64,
    },
    /// Uses a linear scale, and the axis has none.
    NoScale(&'static str),
    /// Of the second motor of a gantry, and another than that of its first motor.
    NotOfFirstMotor(&'static str),
    /// The axis cannot be the second motor of a gantry on this board.
    NoGantry(&'static str),
}

impl ConfigError {
    /// The name of the setting; for a compensation the path within
    /// [`CompensationSettings`](crate::compensate::CompensationSettings), as `force.load.values`.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::NotFinite(name)
            | Self::NotPositive(name)
            | Self::NotWhileRunning(name)
            | Self::Requires { name, .. }
            | Self::OutOfRange { name, .. }
            | Self::Count { name, .. }
            | Self::NotAnotherAxis { name, .. }
            | Self::AboveCeiling { name, .. }
            | Self::BelowFloor { name, .. }
            | Self::NotMonitored { name, .. }
            | Self::NoScale(name)
            | Self::NotOfFirstMotor(name)
            | Self::NoGantry(name) => name,
        }
    }

    /// What is expected of the setting, without its name: `a number above 0`.
    #[must_use]
    pub fn expectation(&self) -> impl fmt::Display + '_ {
        fmt::from_fn(|f| match self {
            Self::NotFinite(_) => f.write_str("a finite number"),
            Self::NotPositive(_) => f.write_str("a number above 0"),
            Self::NotWhileRunning(_) => f.write_str("what the machine was made with"),
            Self::Requires { other, .. } => write!(f, "together with {other}, which is missing"),
            Self::OutOfRange { min, max, .. } => {
                f.write_str("a number from ")?;
                write_number(f, *min)?;
                f.write_str(" to ")?;
                write_number(f, *max)
            }
            Self::Count { max, .. } => write!(f, "2 to {max} values"),
            Self::NotAnotherAxis { axes, .. } => {
                write!(f, "the number of another axis, of {axes} counted from 0")
            }
            Self::AboveCeiling { ceiling, .. } => write!(f, "at most {ceiling}, the ceiling of this board"),
            Self::BelowFloor { floor, .. } => write!(f, "at least {floor}, the floor of this board"),
            Self::NotMonitored { ceiling, .. } => {
                write!(f, "a limit of at most {ceiling}, which this board requires")
            }
            Self::NoScale(_) => f.write_str("settings without a linear scale: the axis has none"),
            Self::NotOfFirstMotor(_) => f.write_str("what the first motor of the gantry has"),
            Self::NoGantry(_) => f.write_str("an axis of its own: this board has no gantry with it"),
        })
    }
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: expected {}", self.name(), self.expectation())
    }
}

impl core::error::Error for ConfigError {}

/// Writes four significant digits, in scientific notation below 1e-3 and from 1e7.
fn write_number(f: &mut fmt::Formatter<'_>, value: f64) -> fmt::Result {
    if value == 0.0 || !value.is_finite() {
        return write!(f, "{value}");
    }
    if !(1e-3..1e7).contains(&libm::fabs(value)) {
        return write!(f, "{value:.3e}");
    }
    let scale = libm::pow(10.0, 3.0 - libm::floor(libm::log10(libm::fabs(value))));
    write!(f, "{}", libm::round(value * scale) / scale)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::string::ToString;

    use super::*;

    #[test]
    fn a_range_is_printed_with_four_digits() {
        let message = |min, max| ConfigError::OutOfRange { name: "a", min, max }.to_string();
        assert_eq!(message(0.0, 2048.0), "a: expected a number from 0 to 2048");
        assert_eq!(message(-0.123_456, 7_812_499.9), "a: expected a number from -0.1235 to 7812000");
        assert_eq!(message(4.768_37e-5, 1e18), "a: expected a number from 4.768e-5 to 1.000e18");
    }
}
