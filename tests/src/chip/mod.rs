//! Reads the program of a chip: its functions, what its instructions do, and what can be reached.

pub mod depth;
pub mod image;
pub mod memory;
pub mod pointer;
pub mod thumb;
pub mod vectors;
pub mod walk;
