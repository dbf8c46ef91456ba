//! Studies on the simulated machine.
//!
//! [`reproduce`] repeats published experiments; [`compare`] runs the same motions in fixed point, f32 and f64; [`demo`]
//! draws a machine with an undeclared effect, simulates it and traces its logs. Studies with a report page build it from
//! the components in [`report`].

pub mod compare;
pub mod demo;
pub mod reproduce;
