//! The control laws of one axis, one a file, each a constant part and a state apart.

pub mod bump;
pub mod feedforward;
pub mod filter;
pub mod hpc;
pub mod position;
pub mod velocity;
