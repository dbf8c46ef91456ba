//! Uncertainty that a fit passes on to a later one, which takes its results as known.
//!
//! The motor stage is fitted with the masses, friction and stiffness that table and force determine. With their covariance V₁,
//! the later parameters θ₂ move by dθ₂ = −H₂⁻¹·J₂ᵀ·W·dr, where dr is the change of the later residuals over a step of one
//! standard deviation along each principal direction of V₁. The squares of these shifts add to the variances of θ₂. The tool is
//! predicted from the measured table, whose noise shifts a mode ([`super::scale_noise`]).

use nalgebra::{DVector, SymmetricEigen};
use rayon::prelude::*;

use super::axis_model::AxisModel;
use super::fit_data::FitData;
use super::intervals::{Covariance, covariance};
use super::least_squares::Fitted;
use super::scale_noise;
use super::scope::{Mechanics, Scope};
use super::scope_fit::ScopeFit;
use model::effects::Stage;

/// Principal directions with less than this fraction of the largest variance in units of the parameters' steps are left out.
const MIN_VARIANCE: f64 = 1e-6;

/// Covariance of a fit, with the uncertainty of the declared values and effects that an earlier fit determined. `data` are the
/// fit logs, `model` is the model with the results of both.
#[must_use]
pub fn covariance_after(
    data: &FitData<'_>,
    fits: &[ScopeFit],
    model: &AxisModel,
    (scope, fitted): (&Scope, &Fitted),
) -> Covariance {
    let own = covariance(data, fitted).with_values_at_bounds();
    let earlier = fits.iter().find(|fit| fit.fitted_scope.mechanics == Mechanics::All);
    let is_later =
        |earlier: &&ScopeFit| scope.mechanics == Mechanics::MotorMass && earlier.fitted_scope != *scope;
    if let Some(earlier) = earlier.filter(is_later) {
        let shifts = shifts(data, earlier, model, (scope, fitted, &own));
        return own.with_shifts(&shifts);
    }
    let shift = own.shift_by(&scale_noise::gradient(data, scope, fitted));
    own.with_half_width(&shift)
}

/// The shifts of the later parameters.
fn shifts(
    data: &FitData<'_>,
    earlier: &ScopeFit,
    model: &AxisModel,
    (scope, fitted, own): (&Scope, &Fitted, &Covariance),
) -> Vec<DVector<f64>> {
    let from = &earlier.fitted_scope;
    let parameters = model.free_parameters(from);
    let before = covariance(data, &earlier.fitted);
    if before.parameters() != parameters.len() {
        return Vec::new();
    }
    // The later fit determines the mass of the motor itself. The zero of the table, which comes first, changes the motor if the
    // loop uses the scale: in motion at one speed it cannot be told from a late reading. The instants of the channels do not.
    let declared: Vec<usize> = model.declared_values(from).map(|(index, ..)| index).collect();
    let (Some(&mass), Some(&last)) = (declared.first(), declared.last()) else { return Vec::new() };
    let zero = usize::from(from.stages.contains(&Stage::Table));
    let indices: Vec<usize> = (0..zero).chain(mass + 1..=last).chain(last + 1..parameters.len()).collect();
    let steps = DVector::from_iterator(indices.len(), indices.iter().map(|&i| parameters[i].coordinate.step));
    let scaled = before.of(&indices).component_div(&(&steps * steps.transpose()));
    let principal = SymmetricEigen::new(scaled);
    let largest = principal.eigenvalues.max();
    let residuals = data.residuals(model, scope);
    let directions: Vec<usize> =
        (0..indices.len()).filter(|&k| principal.eigenvalues[k] > MIN_VARIANCE * largest).collect();
    let shift = |k: usize| {
        let direction = principal.eigenvectors.column(k) * principal.eigenvalues[k].sqrt();
        let mut moved: Vec<f64> = parameters.iter().map(|parameter| parameter.coordinate.value).collect();
        for (position, &index) in indices.iter().enumerate() {
            moved[index] += direction[position] * steps[position];
        }
        let moved = data.residuals(&model.at(from, &moved), scope);
        let mut gradient = DVector::zeros(fitted.parameters.len());
        for (index, (series, moved)) in residuals.iter().zip(&moved).enumerate() {
            let changes = moved.values.iter().zip(&series.values).map(|(moved, value)| moved - value);
            fitted.add_gradient(&mut gradient, index, &changes);
        }
        own.shift_by(&gradient)
    };
    directions.into_par_iter().map(shift).collect()
}
