//! Compensation of known errors of the machine: corrections of the command, of the motor reading and of the force. Each has
//! the unit and the sign of the error that it cancels.
//!
//! | compensation | cancels | acts on |
//! |---|---|---|
//! | [`pitch`] | pitch error of screw or scale over the travel | command |
//! | [`backlash`] | backlash between screw and table | command |
//! | [`talk`] | in-talk and cross-talk: displacement of the tool by an acceleration | command |
//! | [`geometry`] | squareness and straightness | command |
//! | dividing ([`table::PeriodicTable`]) | periodic error of the resolver | motor reading |
//! | [`reversal`] | static friction at reversal | force |
//! | ripple ([`table::PeriodicTable`]) | force ripple of the motor | force |
//!
//! Corrections of the command are computed from the command, which has no noise, and added up; so are those of the force.
//! Each sum, and the correction of the reading, passes a slew-rate limiter ([`slew`]), so that nothing jumps when a
//! compensation is switched or replaced, or the axis reverses. Tables over the travel change slowly: one of them is
//! evaluated with each command, in turn, so that all of an axis take four commands.

pub mod axis;
pub mod backlash;
mod convert;
pub mod cycles;
pub mod drift;
pub mod force;
pub mod force_settings;
pub mod geometry;
pub mod kind;
pub mod machine;
pub mod motion;
pub mod octave_curve;
pub mod pitch;
pub mod presliding;
pub mod reversal;
pub mod settings;
pub mod slew;
pub mod state;
pub mod table;
pub mod talk;

pub use axis::AxisCompensation;
pub use kind::CompensationKind;
pub use machine::Compensation;
pub use settings::CompensationSettings;
pub use state::Correction;
