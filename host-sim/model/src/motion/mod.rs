//! The motion file: where the axes stand at the beginning, and what they do then, block by block.
//!
//! [`read`] goes through the file (`tables`), with `pace` for speeds and `arc` for where an arc ends, and gives the [`block`]s that
//! can be run; `bounds` is what a file may hold.

mod arc;
mod block;
mod bounds;
mod pace;
mod read;
mod tables;

pub use block::{Block, Direction, Motion, Pace, Sweep};

#[cfg(test)]
mod tests;
