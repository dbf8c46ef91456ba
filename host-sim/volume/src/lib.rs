//! The geometric errors of three linear axes in the whole volume, as far as circles and positioning tests at several
//! places determine them.
//!
//! Each carriage is a rigid body with six errors that depend on its own position (ISO 230-1: for x `EXX`, `EYX`, `EZX`, `EAX`, `EBX`,
//! `ECX`), and the axes have three errors of squareness. The error at the tool is linear in all of them ([`field`]); each reading is one
//! equation. Errors that the equations do not determine are reported, and are in no table.
//!
//! - [`component`]: the errors, and the functions that describe each over the position of its axis
//! - [`survey`]: the file that lists where the measurements were taken
//! - [`sources`]: the files of its measurements
//! - [`measurement`]: a circle or a positioning test as equations
//! - [`field`]: the error at the tool caused by a component
//! - [`vector`]: products of vectors
//! - [`fit`]: least squares, intervals, and what is not determined
//! - [`selection`]: components that the readings do not show
//! - [`finding`]: the result for each error
//! - [`analysis`]: the complete evaluation
//! - [`axis_table`]: the components that are shown, over the position of each axis
//! - [`grid`], [`beckhoff`], [`linuxcnc`]: the files
//! - [`text`]: the result for a terminal

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod analysis;
pub mod axis_table;
pub mod beckhoff;
pub mod component;
pub mod field;
pub mod finding;
pub mod fit;
pub mod grid;
pub mod linuxcnc;
pub mod measurement;
pub mod selection;
pub mod sources;
pub mod survey;
pub mod text;
pub mod vector;

pub use analysis::{Analysis, analyse};
