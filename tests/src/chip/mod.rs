//! Reads the program of a chip: its functions, what its instructions do, and what can be reached.

pub mod image;
pub mod thumb;
pub mod walk;
