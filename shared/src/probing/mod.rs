//! Probing along one axis: a motion until an input changes, whose positions in that tick are kept.
//!
//! ```text
//!     Approach ── probe touched: positions latched ──► decelerates ── at rest ──► Retract to the latched command ──► touched
//! ```
//!
//! The input is read once in a tick, and two of three samples decide. The latched readings are those of the first of the samples that agree, so
//! that the edge is between them and those of the tick before: they are at most speed/tick rate beyond it, although the axis is stopped a tick
//! later. If the sample between the two disagrees, the contact has bounced, or a spike came within two ticks before the edge: the latched
//! readings are then up to two ticks before it. The command changes with a position tick: it may be older by one period of that loop.

mod error;
mod run;
mod settings;

pub use error::ProbeError;
pub use run::{ProbeInput, ProbeStatus, Probing, Touch};
pub use settings::ProbeSettings;
