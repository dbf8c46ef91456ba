//! A local defect that a pitch map describes.

use crate::analysis::binned_mean::BinnedMean;
use crate::analysis::fitted_bump::fitted_bump;
use crate::analysis::variable::Variable;
use crate::fit::exclusion::{ExcludedPart, Exclusion};
use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::least_squares::{self, Fitted};
use crate::fit::scope::Scope;
use model::effects::{Effect, Stage};

/// The bump that a map of the screw, the same in both directions, describes. A map may have any shape; one bump on a straight
/// line is no error of the pitch but a defect at its place, or a disturbance there. It must describe the logs about as well as the
/// map: half a wave of a pitch error resembles a bump.
#[must_use]
pub fn bump_in_place_of_map(data: &FitData<'_>, fitted: &Fitted, scope: &Scope) -> Option<Exclusion> {
    let is_map = |effect: &Effect| match effect {
        Effect::PitchMap(map) => map.error_negative_um.is_none() && scope.holds(effect),
        _ => false,
    };
    let index = fitted.model.found().iter().position(is_map)?;
    let without = least_squares::fit_without(data, fitted, scope, index);
    let of_table: Vec<&ResidualSeries> =
        without.residuals.iter().filter(|series| series.stage == Stage::Table).collect();
    let mean = BinnedMean::of(data, &of_table, Variable::Position)?;
    let bump = fitted_bump(&mean, data.options.exclusion.min_map_bump_fraction)?;
    let exclusion = Exclusion { stage: Stage::Table, part: ExcludedPart::Bump(bump) };
    let exclusions = [data.exclusions, &[exclusion]].concat();
    let beside_bump = FitData { exclusions: &exclusions, ..*data };
    let fit_beside_bump = least_squares::fit_without(&beside_bump, fitted, scope, index);
    let left = beside_bump.rms(&fit_beside_bump.residuals, Stage::Table);
    let left_by_map = data.rms(&fitted.residuals, Stage::Table);
    (left <= data.options.exclusion.max_bump_residual * left_by_map).then_some(exclusion)
}
