//! Step 3, the fit: [`fit()`] takes the data of an axis, and returns its declared model fitted within its tolerance.
//!
//! What later steps fit with is here, too:
//!
//! - [`scope`]: stages that are fitted together
//! - [`axis_model`], [`held_effects`], [`trim`], [`limits`]: free parameters, those that are not fitted, those of timing, and
//!   limits of their ranges
//! - [`fit_data`], [`residual`], [`exclusion`], [`bump_subtraction`]: residuals, and the parts excluded from them
//! - [`least_squares`], [`normal_equations`], [`intervals`], [`upstream`], [`scale_noise`]: solution and confidence intervals
//! - [`fitted_scope`], [`tables`]: what a fit to whole logs needs; tables of residuals
//! - [`scope_fit`], [`final_fit`], [`model_bias`]: fits scope by scope, and with the error of the simulation subtracted

pub mod axis_data;
pub mod axis_model;
pub mod baseline;
pub mod bump_subtraction;
pub mod declared_machine;
pub mod exclusion;
pub mod final_fit;
pub mod fit_data;
pub mod fitted_axis;
pub mod fitted_scope;
pub mod held_effects;
pub mod intervals;
pub mod least_squares;
pub mod limits;
pub mod model_bias;
pub mod normal_equations;
pub mod residual;
pub mod scale_noise;
pub mod scope;
pub mod scope_fit;
pub mod tables;
pub mod testable_scopes;
pub mod tool_bias;
pub mod total_mass;
pub mod trim;
pub mod unknown_friction;
pub mod upstream;

pub use baseline::{Baseline, fit};
