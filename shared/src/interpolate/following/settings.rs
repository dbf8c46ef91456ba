//! How an axis follows a counter, and why it cannot.

use serde::{Deserialize, Serialize};

use crate::interpolate::PathError;

/// How an axis follows a counter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FollowSettings {
    /// Input of the counter: the number of the axis whose scale would be there.
    pub input: u8,
    /// Signed distance of the axis, m, for a number of counts: 1 pm to 100 m in magnitude, at most 2⁴⁰ position units (1.05 mm) a count.
    pub distance_m: f64,
    /// That number of counts, 1 to 2³¹ − 1.
    pub counts: u32,
    /// Greatest speed, m/s, up to 10 m/s.
    pub speed_m_per_s: f64,
    /// Greatest acceleration, m/s², up to 1000 m/s².
    pub acceleration_m_per_s2: f64,
    /// Distance between setpoint and command beyond which the axis stops, m: 1 µm to 0.1 m.
    pub lag_m: f64,
}

/// Why an axis cannot follow a counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FollowError {
    /// The distance or the number of counts is outside its range, or the distance is less than 1 pm.
    Ratio,
    /// The speed is outside its range, or less than a position unit a tick.
    Speed,
    /// The acceleration is outside its range.
    Acceleration,
    /// The lag is outside its range.
    Lag,
    /// The input has no counter: a scale is there, or there is no such input.
    NoCounter,
    /// The axis follows a counter already.
    Engaged,
    /// The axes move.
    Moving,
    /// There is no such axis.
    NoSuchAxis,
    /// The path does not accept a motion of the axis.
    Path(PathError),
}

impl From<PathError> for FollowError {
    fn from(error: PathError) -> Self {
        Self::Path(error)
    }
}
