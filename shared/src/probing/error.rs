//! Why nothing was probed.

use serde::{Deserialize, Serialize};

use crate::interpolate::PathError;

/// Why nothing was probed. The axis has stopped or is stopping.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProbeError {
    /// The distance, the speed or the acceleration is not in its range.
    Setting,
    /// A probing needs drives that are on and an axis at rest, with no homing and no other probing running.
    NotReady,
    /// The probe is touched, or not connected, before the axis moves.
    Active,
    /// The probe was not touched within the distance.
    NotTouched,
    /// It was stopped by the user.
    Stopped,
    /// The drives were switched off, or a fault stopped the path.
    DrivesOff,
    /// The path rejected a motion.
    Path(PathError),
}

impl core::fmt::Display for ProbeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Path(error) => return write!(f, "a motion of the probing was rejected: {error}"),
            Self::Setting => "distance, speed or acceleration: outside its range",
            Self::NotReady => "probing needs drives that are on, and axes at rest",
            Self::Active => "the probe is touched before the axis moves, or is not connected",
            Self::NotTouched => "the probe was not touched within the distance",
            Self::Stopped => "the probing was stopped",
            Self::DrivesOff => "the drives went off, or a fault stopped the axis",
        })
    }
}

impl core::error::Error for ProbeError {}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::string::ToString;

    use super::*;

    #[test]
    fn each_error_has_its_own_words() {
        let errors = [
            ProbeError::Setting,
            ProbeError::NotReady,
            ProbeError::Active,
            ProbeError::NotTouched,
            ProbeError::Stopped,
            ProbeError::DrivesOff,
        ];
        let mut words: std::vec::Vec<_> = errors.iter().map(ToString::to_string).collect();
        words.sort();
        words.dedup();
        assert!(words.len() == errors.len() && words.iter().all(|words| words.len() > 20), "{words:?}");
        let path = ProbeError::Path(PathError::NotHomed { axis: 1 }).to_string();
        assert!(
            path.starts_with("a motion of the probing")
                && path.ends_with(&PathError::NotHomed { axis: 1 }.to_string())
        );
    }
}
