//! Motions: the motion file, and the blocks that a controller gets.
//!
//! A motion file has the initial positions of the axes, by name, and the blocks of the motion: [`Motion`], [`Block`]. The crate
//! `plant` assigns them to the axes of a machine, as [`PathBlock`]s ([`path`]).
//!
//! `read` converts the tables of the file (`tables`) to `block`s, with `pace` for feeds and ramps and `arc` for the ends
//! of arcs. `bounds` contains the permitted ranges, `duration` how long a motion lasts. [`Lines`] are motions that a program makes.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod arc;
mod block;
mod bounds;
mod duration;
mod lines;
mod pace;
pub mod path;
mod read;
mod tables;

pub use block::{Block, Direction, Motion, Pace, Sweep};
pub use lines::Lines;
pub use path::{MAX_AXES, PathBlock, PathShape};

#[cfg(test)]
mod tests;
