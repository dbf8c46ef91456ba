//! The controller on a chip in step with a simulated machine: the host asks for each tick and waits for its result
//! (processor-in-the-loop test). A board that runs its own ticks has the [`link`](crate::link) instead.
//!
//! | module | contents |
//! |---|---|
//! | [`protocol`] | orders and answers in frames of a fixed length |
//! | [`session`] | the chip's side: executes orders |

pub mod protocol;
pub mod session;
