//! The cost of each part of a tick in instructions, counted on the emulated core for every tick of a motion.
//!
//! | module | what it does |
//! |---|---|
//! | [`count`] | counts one part over many inputs and prints a row |
//! | [`parts`] | the parts, one row each |
//! | [`four_axes`] | the tick of four axes |
//! | [`motion`] | the motion, and the simulated axes that perform it |
//!
//! A part gets the inputs that it has in the whole machine, in every tick of the motion and in order, with its own state from
//! the previous tick.
#![expect(clippy::large_stack_arrays, reason = "the emulated machine has 4 MB of memory")]

pub mod count;
pub mod four_axes;
pub mod motion;
pub mod parts;
