//! What is declared of a machine.
//!
//! [`machine`] is the machine file: the settings of its axes and the effects that were found. [`effects`] is the catalogue of
//! what a machine may do beyond its declared model. [`bodies`] is a machine as rigid bodies on elastic joints,
//! [`friction_curve`] a published friction law, [`friction_law`] the functions of speed. [`motion`] is the motion file. [`servo`] turns an axis into the settings of
//! the controller in [`shared`].

pub mod bodies;
pub mod effects;
pub mod examples;
pub mod friction_curve;
pub mod friction_law;
pub mod machine;
pub mod motion;
pub mod servo;
