//! The result of a tick.

use crate::safety::Fault;
use crate::units::Position;

/// The result of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output<S, const N: usize> {
    /// Force of each axis until the next tick; zero while the drives are off.
    pub forces: [S; N],
    /// The command that the position loops follow.
    pub commands: [Position; N],
    /// Whether the drives are to be enabled.
    pub enabled: bool,
    /// The first warning since the drives were enabled.
    pub warning: Option<Fault>,
    /// Whether every block has ended.
    pub done: bool,
}
