//! Probing along one axis: a motion until an input changes, whose positions in that tick are kept.
//!
//! ```text
//!     Approach ── probe touched: positions latched ──► decelerates ── at rest ──► Retract to the latched command ──► touched
//! ```
//!
//! The input is read once in a tick, so that the edge is between the readings of this tick and those of the tick before: the latched
//! readings are at most speed/tick rate beyond it. The command changes with a position tick: it may be older by one period of that loop.

mod error;
mod run;
mod settings;

pub use error::ProbeError;
pub use run::{ProbeInput, ProbeStatus, Probing, Touch};
pub use settings::ProbeSettings;
