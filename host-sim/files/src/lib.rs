//! Files and their errors.
//!
//! [`document`] is a TOML text whose keys know their line; [`log`] is a recording, a CSV with one row a sample;
//! [`number`] reads a cell of it. [`error`] is the one line that a refused input gets. [`output`] writes a file whole or
//! not at all. [`axis_name`] is what an axis may be called, in a machine file and in a log's columns.

pub mod axis_name;
pub mod document;
pub mod error;
pub mod log;
pub mod output;
pub mod table;
