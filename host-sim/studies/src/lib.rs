//! Studies on the simulated machine.
//!
//! [`reproduce`] repeats published experiments; [`compare`] runs the same motions in fixed point, f32 and f64;
//! [`sensors`] closes the loop of one machine by the motor, the table and both. Their report
//! pages are built from the components in [`pages`].

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod compare;
pub mod reproduce;
pub mod sensors;
