//! What switches the drives on.

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

/// A host has asked for an enable that the enable switch does not permit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotArmed;
