//! A local defect that an effect of any shape describes.

use crate::analysis::binned_mean::BinnedMean;
use crate::analysis::fitted_bump::fitted_bump;
use crate::analysis::variable::Variable;
use crate::fit::exclusion::{ExcludedPart, Exclusion};
use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::least_squares::{self, Fitted};
use crate::fit::scope::Scope;
use model::effects::Effect;

/// The bump that an effect of any shape over the position, the same in both directions, describes. One bump on a straight line is no
/// error of the pitch but a defect at its place, or a disturbance there. It must describe the logs about as well as the effect: half
/// a wave of a pitch error resembles a bump.
#[must_use]
pub fn local_defect(data: &FitData<'_>, fitted: &Fitted, scope: &Scope) -> Option<Exclusion> {
    let shaped = |effect: &Effect| {
        let is_asked = !effect.depends_on_direction() && scope.holds(effect);
        effect.describes_any_shape_of().filter(|_| is_asked)
    };
    let mut found = fitted.model.found().iter().enumerate();
    let (index, stage) = found.find_map(|(index, effect)| Some((index, shaped(effect)?)))?;
    let without = least_squares::fit_without(data, fitted, scope, index);
    let of_stage: Vec<&ResidualSeries> =
        without.residuals.iter().filter(|series| series.stage == stage).collect();
    let mean = BinnedMean::of(data, &of_stage, Variable::Position)?;
    let bump = fitted_bump(&mean, data.options.exclusion.min_map_bump_fraction)?;
    let exclusion = Exclusion { stage, part: ExcludedPart::Bump(bump) };
    let exclusions = [data.exclusions, &[exclusion]].concat();
    let beside_bump = FitData { exclusions: &exclusions, ..*data };
    let fit_beside_bump = least_squares::fit_without(&beside_bump, fitted, scope, index);
    let left = beside_bump.rms(&fit_beside_bump.residuals, stage);
    let left_by_shape = data.rms(&fitted.residuals, stage);
    (left <= data.options.exclusion.max_bump_residual * left_by_shape).then_some(exclusion)
}
