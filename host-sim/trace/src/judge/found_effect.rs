//! A found effect with its reported values.

use crate::fit::fit_data::FitAndValidationRms;
use model::effects::{Effect, Imitation, Stage};

/// A residual that stands out of the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remaining {
    /// Stage.
    pub stage: Stage,
    /// Residual of the fitted logs, in multiples of the noise.
    pub to_noise: f64,
}

/// A found effect with its reported values.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundEffect {
    /// The effect with its final parameters.
    pub effect: Effect,
    /// Half widths of the 95 % confidence intervals, in the order of [`Effect::parameters`].
    pub half_widths: Vec<f64>,
    /// Stage whose residual on the validation logs the effect reduces most.
    pub stage: Stage,
    /// Residual of this stage with the effects found before. If the effect reduces none beside these alone: that with all other
    /// effects, everything fitted again without the effect.
    pub before: FitAndValidationRms,
    /// Residual of this stage with the effect added to those.
    pub after: FitAndValidationRms,
    /// Effects that explain the logs as well: with one of them in the list, the effect is not certain.
    pub rivals: Vec<Effect>,
    /// What the logged channels do not tell apart from it: with one of them, the effect is not certain.
    pub imitations: Vec<Imitation>,
    /// What remains in its stage, if it stands out: another cause acts there, of which the effect may describe a part.
    pub remaining: Option<Remaining>,
}

impl FoundEffect {
    /// An effect with the half widths of its parameters, and the residuals of a stage without it and with it. Nothing speaks
    /// against it yet.
    #[must_use]
    pub fn new(
        (effect, half_widths): (Effect, Vec<f64>),
        stage: Stage,
        [before, after]: [FitAndValidationRms; 2],
    ) -> Self {
        let (rivals, imitations, remaining) = (Vec::new(), Vec::new(), None);
        Self { effect, half_widths, stage, before, after, rivals, imitations, remaining }
    }

    /// Whether nothing else explains the logs as well, and nothing stands out in its stage.
    #[must_use]
    pub fn is_certain(&self) -> bool {
        self.rivals.is_empty() && self.imitations.is_empty() && self.remaining.is_none()
    }

    /// Names of the rivals and imitations, each once.
    #[must_use]
    pub fn rival_names(&self) -> Vec<&'static str> {
        let mut names: Vec<&'static str> = self.rivals.iter().map(Effect::name).collect();
        names.extend(self.imitations.iter().map(|imitation| imitation.name));
        let mut known = std::collections::BTreeSet::new();
        names.retain(|name| known.insert(*name));
        names
    }

    /// Reduction of the residual on the validation logs, percent of the residual before. Negative: they neither show the effect,
    /// nor refute it. NaN: none of them has the channels of the stage.
    #[must_use]
    pub fn validate_reduction_percent(&self) -> f64 {
        let before = self.before.validate;
        // `f64::max` of a number and NaN is the number.
        if before.is_nan() {
            f64::NAN
        } else {
            100.0 * (1.0 - self.after.validate / before.max(f64::MIN_POSITIVE))
        }
    }

    /// Whether the interval of its size contains zero.
    #[must_use]
    pub fn may_be_zero(&self) -> bool {
        let size = self.effect.values().first().copied().unwrap_or(0.0);
        self.half_widths.first().is_some_and(|half_width| size.abs() <= *half_width)
    }
}
