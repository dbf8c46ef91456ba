//! Input and output files, and their errors.
//!
//! - [`document`]: TOML; errors contain key and line
//! - [`table`]: CSV tables of numbers; errors contain line and column
//! - [`head`]: the first line of an input, from which the reader is selected
//! - [`segments`]: the text of a file in segments of whole lines
//! - [`log`]: recordings of axes, stored as CSV tables
//! - [`mod@format`]: printed numbers
//! - [`axis_name`]: permitted names of axes
//! - [`error`]: errors of input files, in one line
//! - [`leftovers`]: temporary files left by a killed run
//! - [`output`]: files that are written completely or not at all

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod axis_name;
pub mod document;
pub mod error;
pub mod format;
pub mod head;
pub mod leftovers;
pub mod log;
pub mod output;
pub mod segments;
pub mod table;
