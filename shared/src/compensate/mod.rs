//! What the machine is known to do wrong, put right: corrections of the command, of the motor reading and of the
//! force. Each has the number and the sign of the effect that it undoes.
//!
//! | compensation | undoes | acts on |
//! |---|---|---|
//! | [`pitch`] | what the screw moves too far, or the scale reads too much, over the travel | command |
//! | [`backlash`] | the dead zone between screw and table | command |
//! | [`talk`] | the tool point's give under acceleration, own or another axis's | command |
//! | [`geometry`] | squareness and straightness | command |
//! | dividing ([`table::Cycle`]) | the resolver's periodic error | motor reading |
//! | [`reversal`] | the stick of friction at reversal | force |
//! | ripple ([`table::Cycle`]) | the motor's periodic force | force |
//!
//! Corrections of the command are computed from the command, which has no noise, and add up; so do those of the
//! force. Each sum, and the reading's correction, passes a [`slew`]: within a declared bound, and no faster
//! than a declared rate. So whatever is switched, reverses, or is replaced, nothing jumps. Tables over the
//! travel, which change slowly, are looked up one with each command in turn, four commands for all of an axis.

pub mod axis;
pub mod backlash;
pub mod geometry;
pub mod kind;
pub mod machine;
pub mod motion;
pub mod pitch;
pub mod reversal;
pub mod settings;
pub mod slew;
pub mod table;
pub mod talk;

pub use axis::AxisCompensation;
pub use kind::Item;
pub use machine::Compensation;
pub use settings::CompensationSettings;
