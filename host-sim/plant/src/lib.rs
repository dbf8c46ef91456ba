//! The machine on the desk: drive, motor, screw, table, tool point, and the sensors on them.
//!
//! [`parameters::AxisParameters`] is what an axis is made of, in SI and with one of each effect; [`mechanics`] moves it (its
//! linear part by [`transition`]), [`structure`] carries the tool, [`sensors`] read it after a [`delay`], [`desk`] holds the
//! whole machine. [`bodies`] is the structure in full, rigid bodies on elastic joints, and [`together`] moves the axes of
//! one. The tracer drives the same parts with measured
//! signals.

pub mod bodies;
pub mod delay;
pub mod desk;
pub mod driven;
pub mod friction;
pub mod guide;
pub mod instruments;
pub mod lane;
pub mod mechanics;
pub mod motion;
pub mod parameters;
pub mod path;
pub mod screw;
pub mod sensors;
pub mod simulate;
pub mod structure;
pub mod together;
pub mod transition;
