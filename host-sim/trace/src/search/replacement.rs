//! A model with other effects in the place of some that were found.

use super::held_out::{compare, scores};
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{self, Fitted};
use crate::fit::scope::Scope;

/// The fit from another start, if on held-out data a stage gains significantly and none loses significantly; otherwise `base`.
#[must_use]
pub fn better(data: &FitData<'_>, base: Fitted, start: &AxisModel, scope: &Scope) -> Fitted {
    let options = &data.options.search;
    let other = least_squares::fit(data, start, scope, least_squares::STEPS);
    let stages = compare(&scores(&base), &scores(&other), &scope.stages, options);
    let gains = stages.iter().any(|c| c.t > options.chance_t && c.reduction >= options.min_reduction);
    let loses = stages.iter().any(|c| c.t <= -options.chance_t && c.reduction <= -options.min_reduction);
    if gains && !loses { other } else { base }
}
