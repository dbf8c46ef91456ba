//! Machine files of another machine.
//!
//! If the masses, stiffness or friction of a file are far from those of the machine, each effect that compensates a part of
//! the difference reduces the residuals, and none of them is real. There are two signs:
//!
//! - residuals of the declared model above the noise in most stages that depend on the mechanics, and several declared values
//!   that the fit with effects has moved to the end of their range;
//! - a stage that depends on the mechanics and that the model does not describe even with effects, and several parameters that
//!   contradict the file: at the end of their range, or outside their tolerance.
//!
//! Rows that were read at instants that jitter have both signs, too, on the machine of the file.

use super::common_noise;
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

/// Number of parameters that contradict a file, of which at least one is at the end of its range, from which they are a sign
/// beside a stage that the model does not describe. Up to two declared values of a machine may well be outside their tolerance.
const MIN_CONTRADICTIONS: usize = 3;

/// What the fit to an axis says about its machine file.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// The declared model, fitted, and the model with effects.
    pub models: [&'a AxisModel; 2],
    /// The declared values as fitted with effects.
    pub values: &'a [DeclaredValue],
    /// Number of effects that were refused at the end of their range.
    pub refused: usize,
}

/// Whether a machine file is that of another machine.
#[must_use]
pub fn is_of_another_machine(data: &FitData<'_>, evidence: Evidence<'_>, scopes: &[Scope]) -> bool {
    let Evidence { models: [declared, with_effects], values, refused } = evidence;
    if common_noise::is_left_out(data, with_effects, scopes) {
        return false;
    }
    let at_bounds = values.iter().filter(|value| value.is_undetermined()).count();
    if at_bounds >= MIN_AT_BOUNDS && leaves_gross_residuals(data, declared, scopes) {
        return true;
    }
    let at_end = at_bounds + refused;
    let beyond = values.iter().filter(|value| value.is_beyond_tolerance).count();
    at_end > 0 && at_end + beyond >= MIN_CONTRADICTIONS && is_undescribed(data, with_effects, scopes)
}

/// Whether a model does not describe a stage that depends on the mechanics.
fn is_undescribed(data: &FitData<'_>, model: &AxisModel, scopes: &[Scope]) -> bool {
    scopes.iter().filter(|scope| scope.mechanics != Mechanics::None).any(|scope| {
        let residuals = data.residuals(model, scope);
        scope.stages.iter().any(|&stage| data.rms(&residuals, stage) > data.max_described(model, stage))
    })
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
