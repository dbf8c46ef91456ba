//! An effect that was found, as it is reported.

use crate::fit::fit_data::FitAndValidationRms;
use model::effects::{Effect, Stage};

/// An effect that was found, as it is reported.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundEffect {
    /// The effect with its final parameters.
    pub effect: Effect,
    /// Half widths of the 95 % confidence intervals, in the order of [`Effect::parameters`].
    pub half_widths: Vec<f64>,
    /// Stage whose residual on the validation logs it reduces most.
    pub stage: Stage,
    /// That stage's residual with the effects found before it.
    pub before: FitAndValidationRms,
    /// That stage's residual with it.
    pub after: FitAndValidationRms,
}

impl FoundEffect {
    /// By how much it lowers the residual on the validation logs, percent of the residual before it.
    #[must_use]
    pub fn validate_reduction_percent(&self) -> f64 {
        100.0 * (1.0 - self.after.validate / self.before.validate.max(f64::MIN_POSITIVE))
    }
}
