//! Why settings or a block were rejected.

use crate::config::ConfigError;
use crate::interpolate::PathError;

/// Why settings or a block were rejected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MachineError {
    /// A setting of an axis.
    Config {
        /// Axis, counted from 0.
        axis: usize,
        /// What is wrong with the setting.
        error: ConfigError,
    },
    /// A block, or an axis filter behind the path.
    Path(PathError),
    /// The machine has no such axis.
    NoSuchAxis,
    /// Only possible while no path runs.
    PathRunning,
}

impl From<PathError> for MachineError {
    fn from(error: PathError) -> Self {
        Self::Path(error)
    }
}

impl core::fmt::Display for MachineError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Config { axis, error } => write!(f, "axis {axis}: {error}"),
            Self::Path(error) => write!(f, "{error}"),
            Self::PathRunning => write!(f, "only possible while no path runs"),
            Self::NoSuchAxis => write!(f, "the machine has no such axis"),
        }
    }
}

impl core::error::Error for MachineError {}
