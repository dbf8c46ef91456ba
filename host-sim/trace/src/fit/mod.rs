//! The parameters of a model fitted to the residuals of its stages.
//!
//! [`scope`] says which stages are fitted together; [`axis_model`] has the free parameters, [`trim`] those of timing and
//! [`limits`] the ends of their ranges; [`fit_data`] and [`residual`] form the residuals, without what is in
//! [`exclusion`]; [`least_squares`] solves the [`normal_equations`], [`intervals`] gives the confidence intervals;
//! [`scope_fit`] fits scope after scope, and [`final_fit`] the whole without [`model_bias`].

pub mod axis_model;
pub mod exclusion;
pub mod final_fit;
pub mod fit_data;
pub mod intervals;
pub mod least_squares;
pub mod limits;
pub mod model_bias;
pub mod normal_equations;
pub mod residual;
pub mod scope;
pub mod scope_fit;
pub mod trim;
