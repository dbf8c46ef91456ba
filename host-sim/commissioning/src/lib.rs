//! From a model of a machine to settings of its controller.
//!
//! - [`compensate`]: the compensation of the effects of a model, with the contour error that it predicts
//! - [`margins`]: gain and phase margins of the velocity and position loops
//! - [`tuning`]: settings of the loops, as fast as given margins allow

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod compensate;
pub mod margins;
pub mod tuning;
