//! The controller connected to drives: what a board provides, and the tick that uses it.
//!
//! A board implements [`Board`] over its timers and pins and calls [`DriveSystem::tick`] from a timer interrupt. Every
//! decision is made in this module, so that it can be tested on a host.

pub mod amplifier;
pub mod analog;
pub mod any_output;
pub mod board;
pub mod debounce;
pub mod direction_check;
mod direction_check_tick;
pub mod drive_system;
pub mod enable_switch;
pub mod enabling;
mod homing;
pub mod inputs;
mod legs;
pub mod limit_guard;
pub mod linear_input;
pub mod output;
mod probing;
mod sequence;
pub mod status_light;
pub mod step;
pub mod tick_watch;

pub use amplifier::{Amplifier, DriveError, Duty};
pub use any_output::{AnyOutput, DriveSettings, DriveSignal};
pub use board::Board;
pub use drive_system::{DriveSystem, Tick};
pub use enable_switch::{EnableSwitch, SwitchEvent};
pub use enabling::NotArmed;
pub use inputs::{AxisInputs, Inputs, Supply, SupplyLimits};
pub use linear_input::LinearInput;
pub use output::{Demand, DriveOutput};
pub use status_light::StatusLight;
pub use step::StepOutput;
pub use tick_watch::{TickClock, TickCounts};
