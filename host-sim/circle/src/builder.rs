//! What parts are made of: coefficients with their errors.

use super::measured::Measured;
use super::part::{Detail, Frame, Name, Part};
use super::samples::Samples;
use super::selection::Fitted;
use super::term::Term;

/// Half width of a 95 % interval in standard errors.
const Z: f64 = 1.96;

/// Smallest coefficient that is reported, in standard errors: of a dozen that are zero, one in a hundred circles shows one.
const MIN_ERRORS: f64 = 3.3;

/// A value and its standard error, in the same unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimate {
    pub value: f64,
    pub error: f64,
}

impl Estimate {
    /// Whether it is clear of zero.
    pub fn is_found(self) -> bool {
        self.value.abs() > MIN_ERRORS * self.error
    }

    /// 95 % interval.
    pub fn ci95(self) -> [f64; 2] {
        [self.value - Z * self.error, self.value + Z * self.error]
    }

    /// Value and error times a factor.
    pub fn times(self, factor: f64) -> Self {
        Self { value: factor * self.value, error: factor.abs() * self.error }
    }

    /// A figure of a part.
    pub fn detail(self, key: &'static str) -> Detail {
        Detail { key, value: self.value, ci95: Some(self.ci95()) }
    }
}

/// What parts are made of.
pub(crate) struct Builder<'a> {
    pub measured: &'a Measured,
    pub samples: &'a Samples,
    pub fitted: &'a Fitted,
    pub frame: Frame,
}

impl Builder<'_> {
    /// A coefficient, µm.
    pub fn coefficient(&self, term: Term) -> Option<Estimate> {
        let index = self.fitted.index(term)?;
        let error = self.fitted.covariance.variance(&[(index, 1.0)]).sqrt();
        Some(Estimate { value: self.fitted.fit.coefficients[index], error })
    }

    /// Name of both axes.
    pub fn both_axes(&self) -> String {
        self.measured.axes.concat()
    }
}

/// A part of a range, µm, without rivals and details.
pub(crate) fn part(name: Name, axis: String, terms: Vec<(Term, f64)>, range: Estimate) -> Part {
    let um = range.value.abs();
    let half = Z * range.error;
    let ci95 = [(um - half).max(0.0), um + half];
    Part { name, axis, um, ci95, rivals: Vec::new(), details: Vec::new(), shape: None, terms }
}
