//! What each part of a tick costs, in instructions: counted on the emulated core, tick by tick of a motion.
//!
//! | module | what it does |
//! |---|---|
//! | [`count`] | counts one part over many inputs, and prints a line |
//! | [`parts`] | the parts: each is one line there |
//! | [`motion`] | the motion, and the axes that make it |
//!
//! A part gets the input of every tick of the motion that the whole machine gets, in the same order, with the state
//! that it has left the tick before.
#![expect(clippy::large_stack_arrays, reason = "the emulated machine has 4 MB, and nothing else to do")]

pub mod count;
pub mod motion;
pub mod parts;
