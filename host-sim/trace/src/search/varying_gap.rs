//! A backlash that varies along the travel.
//!
//! It is a `backlash`, its mean, with a `pitch_map` whose curves for both directions differ. Where the gap varies by a large part
//! of its mean, a constant one makes some logs worse and is refused, so that the map would not be tried. Both are then tried
//! together.

use super::residual_shape::shape;
use super::slope_of_map::with_slope_of_map;
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::Fitted;
use model::effects::{Effect, PitchMap};

/// The model of a fit with a backlash, with a map for each direction; `None` if the candidate is no backlash, or the residual
/// that it leaves does not differ between the directions over the position.
#[must_use]
pub fn with_map_of_gap(data: &FitData<'_>, fitted: &Fitted, candidate: &Effect) -> Option<AxisModel> {
    let model = &fitted.model;
    let has_map = model.axis.effect.iter().any(|effect| matches!(effect, Effect::PitchMap(_)));
    if has_map || !matches!(candidate, Effect::Backlash(_)) {
        return None;
    }
    let count = shape(data, &fitted.residuals, model.axis.settings.mechanics.lead_mm).pitch_knots_each_way?;
    let zeros = vec![0.0; 2];
    let ends = PitchMap {
        positions_mm: data.travel_mm().to_vec(),
        error_um: zeros.clone(),
        error_negative_um: Some(zeros),
    };
    Some(with_slope_of_map(model, Effect::PitchMap(ends.with_knots(count))))
}
