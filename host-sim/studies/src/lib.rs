//! What is run on the simulated machine and told in figures.
//!
//! [`reproduce`] runs the published experiments again that the project started from; [`compare`] runs the same motions in
//! fixed point, f32 and f64; [`demo`] draws a machine with an undeclared effect, runs it, and traces its logs. Each study
//! that has a page of its own builds it from the parts in [`report`].

pub mod compare;
pub mod demo;
pub mod reproduce;
