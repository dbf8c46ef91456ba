//! Declared values with the results of a fit: which of them the logs put outside their tolerance.
//!
//! A fitted value outside the tolerance is no proof: a fit to a few logs may move a value that these hardly determine. As
//! with an effect, the validation logs decide. The value is bounded by its tolerance, and everything is fitted again; if this
//! makes the validation logs significantly worse, the value is outside.

use super::likelihood::refuting_loss;
use crate::fit::fit_data::FitData;
use crate::fit::fitted_axis::FittedAxis;
use crate::fit::intervals::covariance;
use crate::fit::least_squares;
use crate::fit::scope::Mechanics;
use crate::fit::scope_fit::ScopeFit;
use model::axis::{KeyNames, Tolerated, is_mass};
use model::effects::Stage;
use model::machine::rotary;

/// A declared value with its fit.
#[derive(Clone, Debug, PartialEq)]
pub struct DeclaredValue {
    /// Key in the machine file.
    pub key: &'static str,
    /// Declared value, in the unit of the key; of a file that a trace wrote, the nominal value.
    pub declared: f64,
    /// Fitted value.
    pub fitted: f64,
    /// Half width of the 95 % confidence interval of the fitted value.
    pub half_width: f64,
    /// Declared tolerance, relative.
    pub tolerance: f64,
    /// Whether the fit ended at a bound of the range of the value, which is then not determined.
    pub is_at_bound: bool,
    /// See [`Tolerated::is_poorly_determined`].
    pub is_poorly_determined: bool,
    /// Whether the logs put the value outside its tolerance.
    pub is_beyond_tolerance: bool,
}

impl DeclaredValue {
    /// The value under the key and in the unit of a file with these names of keys.
    #[must_use]
    pub fn as_written(&self, names: KeyNames) -> Self {
        let written = |value| rotary::written(self.key, value, names).1;
        let (key, declared) = rotary::written(self.key, self.declared, names);
        Self {
            key,
            declared,
            fitted: written(self.fitted),
            half_width: written(self.half_width),
            ..self.clone()
        }
    }

    /// Deviation of the fitted value from the declared one, relative to the declared one.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        self.fitted / self.declared - 1.0
    }

    /// Whether the logs determine the value: it is not at a bound, and its interval is narrower than its tolerance.
    #[must_use]
    pub fn is_determined(&self) -> bool {
        !self.is_at_bound && !self.is_poorly_determined && self.half_width < self.tolerance * self.declared
    }

    /// Whether it follows from the small stretch between motor and table.
    #[must_use]
    pub fn is_of_division(&self) -> bool {
        is_mass(self.key) || ["stiffness_n_per_um", "motor_coulomb_n"].contains(&self.key)
    }

    /// Whether it is a setting of the controller, on which the scale of the logged force has no influence.
    #[must_use]
    pub fn is_of_controller(&self) -> bool {
        Tolerated::with_key(self.key).is_some_and(|key| key.is_of_controller)
    }

    /// Whether the whole confidence interval is outside the tolerance, on one side.
    fn is_fitted_beyond_tolerance(&self) -> bool {
        let excess = (self.fitted - self.declared).abs() - self.tolerance * self.declared;
        !self.is_at_bound && excess > self.half_width
    }

    /// Whether the search for the value ended at a bound although the motions of most logs would determine it: the declared
    /// value is grossly wrong, or the logs do not determine it.
    #[must_use]
    pub fn is_undetermined(&self) -> bool {
        self.is_at_bound && !self.is_poorly_determined
    }
}

