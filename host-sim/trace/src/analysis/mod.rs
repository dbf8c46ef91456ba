//! Analysis of the remaining residuals.
//!
//! - [`residual_analysis`]: the [`variable`] that explains most of a residual, by the means in [`binned_mean`]
//! - [`empirical`]: the residual as a table over this variable
//! - [`law`]: the residual as an equation of a few variables
//! - [`repeatability`]: the repeatable and the non-repeatable part of a residual
//! - [`free_run`]: the error of the model without feedback

pub mod binned_mean;
pub mod empirical;
pub mod fitted_bump;
pub mod free_run;
pub mod law;
pub mod repeatability;
pub mod residual_analysis;
pub mod variable;
