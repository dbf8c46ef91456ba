//! Gain and phase margins of the velocity and position loops of a machine file, from its sampled linear model.
//!
//! - [`mechanics`]: masses, spring, damping and drive lag over a tick, for one [`Condition`]
//! - [`linear_axis`]: the controller of an axis and its mechanics from tick to tick, without friction and limits
//! - [`sampled`]: a linear sampled system from its step function; frequency response, eigenvalues
//! - [`margin`]: the margins of an open loop
//! - [`axis_margins`]: the margins of the axes of a machine, the highest position gain with given margins
//! - [`change`]: whether changed settings leave too little margin
//! - [`json`], [`text`]: the result
//!
//! The open loop of the velocity loop is cut at the force, that of the position loop at the velocity command. Both are exact
//! for a linear axis: the sampling, the hold of force and velocity command, the backward difference of the reading, the
//! latencies and the filters are those of the controller and of the simulation, in the same order. Coulomb friction and
//! backlash are not linear: the margins are those of each [`Condition`] that the axis can be in, and the smallest counts.

pub mod axis_margins;
pub mod change;
pub mod json;
pub mod linear_axis;
pub mod margin;
pub mod mechanics;
pub mod sampled;
pub mod text;

#[cfg(test)]
mod tests;

pub use axis_margins::{AxisMargins, MarginError, MarginLimits};
pub use mechanics::Condition;
