//! The cogging of a motor, learned on a board from slow passes: a force that repeats with the position of the motor.
//!
//! - [`declared`]: what a machine file says of the axis
//! - [`plan`]: where the axis moves, how fast, and which waves are looked for
//! - [`passes`]: the parts of a recording at constant speed, averaged over evenly spaced positions
//! - [`fit`]: load and waves of a curve over the position by least squares
//! - [`forces`]: the waves of the cogging from forces and deviations
//! - [`learned`]: which waves are significant and confirmed by passes that the fit does not use
//! - [`table`]: the waves as force ripple of a compensation file
//! - [`mod@file`]: the result as JSON; [`text`]: for a terminal
//!
//! With the force u of the drive, the mass m, a friction F against the motion, a load and the cogging r(x), a motor at x moves as
//!
//! ```text
//! m·a = u − F·sign(v) − load(x) + r(x)
//! ```
//!
//! The motor deviates by d from its command, which has the constant speed v. To first order, a wave of d with the wave number k is one of the
//! speed, w = i·k·v·d, and one of the acceleration, a = −(kv)²·d. The friction changes with the speed by s·w. Half of the sum (ū) and half of the
//! difference (Δ) of both directions at a position are
//!
//! ```text
//! ū = load − r − m·(kv)²·d̄ + s·Δw        Δu = F − m·(kv)²·Δd + s·w̄
//! ```
//!
//! so that a friction that is the same in both directions is not in ū. s follows from all waves of the second equation by least squares, r from
//! the first one: from what is recorded, whatever the loops do. Terms of second order remain, which fall with the square of d: with a table
//! applied, a second run has almost none of them.
//!
//! The force that a board records contains the one that its compensation adds. What is learned is therefore the whole cogging, also
//! while a table is applied.

pub mod declared;
pub mod file;
pub mod fit;
pub mod forces;
pub mod learned;
pub mod passes;
pub mod plan;
pub mod table;
pub mod text;

#[cfg(test)]
mod tests;

pub use declared::Declared;
pub use file::AnticoggingFile;
pub use learned::Learned;
pub use plan::{Plan, PlanError, Wanted};
