//! How an axis is moved towards the probe.

use serde::{Deserialize, Serialize};

use super::ProbeError;
use crate::units::TRAVEL_LIMIT_M;

/// How an axis is moved until the probe is touched, in SI.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbeSettings {
    /// Greatest distance, m, signed, not 0.
    pub distance_m: f64,
    /// Speed of all motions, m/s, above 0.
    pub speed_m_per_s: f64,
    /// Acceleration of all motions, m/s², above 0. Behind the touch the axis decelerates as at a stop.
    pub acceleration_m_per_s2: f64,
    /// Whether the axis moves back to the latched command.
    pub retracts: bool,
}

impl ProbeSettings {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`ProbeError::Setting`].
    pub fn check(&self) -> Result<(), ProbeError> {
        let values = [
            (libm::fabs(self.distance_m), TRAVEL_LIMIT_M),
            (self.speed_m_per_s, f64::MAX),
            (self.acceleration_m_per_s2, f64::MAX),
        ];
        // A NaN is not above 0.
        let is_valid = |(value, most): &(f64, f64)| *value > 0.0 && value <= most;
        if values.iter().all(is_valid) { Ok(()) } else { Err(ProbeError::Setting) }
    }
}
