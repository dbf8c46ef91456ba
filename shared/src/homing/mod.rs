//! Homing of one axis: to the mark of a home switch ([`Homing`]), or to a hard stop ([`HardStop`]); and of the two motors of a gantry
//! ([`GantryHoming`]).

mod error;
mod gantry;
mod hard_stop;
mod home_switch;
mod interface;
mod progress;
mod run;
mod settings;

pub use error::HomingError;
pub use gantry::GantryHoming;
pub use hard_stop::{HardStop, HardStopSettings};
pub use home_switch::Homing;
pub use interface::{HomingAction, HomingInput, HomingStatus, LegMotion};
pub use run::HomingRun;
pub use settings::{AtLimit, Direction, HomingSettings, Mark};
