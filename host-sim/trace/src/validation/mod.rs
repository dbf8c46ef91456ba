//! Tests of the effects found: limits of their parameters, and validation logs.
//!
//! [`confirmation`] drops effects of a [`fitted_axis`] until none is at a limit and none is refuted. Each effect is tested
//! twice: as it was added, and by removing it from the final model ([`refutation`]). Both tests compare the [`likelihood`] of
//! the validation logs. The remaining effects are reported as [`found_effect`].

pub mod common_noise;
pub mod confirmation;
pub mod declared_value;
pub mod fitted_axis;
pub mod found_effect;
pub mod likelihood;
pub mod misfit;
pub mod refutation;
pub mod tool_slopes;
