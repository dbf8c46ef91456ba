//! Backlash: the table lags behind the screw by half the width, in either direction.
//!
//! The command is moved by ±half the width in the direction of travel.

use crate::config::ConfigError;
use crate::scalar::Scalar;
use crate::units::LENGTH_M;

/// Half the width.
#[derive(Clone, Copy, Debug)]
pub struct Backlash<S: Scalar> {
    half: S,
}

impl<S: Scalar> Backlash<S> {
    /// From the total width, m.
    ///
    /// # Errors
    /// [`ConfigError`] with `backlash_width_m` if it is negative, or half of it exceeds the bound.
    pub fn new(width_m: f64, bound_m: f64) -> Result<Self, ConfigError> {
        let width = crate::config::check::ranged("backlash_width_m", width_m, 0.0, 2.0 * bound_m)?;
        Ok(Self { half: S::signal(width / 2.0 / LENGTH_M) })
    }

    /// Half the width, error units: the correction of the command for travel in the positive direction, and its negative for
    /// the other.
    #[must_use]
    pub const fn half(&self) -> S {
        self.half
    }
}
