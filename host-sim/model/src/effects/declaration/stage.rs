//! Stages in which the declared model is compared with a log.

use serde::{Deserialize, Serialize};

/// A stage of the chain command → motor → table → tool. Each stage is simulated from the measured signal upstream of it
/// and compared with the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Motor reading, compared with the declared closed loop driven by the command.
    Motor,
    /// Linear scale, compared with the mechanics driven by the measured motor.
    Table,
    /// Tool point, compared with the structure driven by the measured tables.
    Tool,
    /// Drive force, compared with the force required by the measured motion.
    Force,
}

/// A channel that may be logged late relative to the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Linear scale.
    Table,
    /// Tool-point probe.
    Tool,
    /// Drive force. By the log format, it is the force of the tick that ends at the sample. A log with the force of the
    /// tick that begins at the sample is one tick early.
    Force,
    /// Command.
    Command,
}
