//! Refinement of a pitch map after other effects were found.
//!
//! The number of knots of a map follows from the residual at the time when it is added, which other effects still disturb.

use super::residual_shape::shape;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{self, Fitted};
use crate::fit::model_bias::log_rms;
use crate::fit::scope::Scope;
use model::effects::Effect;

/// Largest number of refinements.
const MAX_REFINEMENTS: usize = 3;

/// The fit with a finer map, as long as the residual that the map leaves has a shape over the position that
/// cross-validation supports, and the finer map removes some of it.
#[must_use]
pub fn with_finer_map(data: &FitData<'_>, mut fitted: Fitted, scope: &Scope) -> Fitted {
    for _ in 0..MAX_REFINEMENTS {
        let Some(finer) = finer(data, &fitted, scope) else { break };
        let gain = log_rms(data, &fitted.residuals, scope) - log_rms(data, &finer.residuals, scope);
        if gain < data.options.search.min_gain() {
            break;
        }
        fitted = finer;
    }
    fitted
}

fn finer(data: &FitData<'_>, fitted: &Fitted, scope: &Scope) -> Option<Fitted> {
    let model = &fitted.model;
    let map = |effect: &Effect| match effect {
        Effect::PitchMap(map) if scope.holds(effect) => Some(map.clone()),
        _ => None,
    };
    let (index, map) = model.found().iter().enumerate().find_map(|(i, effect)| Some((i, map(effect)?)))?;
    let count = shape(data, &fitted.residuals, model.axis.settings.mechanics.lead_mm).pitch_knots?;
    let count = count.max(more(map.positions_mm.len())?);
    let finer = model.without(index).with(Effect::PitchMap(map.with_knots(count)));
    Some(least_squares::fit(data, &finer, scope, least_squares::STEPS))
}

/// Half as many knots again; `None` beyond the finest map.
fn more(knots: usize) -> Option<u32> {
    const FINEST: usize = 40;
    let count = knots + knots / 2;
    u32::try_from(count).ok().filter(|_| count <= FINEST)
}
