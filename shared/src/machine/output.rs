//! What a tick of a machine returns.

use crate::safety::Fault;
use crate::units::Position;

/// What a tick gives to the drives and to whoever watches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output<S, const N: usize> {
    /// Force for each axis until the next tick; zero while the drives are off.
    pub forces: [S; N],
    /// The command that the position loops follow.
    pub commands: [Position; N],
    /// Whether the drives may be on.
    pub enabled: bool,
    /// The first fault that the machine has gone on with since it was enabled.
    pub warning: Option<Fault>,
    /// Whether every block has been travelled.
    pub done: bool,
}
