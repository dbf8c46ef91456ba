//! What switches the drives on.

use serde::{Deserialize, Serialize};

/// What switches the drives on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Enabling {
    /// The enable switch.
    BySwitch,
    /// A host, while the switch permits it: since it was closed as a new edge and until it opens, or the hardware stops the
    /// drives.
    ByHost {
        /// Whether the switch permits it.
        armed: bool,
    },
}

/// Why a host may not enable the drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotArmed {
    /// The enable switch is open, has not been opened and closed since the start or since a stop by hardware, or enables the drives by
    /// itself.
    Switch,
    /// The emergency stop is pressed.
    EmergencyStop,
}
