//! The declared model of a machine.
//!
//! - [`axis`]: the settings of one axis.
//! - [`effects`]: the catalogue of effects that a declared model may lack.
//! - [`machine`]: the machine file, with the settings of its axes and the effects found.
//! - [`bodies`]: a machine as rigid bodies on elastic joints.
//! - [`friction_curve`]: published friction curves.
//! - [`friction_law`]: functions of velocity that effects and friction maps share.
//! - [`servo`]: converts the settings of an axis, and the effects in its controller, into settings of [`shared`].
//! - [`position_curve`]: a quantity over position, given at knots.
//! - [`residual_table`]: a residual that no effect describes, as a table.
//! - [`residual_law`]: such a residual as an equation.
//! - [`range`]: the range of a declared number.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod axis;
pub mod bodies;
pub mod effects;
pub mod examples;
pub mod friction_curve;
pub mod friction_law;
pub mod machine;
pub mod position_curve;
pub mod range;
pub mod residual_law;
pub mod residual_table;
pub mod servo;
