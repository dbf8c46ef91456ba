//! Files and their errors.
//!
//! - [`document`]: TOML whose errors name key and line
//! - [`table`]: CSV tables of numbers whose errors name line and column
//! - [`log`]: recordings of axes, read from such a table and written as one
//! - [`mod@format`]: numbers as text for people
//! - [`axis_name`]: which names an axis may have
//! - [`error`]: an input that cannot be used, in one line
//! - [`output`]: files that are written whole or not at all

pub mod axis_name;
pub mod document;
pub mod error;
pub mod format;
pub mod log;
pub mod output;
pub mod table;
