//! Declared values with the results of a fit: which of them the logs put outside their tolerance.

use super::intervals::covariance;
use super::scope::Mechanics;
use super::scope_fit::ScopeFit;
use model::machine::nominal::Tolerated;

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
}

impl DeclaredValue {
    /// Deviation of the fitted value from the declared one, relative to the declared one.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        self.fitted / self.declared - 1.0
    }

    /// Whether the logs put the value outside its tolerance: the whole confidence interval is outside, on one side.
    #[must_use]
    pub fn is_beyond_tolerance(&self) -> bool {
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

/// The declared values that the mechanical fit moved, in the order of the keys.
#[must_use]
pub fn declared_values(fits: &[ScopeFit]) -> Vec<DeclaredValue> {
    let Some(fit) = fits.iter().find(|fit| fit.fitted_scope.mechanics == Mechanics::All) else {
        return Vec::new();
    };
    let (model, covariance) = (&fit.fitted.model, covariance(&fit.fitted));
    let at_bounds = model.at_bounds();
    let value = |(index, key, declared): (usize, &Tolerated, f64)| DeclaredValue {
        key: key.key,
        declared,
        fitted: (key.get)(&model.axis.settings).unwrap_or(declared),
        half_width: covariance.half_width(index),
        tolerance: model.tolerance(),
        is_at_bound: at_bounds.contains(&key.key),
        is_poorly_determined: key.is_poorly_determined(),
    };
    model.declared_values(&fit.fitted_scope).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_beyond_its_tolerance_if_its_whole_interval_is() {
        let mass = |fitted, half_width, is_at_bound| {
            let key = "table_mass_kg";
            let (declared, tolerance, is_poorly_determined) = (100.0, 0.1, false);
            DeclaredValue { key, declared, fitted, half_width, tolerance, is_at_bound, is_poorly_determined }
        };
        assert!(mass(123.0, 2.0, false).is_beyond_tolerance());
        assert!(mass(87.0, 2.0, false).is_beyond_tolerance());
        // 111 − 2 is within 110; 123 at a bound is not determined; 95 is within the tolerance.
        assert!(!mass(111.0, 2.0, false).is_beyond_tolerance());
        assert!(!mass(123.0, 2.0, true).is_beyond_tolerance());
        assert!(!mass(95.0, 0.1, false).is_beyond_tolerance());
        assert!((mass(123.0, 2.0, false).deviation() - 0.23).abs() < 1e-12);
    }
}
