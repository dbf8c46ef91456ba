//! Contour error: the distance of the tool from the programmed path, with the figures of circles and corners.
//!
//! - [`path`]: the nominal path, from a motion's blocks or from a log's command
//! - [`evaluation`]: the error of each sample, and its figures: maximum, rms, per block, circles, corners
//! - [`across`]: the contributions of a displacement of the tool and of the noise of its reading
//! - [`logged`], [`long_log`], [`log_error`]: the same for a log, for a long one section by section, and for several with their names
//! - [`circle`], [`circular_test`]: radial deviation F, circular deviation G and hysteresis H (ISO 230-4)
//! - [`sectors`]: means over sectors of a turn
//! - [`reversal_spike`]: peaks where an axis reverses
//! - [`corner`]: overshoot and rounding
//! - [`circle_fit`]: finds a circle in a command
//! - [`verification`], [`comparison`]: the error before and after a change
//! - [`text`], [`json`]: the figures for a terminal, and for a file

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod across;
pub mod circle;
pub mod circle_fit;
pub mod circular_test;
pub mod comparison;
pub mod corner;
pub mod evaluation;
pub mod json;
pub mod log_error;
pub mod logged;
pub mod long_log;
pub mod path;
pub mod path_circle;
mod piece;
pub mod reversal_spike;
pub mod sectors;
mod sums;
pub mod text;
pub mod vector;
pub mod verification;

#[cfg(test)]
mod tests;

pub use evaluation::{ContourError, Evaluation};
pub use logged::LoggedMotion;
pub use path::NominalPath;
