//! A found effect with its reported values.

use crate::fit::fit_data::FitAndValidationRms;
use model::effects::{Effect, Stage};

/// A found effect with its reported values.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundEffect {
    /// The effect with its final parameters.
    pub effect: Effect,
    /// Half widths of the 95 % confidence intervals, in the order of [`Effect::parameters`].
    pub half_widths: Vec<f64>,
    /// Stage whose residual on the validation logs the effect reduces most.
    pub stage: Stage,
    /// Residual of this stage with the effects found before.
    pub before: FitAndValidationRms,
    /// Residual of this stage with the effect added.
    pub after: FitAndValidationRms,
    /// Effects that explain the logs as well: with one of them in the list, the effect is not certain.
    pub rivals: Vec<Effect>,
}

impl FoundEffect {
    /// Reduction of the residual on the validation logs, percent of the residual before.
    #[must_use]
    pub fn validate_reduction_percent(&self) -> f64 {
        100.0 * (1.0 - self.after.validate / self.before.validate.max(f64::MIN_POSITIVE))
    }

    /// Whether the interval of its size contains zero.
    #[must_use]
    pub fn may_be_zero(&self) -> bool {
        let size = self.effect.values().first().copied().unwrap_or(0.0);
        self.half_widths.first().is_some_and(|half_width| size.abs() <= *half_width)
    }
}
