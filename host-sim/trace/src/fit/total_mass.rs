//! The total mass of an axis as fitted to a force, and how well that determines it.

use super::axis_model::AxisModel;
use super::fit_data::FitData;
use super::intervals::covariance;
use super::least_squares::Fitted;
use super::scope::Scope;

/// Half width of the 95 % confidence interval of the sum of the masses that a scope fits, kg.
#[must_use]
pub fn half_width_kg(data: &FitData<'_>, fitted: &Fitted, scope: &Scope) -> f64 {
    let masses = fitted.model.declared_values(scope).filter(|(_, key, _)| key.is_mass());
    let indices: Vec<usize> = masses.map(|(index, ..)| index).collect();
    covariance(data, fitted).half_width_of_sum(&indices)
}

/// The model of a fit, with its mass pinned as well as the fit determines it, see [`AxisModel::pin_mass`]. `scope` is the
/// scope of the search, `fitted_scope` that of the fit.
#[must_use]
pub fn pinned(data: &FitData<'_>, fitted: &Fitted, [scope, fitted_scope]: [&Scope; 2]) -> AxisModel {
    let mut model = fitted.model.clone();
    model.pin_mass(scope, half_width_kg(data, fitted, fitted_scope));
    model
}
