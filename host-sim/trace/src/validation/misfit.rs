//! Machine files of another machine.
//!
//! If the masses, stiffness or friction of a file are far from those of the machine, each effect that compensates a part of
//! the difference reduces the residuals, and none of them is real. The signs are residuals of the declared
//! model above the noise in most stages that depend on the mechanics, and several declared values that the fit with
//! effects has moved to the end of their range.

use super::declared_value::DeclaredValue;
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::scope::{Mechanics, Scope};
use model::effects::Stage;

/// Number of declared values at the end of their range from which they are a sign.
const MIN_AT_BOUNDS: usize = 2;
/// Residual that is a sign, as a fraction of the largest one that a model which describes its logs may leave: 2.5 times the
/// noise. With the values at the end of their range, the model is as near to the logs as it can come.
const MIN_RESIDUAL: f64 = 0.05;

/// Whether a machine file is that of another machine: by its model without effects, and its values as fitted with effects.
#[must_use]
pub fn is_of_another_machine(
    data: &FitData<'_>,
    model: &AxisModel,
    values: &[DeclaredValue],
    scopes: &[Scope],
) -> bool {
    let at_bounds = values.iter().filter(|value| value.is_undetermined()).count();
    at_bounds >= MIN_AT_BOUNDS && leaves_gross_residuals(data, model, scopes)
}

/// Whether a model fails to describe most of the stages that depend on the mechanics, and at least two if there are two.
fn leaves_gross_residuals(data: &FitData<'_>, model: &AxisModel, scopes: &[Scope]) -> bool {
    let mut are_gross = Vec::new();
    for scope in scopes.iter().filter(|scope| scope.mechanics != Mechanics::None) {
        let residuals = data.residuals(model, scope);
        let is_gross =
            |&stage: &Stage| data.rms(&residuals, stage) > MIN_RESIDUAL * data.max_described(model, stage);
        are_gross.extend(scope.stages.iter().map(is_gross));
    }
    let gross = are_gross.iter().filter(|is_gross| **is_gross).count();
    gross >= are_gross.len().clamp(1, 2) && 2 * gross > are_gross.len()
}
