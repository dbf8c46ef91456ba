//! Check that a candidate does not take the place of the mass.
//!
//! On an arc that does not reverse, x″ = −ω²·(x − x₀): the force of a mass and that of a spring are alike, and so are, over a
//! short time, those of a mass and of a friction that changes. A candidate that only makes room for another mass reduces the
//! residual by chance; with it, the logs no longer determine the mass.

use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::Fitted;
use crate::fit::scope::{Mechanics, Scope};
use crate::fit::total_mass::half_width_kg;
use model::axis::is_mass;

/// Half width of the total mass from which it is not determined, as a fraction of its tolerance.
const MAX_HALF_WIDTH: f64 = 0.5;

/// Whether a fit with a candidate moves a mass to the end of its range, or leaves the total mass undetermined, while the fit
/// without the candidate does not.
#[must_use]
pub fn takes_place_of_mass(data: &FitData<'_>, without: &Fitted, with: &Fitted, scope: &Scope) -> bool {
    if scope.mechanics != Mechanics::All || without.model.mass_tolerance() <= 0.0 {
        return false;
    }
    let is_undetermined = |fit: &Fitted| {
        let max_kg = MAX_HALF_WIDTH * fit.model.mass_tolerance() * fit.model.nominal_mass_kg();
        has_mass_at_end(&fit.model) || half_width_kg(data, fit, scope) > max_kg
    };
    is_undetermined(with) && !is_undetermined(without)
}

/// Whether a mass is at the end of its range, unless this is its tolerance.
fn has_mass_at_end(model: &AxisModel) -> bool {
    !model.has_bounds() && model.at_bounds().into_iter().any(is_mass)
}
