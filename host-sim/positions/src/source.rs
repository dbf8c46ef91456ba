//! A fit and what its effects are named by; values and intervals of combinations of its coefficients.

use nalgebra::DVector;

use super::course::Clock;
use super::effect::{Certainty, Effect, Parameter};
use super::fit::Fit;
use super::variant::{Columns, Grid};

/// What closes the position loop of the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Feedback {
    /// Nobody said it.
    #[default]
    Unknown,
    /// The motor's encoder or resolver.
    Motor,
    /// A linear scale.
    Scale,
}

/// A fit, and what its effects are named by.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// The fit.
    pub fit: &'a Fit,
    /// Its knots and course.
    pub grid: &'a Grid,
    /// The targets, mm, which need not be the knots.
    pub targets_mm: &'a [f64],
    /// Name of the axis.
    pub axis: &'a str,
    /// What closes its loop.
    pub feedback: Feedback,
    /// What the clock counts.
    pub clock: Clock,
    /// Interval of the time constant, if the runs show one.
    pub time_constant_ci95: Option<[f64; 2]>,
}

impl Source<'_> {
    pub(crate) fn columns(&self) -> Columns {
        self.fit.variant.columns(self.grid)
    }

    /// Weights of coefficients: a row over the columns of one part, zero elsewhere.
    pub(crate) fn weights(&self, columns: &std::ops::Range<usize>, row: &[f64]) -> DVector<f64> {
        let mut weights = DVector::zeros(self.fit.coefficients.len());
        weights.rows_mut(columns.start, row.len()).copy_from_slice(row);
        weights
    }

    /// Value and half width of a combination of coefficients at one knot.
    pub(crate) fn value_at_knot(&self, weights: &DVector<f64>) -> (f64, f64) {
        (weights.dot(&self.fit.coefficients), self.fit.half_width_of_readings(weights))
    }

    /// Value and half width of a combination of coefficients that all readings tell.
    pub(crate) fn value(&self, weights: &DVector<f64>) -> (f64, f64) {
        (weights.dot(&self.fit.coefficients), self.fit.half_width(weights))
    }

    /// Offset and slope (per m) of values at the knots, as rows over them.
    pub(crate) fn line_rows(&self) -> [Vec<f64>; 2] {
        let lines = self.grid.lines();
        let along: Vec<f64> = lines.column(1).iter().copied().collect();
        let squares: f64 = along.iter().map(|x| x * x).sum();
        [vec![1.0 / along.len() as f64; along.len()], along.iter().map(|x| x / squares).collect()]
    }

    pub(crate) fn travel_m(&self) -> f64 {
        1e-3 * numerics::peak_to_peak(self.grid.knots_mm.iter().copied())
    }

    pub(crate) fn knots(&self) -> Parameter {
        Parameter::Given { value: self.grid.knots_mm.clone() }
    }

    /// An effect without rivals.
    pub(crate) fn effect(&self, name: &'static str, um: f64, part: DVector<f64>) -> Effect {
        Effect {
            name,
            axis: self.axis.to_owned(),
            parameters: indexmap::IndexMap::new(),
            certainty: Certainty::Certain,
            rivals: Vec::new(),
            um,
            signed_um: None,
            aliases_mm: Vec::new(),
            validate_reduction_percent: None,
            sentence: String::new(),
            part,
        }
    }

    /// What a scale would read alike, unless the loop is closed by the motor.
    pub(crate) fn of_scale(&self, name: &'static str) -> Option<&'static str> {
        (self.feedback != Feedback::Motor).then_some(name)
    }
}

impl Effect {
    /// This effect with what looks the same.
    #[must_use]
    pub(crate) fn with_rivals(self, rivals: impl IntoIterator<Item = &'static str>) -> Self {
        let rivals: Vec<&'static str> = rivals.into_iter().collect();
        let certainty = if rivals.is_empty() { Certainty::Certain } else { Certainty::Ambiguous };
        Self { certainty, rivals, ..self }
    }
}

/// Whether an interval does not contain zero.
pub(crate) fn is_there((value, half_width): (f64, f64)) -> bool {
    value.abs() > half_width
}
