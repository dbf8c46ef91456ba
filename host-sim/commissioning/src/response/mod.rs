//! The frequency response of an axis, measured on a board: plant, loops, margins, resonances.
//!
//! - [`tones`]: which tones are measured, in which groups
//! - [`spectrum`]: recordings of a group to force, position and coherence at each of its tones
//! - [`point`]: from these to the plant and the loops
//! - [`margins`]: crossover, phase margin and gain margin between measured points
//! - [`resonances`]: maxima of the acceleration per force, and a notch for one
//! - [`mod@file`]: the result as JSON
//! - [`text`]: the result for a terminal
//!
//! A board adds a periodic force D to that of its velocity controller ([`shared::excitation`]). With the force u of the controller, the axis
//! gets F = D + u, and u = −L·F with the open loop L, cut at the force. F, and the positions, are recorded in every tick, D is known:
//!
//! ```text
//! L = (D − F)/F,   closed loop L/(1 + L) = (D − F)/D,   plant = jω·x/F
//! ```
//!
//! All of them are quotients of what is in phase with D. What is not, as friction, noise and the force of the process, is averaged over the
//! periods, and lowers the coherence. Dividing x by the recorded force instead would mix it into the plant: the loop is closed. (L. Ljung,
//! *System Identification*, 2nd edition, section 13.5: indirect and joint input–output identification.)
//!
//! Friction and backlash are not linear. What is measured is the axis at rest under this force: a friction above it holds the table, and
//! the response is that of the motor on its spring.

pub mod file;
pub mod margins;
pub mod point;
pub mod resonances;
pub mod spectrum;
pub mod text;
pub mod tones;

#[cfg(test)]
mod tests;

pub use file::ResponseFile;
pub use point::{Loop, Point};
pub use spectrum::{Line, Record};
pub use tones::{Plan, PlanError};
