//! What holds, ends or prevents motion.

use serde::{Deserialize, Serialize};

/// What holds, ends or prevents motion, the weakest first. It needs no session: whoever is connected to a port of the board may ask
/// for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Halt {
    /// `Hold`: decelerates along the path, drives on.
    Hold,
    /// `Stop`: discards the rest of the path, too.
    Stop,
    /// `Disable`: drives off at once.
    Disable,
}

impl Halt {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Hold, Self::Stop, Self::Disable];
}
