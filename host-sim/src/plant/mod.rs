//! The machine on the desk: drive, motor, screw, table, tool point, and the sensors on them.
//!
//! [`parameters::AxisParameters`] is what an axis is made of, in SI and with one of each effect;
//! [`mechanics`] moves it, [`structure`] carries the tool ([`bodies`] when it is made of
//! rigid bodies), [`sensors`] read it, [`desk`] holds the whole machine. The tracer drives the
//! same parts with measured signals.

pub mod bodies;
pub mod desk;
pub mod driven;
pub mod friction;
pub mod mechanics;
pub mod parameters;
pub mod screw;
pub mod sensors;
pub mod structure;
