//! What a residual consists of.
//!
//! [`residual_analysis`] finds the [`variable`] that explains most of it, with the means in [`binned_mean`]; [`empirical`]
//! makes a table of it; [`repeatability`] splits it by what repeats with the command; [`free_run`] is the error of the model
//! without feedback.

pub mod binned_mean;
pub mod empirical;
pub mod free_run;
pub mod repeatability;
pub mod residual_analysis;
pub mod variable;
