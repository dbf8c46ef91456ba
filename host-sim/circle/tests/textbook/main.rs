//! Circles from textbook formulas, which are written here and share no code with the crate, with known parts.

#![expect(clippy::unwrap_used, reason = "in a test, a value that is not there is the failure")]

mod generator;
mod judge;
mod logs;
mod special;
mod tables;
