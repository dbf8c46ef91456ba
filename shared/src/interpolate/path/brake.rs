//! The state of a stop along the path.

/// A stop along the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Brake {
    /// Position units per tick² with 16 fraction bits.
    pub(super) deceleration: u64,
    /// Position units per tick with 16 fraction bits.
    pub(super) speed: u64,
    /// From the start of the first block, position units with 64 fraction bits.
    pub(super) distance: i128,
}
