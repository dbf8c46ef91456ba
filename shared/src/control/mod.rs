//! The control laws of one axis, one a file, each a constant part and a state apart.

pub mod feedforward;
pub mod hpc;
pub mod position;
pub mod velocity;
