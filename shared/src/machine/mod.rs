//! N axes on one path: what a board or a simulation runs every tick.
//!
//! [`MachineConfig`] holds the constants in machine units, the private `state` what changes from tick to tick; `tick` is the tick, and
//! `ahead` what is computed before a position tick. [`Machine`] owns constants and state and is what a caller uses.

mod ahead;
mod brakes;
mod config;
mod controller;
mod error;
mod gantry;
mod output;
mod reference;
mod state;
mod tick;

pub use config::MachineConfig;
pub use controller::Machine;
pub use error::MachineError;
pub use output::Output;
pub use reference::Reference;

pub use crate::feedback::{OriginShift, Reading};
