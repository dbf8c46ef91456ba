//! What is run on the simulated machine and reported in figures.
//!
//! [`reproduce`] runs the published experiments again that the project started from; [`compare`] runs the same motions in
//! fixed point, f32 and f64. Each has a page of its own, built from the parts in [`pages`].

pub mod compare;
pub mod reproduce;