/// The declared values of the mechanical fit, then the settings of the controller from the fit to the motor, in the order of the keys.
#[must_use]
pub fn declared_values(data: [&FitData<'_>; 2], axis: &FittedAxis) -> Vec<DeclaredValue> {
    let fits_mechanics =
        |fit: &&ScopeFit| matches!(fit.fitted_scope.mechanics, Mechanics::All | Mechanics::Values);
    let fits_settings = |fit: &&ScopeFit| fit.fitted_scope.stages.contains(&Stage::Motor);
    let mut values = Vec::new();
    if let Some(fit) = axis.fits.iter().rfind(fits_mechanics) {
        values.extend(values_of(data, axis, fit, |key| !key.is_of_controller));
    }
    if let Some(fit) = axis.fits.iter().rfind(fits_settings) {
        values.extend(values_of(data, axis, fit, |key| key.is_of_controller));
    }
    values
}

/// The declared values of a fit that are wanted.
fn values_of(
    data: [&FitData<'_>; 2],
    axis: &FittedAxis,
    fit: &ScopeFit,
    is_wanted: impl Fn(&Tolerated) -> bool,
) -> Vec<DeclaredValue> {
    if !fit.fitted.model.declared_values(&fit.fitted_scope).any(|(_, key, _)| is_wanted(key)) {
        return Vec::new();
    }
    let (model, covariance) = (&fit.fitted.model, covariance(data[0], &fit.fitted));
    let at_bounds = model.at_bounds();
    // Motor and force show the sum of the masses and of the friction; how it is divided follows from the small stretch of the screw.
    // Without the table, or with noise above it, as of a coarse encoder or of instants that jitter, errors of the readings decide;
    // without the gains of the loop, the force between the rows of the log does, which is not known.
    let has_table = fit.fitted_scope.stages.contains(&Stage::Table);
    let has_loop = axis.fits.iter().any(|fit| fit.fitted_scope.stages.contains(&Stage::Motor));
    let is_elastic = !model.axis.settings.is_rigid();
    let shows_division = has_table && has_loop;
    let value = |(index, key, declared): (usize, &'static Tolerated, f64)| {
        let fitted = DeclaredValue {
            key: key.key,
            declared,
            fitted: (key.get)(&model.axis.settings).unwrap_or(declared),
            half_width: covariance.half_width(index),
            tolerance: model.tolerance_of(key),
            is_at_bound: at_bounds.contains(&key.key),
            is_poorly_determined: key.is_poorly_determined(),
            is_beyond_tolerance: false,
        };
        let is_precise = fitted.half_width < 0.5 * fitted.tolerance * declared;
        let is_beyond_tolerance = (shows_division && is_precise || !(is_elastic && fitted.is_of_division()))
            && fitted.is_fitted_beyond_tolerance()
            && is_confirmed(data, fit, key);
        DeclaredValue { is_beyond_tolerance, ..fitted }
    };
    model.declared_values(&fit.fitted_scope).filter(|(_, key, _)| is_wanted(key)).map(value).collect()
}

/// Number of determined values from which one factor for all of them is one cause, and no coincidence.
const MIN_COMMON: usize = 3;

/// The mean ratio of fitted to declared value of all values that the logs determine.
#[must_use]
pub fn mean_factor(values: &[DeclaredValue]) -> f64 {
    let determined = values.iter().filter(|value| value.is_determined() && !value.is_of_controller());
    numerics::mean(determined.map(|value| value.fitted / value.declared))
}

/// Whether all values that the logs determine deviate in one direction, some of them beyond their tolerance, and none beyond it beside
/// their mean factor. Masses, stiffness and friction scale with the logged force: its scale is wrong (torque constant), or all of
/// them are.
#[must_use]
pub fn are_off_by_one_factor(values: &[DeclaredValue]) -> bool {
    let is_mechanical = |value: &&DeclaredValue| value.is_determined() && !value.is_of_controller();
    let determined: Vec<&DeclaredValue> = values.iter().filter(is_mechanical).collect();
    let is_any_beyond = determined.iter().any(|value| value.is_fitted_beyond_tolerance());
    let factor = mean_factor(values);
    let is_common = |value: &&DeclaredValue| {
        let ratio = value.fitted / value.declared;
        (ratio > 1.0) == (factor > 1.0) && (ratio / factor - 1.0).abs() <= value.tolerance
    };
    determined.len() >= MIN_COMMON && is_any_beyond && determined.iter().all(is_common)
}

/// Whether the validation logs refute a model with a value bounded by its tolerance.
fn is_confirmed([fit_data, validate]: [&FitData<'_>; 2], fit: &ScopeFit, key: &Tolerated) -> bool {
    let ScopeFit { fitted_scope, fitted, exclusions, .. } = fit;
    let data = FitData { exclusions, ..*fit_data };
    let start = fitted.model.within_tolerance(key);
    let bounded = least_squares::fit(&data, &start, fitted_scope, least_squares::STEPS).model;
    let [free, bounded] = [&fitted.model, &bounded].map(|model| validate.residuals(model, fitted_scope));
    // As much as an effect must gain: a smaller loss may be the tracer's own error, which both parts of a log share.
    let min_gain = fit_data.options.search.min_gain();
    refuting_loss(validate, [&free, &bounded]).is_some_and(|gain| gain < -min_gain)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values 1.12 times the declared ones, within their tolerance of that: one cause. With one that is below the declared value, or with
    /// two values alone, they are not.
    #[test]
    fn values_off_by_one_factor_have_one_cause() {
        let value = |key, ratio: f64| DeclaredValue {
            key,
            declared: 100.0,
            fitted: 100.0 * ratio,
            half_width: 0.5,
            tolerance: 0.1,
            is_at_bound: false,
            is_poorly_determined: false,
            is_beyond_tolerance: false,
        };
        let four = [
            ("motor_mass_kg", 1.12),
            ("table_mass_kg", 1.13),
            ("coulomb_n", 1.10),
            ("viscous_n_s_per_m", 1.13),
        ];
        let mut values: Vec<DeclaredValue> = four.into_iter().map(|(key, ratio)| value(key, ratio)).collect();
        assert!(are_off_by_one_factor(&values) && (mean_factor(&values) - 1.12).abs() < 1e-9);
        assert!(!are_off_by_one_factor(&values[..2]));
        values[3].fitted = 99.0;
        assert!(!are_off_by_one_factor(&values));
        // All within their tolerance.
        for value in &mut values {
            value.fitted = 105.0;
        }
        assert!(!are_off_by_one_factor(&values));
    }

    #[test]
    fn a_value_is_beyond_its_tolerance_if_its_whole_interval_is() {
        let mass = |fitted, half_width, is_at_bound| {
            let key = "table_mass_kg";
            DeclaredValue {
                key,
                declared: 100.0,
                fitted,
                half_width,
                tolerance: 0.1,
                is_at_bound,
                is_poorly_determined: false,
                is_beyond_tolerance: false,
            }
        };
        assert!(mass(123.0, 2.0, false).is_fitted_beyond_tolerance());
        assert!(mass(87.0, 2.0, false).is_fitted_beyond_tolerance());
        // 111 − 2 is within 110; 123 at a bound is not determined; 95 is within the tolerance.
        assert!(!mass(111.0, 2.0, false).is_fitted_beyond_tolerance());
        assert!(!mass(123.0, 2.0, true).is_fitted_beyond_tolerance());
        assert!(!mass(95.0, 0.1, false).is_fitted_beyond_tolerance());
        assert!((mass(123.0, 2.0, false).deviation() - 0.23).abs() < 1e-12);
    }
}
