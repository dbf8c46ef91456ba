//! Steady-state friction maps: one row a run at constant speed, mean torque or force against mean speed.
//!
//! Declared is Coulomb and viscous friction, the same in both directions. The search adds one [`term::Term`] after the
//! other as long as runs that were left out of the fit support it.
//!
//! | module | what it does |
//! |---|---|
//! | [`map`], `read` | the runs, and their CSV file |
//! | [`term`], [`law`] | friction as a function of velocity |
//! | [`fit`] | weighted least squares of a law |
//! | [`ranges`] | errors on ranges of speed that were left out of the fit |
//! | [`selection`] | forward selection of terms, backward elimination at the end |
//! | [`mod@explain`] | the result: both laws, their errors, what could not be tested |
//! | [`residual_analysis`] | what the residual depends on |
//! | [`parameters`], [`json`] | the result's numbers with their units and intervals, and as JSON |
//!
//! This is a crate beside the tracer and not a part of it, since it answers the same question by another method. A
//! map has no time: there is no machine to integrate, no stage, no correlation between samples. Its rows are
//! independent means with known standard errors, few enough that F tests and leave-one-out errors apply; the tracer
//! has long correlated series and judges by blocks of them. Shared with the tracer are the laws of speed
//! ([`model::friction_law`]), the reader of tables ([`files::table`]), the statistics ([`numerics`]), and in `report`
//! the parts of pages.

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
