//! Steady-state friction maps: mean torque or force over mean speed, one row per run at constant speed.
//!
//! The declared law is Coulomb and viscous friction, equal in both directions. The search adds one [`term::Term`] at a time,
//! as long as runs that were left out of the fit support it.
//!
//! | module | contents |
//! |---|---|
//! | [`map`], `read` | the runs, and their CSV file |
//! | [`term`], [`law`] | friction as a function of velocity |
//! | [`fit`] | weighted least squares of a law |
//! | [`ranges`] | errors on ranges of speed that were left out of the fit |
//! | [`selection`] | forward selection of terms, backward elimination at the end |
//! | [`mod@explain`] | the result: both laws, their errors, terms that could not be tested |
//! | [`residual_analysis`] | dependence of the residual on velocity and time |
//! | [`parameters`], [`json`] | parameters with units and intervals; the result as JSON |
//!
//! The crate is separate from the tracer, as it uses another method. A map has no time: no machine is integrated, there are
//! no stages and no correlated samples. Its rows are independent means with known standard errors, few enough for F tests
//! and leave-one-out errors, while the tracer compares blocks of long correlated series. Both share the friction laws
//! ([`model::friction_law`]), the reader of tables ([`files::table`]), the statistics ([`numerics`]), and parts of the pages
//! in `report`.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod explain;
pub mod fit;
pub mod json;
pub mod law;
pub mod map;
pub mod parameters;
pub mod ranges;
mod read;
pub mod residual_analysis;
pub mod selection;
pub mod term;

pub use explain::{Explanation, explain};
pub use map::FrictionMap;

#[cfg(test)]
mod tests;
