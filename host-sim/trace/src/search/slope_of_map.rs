//! The slope of a pitch map.
//!
//! A map has no slope of its own: that is the effect `pitch_progressive`. A screw with an error over the position rarely has
//! none, so that a map is added together with a slope, and the slope is dropped again if its interval contains zero. Judged
//! alone, before the map, the slope may make a log worse.

use crate::fit::axis_model::AxisModel;
use model::effects::{Effect, PitchProgressive};

/// The model with a candidate, and with a slope before it if the candidate is a pitch map and the model has no slope.
#[must_use]
pub fn with_slope_of_map(model: &AxisModel, candidate: Effect) -> AxisModel {
    let has_slope = model.axis.effect.iter().any(is_slope);
    if matches!(candidate, Effect::PitchMap(_)) && !has_slope {
        return model.with(Effect::PitchProgressive(PitchProgressive::default())).with(candidate);
    }
    model.with(candidate)
}

/// Whether an effect is the slope that belongs to a map of the same model.
#[must_use]
pub fn is_slope_of_map(effect: &Effect, found: &[Effect]) -> bool {
    is_slope(effect) && found.iter().any(|other| matches!(other, Effect::PitchMap(_)))
}

fn is_slope(effect: &Effect) -> bool {
    matches!(effect, Effect::PitchProgressive(_))
}
