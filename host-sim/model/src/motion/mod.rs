//! The motion file: initial positions of the axes, and the blocks of the motion.
//!
//! [`read`] converts the tables of the file (`tables`) to [`block`]s, with `pace` for feeds and ramps and `arc` for the ends
//! of arcs. `bounds` contains the permitted ranges.

mod arc;
mod block;
mod bounds;
mod pace;
mod read;
mod tables;

pub use block::{Block, Direction, Motion, Pace, Sweep};

#[cfg(test)]
mod tests;
