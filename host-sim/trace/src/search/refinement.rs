//! Refinement of effects after others were found.
//!
//! The resolution of an effect follows from the residual at the time when it is added, which other effects still disturb.

use super::residual_shape::shape;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{self, Fitted};
use crate::fit::model_bias::log_rms;
use crate::fit::scope::Scope;

/// Largest number of refinements.
const MAX_REFINEMENTS: usize = 3;

/// The fit with a finer resolution, as long as the residual that an effect leaves has a shape over the position that
/// cross-validation supports, and the finer one removes some of it.
#[must_use]
pub fn refined(data: &FitData<'_>, mut fitted: Fitted, scope: &Scope) -> Fitted {
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
    let residual = || shape(data, &fitted.residuals, scope, &model.axis.settings.mechanics);
    let mut found = model.found().iter().enumerate().filter(|(_, effect)| scope.holds(effect));
    let (index, refined) = found.find_map(|(index, effect)| Some((index, effect.refined(&residual)?)))?;
    let finer = model.without(index).with(refined);
    Some(least_squares::fit(data, &finer, scope, least_squares::STEPS))
}
