//! From a model of a machine to settings of its controller.
//!
//! - [`anticogging`]: the cogging of a motor from slow passes on a board
//! - [`compensate`]: the compensation of the effects of a model, with the contour error that it predicts
//! - [`margins`]: gain and phase margins of the velocity and position loops
//! - [`resonances`]: resonances from accelerations at the tool
//! - [`response`]: plant, loops and margins as a board has measured them
//! - [`tuning`]: settings of the loops, as fast as given margins allow

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod anticogging;
pub mod compensate;
pub mod margins;
pub mod resonances;
pub mod response;
pub mod tuning;
