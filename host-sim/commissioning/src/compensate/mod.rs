//! From a model to the compensation that a controller applies.
//!
//! - [`tables`], [`cycles`], [`force`]: the effects of a model as settings of the compensations in `shared`
//! - [`laws`]: laws of residuals as such settings; `law_parts`: their terms as parts that can be left out
//! - [`servo`]: deviations of the drive's gains as changes of its settings
//! - [`prediction`]: the contour error of the model with and without a compensation
//! - [`counted_motions`]: the motions whose contour error counts
//! - [`plan`]: the compensation of a model, without the items that the prediction does not support
//! - `choice`: what of a possible compensation is used; [`watched`]: motions that it may not make worse, such as the
//!   [`standard_motions`]
//! - [`motions_within`]: motions within the travel of the axes
//! - [`mapped`]: the travel that a compensation is made for, and motions that leave it
//! - [`listed`]: the items of a plan, and what is left out
//! - `capacity`: what of a model is beyond what the controller can compensate
//! - [`round_trip`]: the same motions before and after on a simulated machine, whose controller runs where [`controller_host`] says
//! - [`limits`]: what limits the error that is left: noise, resolution, bandwidth, or what the model does not describe
//! - [`alignment`]: logs whose channels are late
//! - [`mod@file`]: the compensation file; [`json`]: the plan as JSON; [`text`]: for a terminal
//!
//! An item is kept only if the simulated model follows the path better with it than without it.

pub mod alignment;
mod capacity;
mod choice;
pub mod controller_host;
pub mod counted_motions;
pub mod cycles;
pub mod file;
pub mod force;
pub mod json;
mod law_parts;
pub mod laws;
pub mod limits;
pub mod listed;
pub mod mapped;
pub mod motions_within;
pub mod plan;
pub mod planning;
pub mod prediction;
pub mod round_trip;
pub mod servo;
pub mod standard_motions;
pub mod tables;
pub mod text;
pub mod watched;

pub use file::CompensationFile;
pub use plan::Plan;
