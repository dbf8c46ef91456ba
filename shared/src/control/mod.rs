//! The control laws of one axis, one per module, each with its constants and its state apart.
//!
//! | module | law |
//! |---|---|
//! | [`feedforward`] | velocity feed-forward: command + (Kf/Kp)·d(command)/dt |
//! | [`position`] | position loop: P, or P behind the filter of [`hpc`] |
//! | [`hpc`] | high-order position control: a second-order filter of the following error |
//! | [`velocity`] | velocity loop: PI with anti-windup, on the differenced motor reading or an observer of it |
//! | [`observer`] | velocity by a tracking observer (PLL) |
//! | [`gain_schedule`] | the velocity gain over command or speed |
//! | [`mod@filter`] | notches and low-pass filter of the force |
//! | [`bumpless_transfer`] | no jump of velocity command or force when gains are changed |

pub mod bumpless_transfer;
pub mod feedforward;
pub mod filter;
pub mod gain_schedule;
pub mod hpc;
pub mod observer;
pub mod position;
pub mod velocity;
