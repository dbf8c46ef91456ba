//! What is declared of a machine.
//!
//! [`axis`] has the settings of one axis. [`effects`], over it, is the catalogue of what a machine may do beyond its declared
//! model. [`machine`], over both, is the machine file: the settings of its axes and the effects that were found. [`bodies`]
//! is a machine as rigid bodies on elastic joints, [`friction_curve`] a published friction law, [`friction_law`] the functions of speed that effects
//! and friction maps share. [`motion`] is the motion
//! file. [`servo`] turns the settings of an axis, and the effects in its controller, into the settings of the controller in
//! [`shared`]. [`range`] is the range of a declared number.

pub mod axis;
pub mod bodies;
pub mod effects;
pub mod examples;
pub mod friction_curve;
pub mod friction_law;
pub mod machine;
pub mod motion;
pub mod range;
pub mod servo;
