//! Where the declared model is held against a log.

use serde::{Deserialize, Serialize};

/// A point in the chain command → motor → table → tool at which the model is held against the log, each driven by the
/// measured signal upstream of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Motor reading against the declared loop driven by the command.
    Motor,
    /// Table scale against the mechanics driven by the measured motor.
    Table,
    /// Tool point against the structure driven by the measured tables.
    Tool,
    /// Drive force against the force that the measured motion needs.
    Force,
}

/// A channel that may be late against the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Linear scale.
    Table,
    /// Tool-point probe.
    Tool,
    /// Drive force, against the time that the log's format gives it: over the tick that ends at the
    /// sample. A log that shows what is going to be given over the next tick is early by one.
    Force,
}
