//! Circles from textbook formulas, which are written here and share no code with the crate, with known parts.

mod generator;
mod judge;
mod logs;
mod special;
mod tables;
