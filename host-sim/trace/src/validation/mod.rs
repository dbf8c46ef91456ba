//! The effects found, tested against the limits of their parameters and against the validation logs.
//!
//! [`confirmation`] drops effects of a [`fitted_axis`] until none is at a limit and none is refuted: as it was added, or by
//! [`refutation`], which removes it from the whole. Both compare the [`likelihood`] of the validation logs. What remains is
//! [`found_effect`].

pub mod confirmation;
pub mod fitted_axis;
pub mod found_effect;
pub mod likelihood;
pub mod refutation;
