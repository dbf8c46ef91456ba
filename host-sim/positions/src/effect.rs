//! What a deviation is made of: effects with their parameters, intervals and rivals, as `trace --json` has them.

use indexmap::IndexMap;
use nalgebra::DVector;
use serde::Serialize;

/// A parameter with its 95 % interval.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Parameter {
    /// A number.
    Number {
        /// Value, in the unit of the key.
        value: f64,
        /// Interval; `None`: the readings do not tell one.
        ci95: Option<[f64; 2]>,
    },
    /// A list that is fitted.
    Fitted {
        /// Values, in the unit of the key.
        value: Vec<f64>,
        /// Interval of each.
        ci95: Option<Vec<[f64; 2]>>,
    },
    /// A list that is given, such as the positions of targets.
    Given {
        /// Values, in the unit of the key.
        value: Vec<f64>,
    },
}

impl Parameter {
    /// A number with the half width of its interval; NaN: it has none.
    #[must_use]
    pub fn number(value: f64, half_width: f64) -> Self {
        let ci95 = half_width.is_finite().then_some([value - half_width, value + half_width]);
        Self::Number { value, ci95 }
    }

    /// A list with the half widths of its intervals.
    #[must_use]
    pub fn list(value: Vec<f64>, half_widths: &[f64]) -> Self {
        let ci95 = half_widths.iter().all(|half| half.is_finite()).then(|| {
            value.iter().zip(half_widths).map(|(value, half)| [value - half, value + half]).collect()
        });
        Self::Fitted { value, ci95 }
    }

    /// Its numbers.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        match self {
            Self::Number { value, .. } => std::slice::from_ref(value),
            Self::Fitted { value, .. } | Self::Given { value } => value,
        }
    }
}

/// Whether something else looks the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Certainty {
    /// Nothing else that is known looks the same.
    Certain,
    /// The readings do not tell it from its rivals.
    Ambiguous,
}

/// An effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Effect {
    /// Name, as in the catalogue of effects where it is there.
    pub name: &'static str,
    /// Name of the axis.
    pub axis: String,
    /// Parameters by key; the key ends with the unit.
    pub parameters: IndexMap<&'static str, Parameter>,
    /// Whether something else looks the same.
    pub certainty: Certainty,
    /// What looks the same; empty if it is certain.
    pub rivals: Vec<&'static str>,
    /// Range of the deviation that it makes over the targets, both directions and the fitted runs, µm.
    pub um: f64,
    /// A gap has its sign here: below zero the axis comes further in the direction of its motion, which no gap does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub signed_um: Option<f64>,
    /// Other periods that look the same at these targets, mm.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub aliases_mm: Vec<f64>,
    /// By how much the residual of the validation runs is smaller with it, percent; `None` without such runs.
    pub validate_reduction_percent: Option<f64>,
    /// In words.
    pub sentence: String,
    /// Its part of the coefficients of the fit.
    #[serde(skip)]
    pub part: DVector<f64>,
}

impl Effect {
    /// The number of a key.
    #[must_use]
    pub fn value(&self, key: &str) -> Option<f64> {
        self.parameters.get(key)?.values().first().copied()
    }

    /// The list of a key.
    #[must_use]
    pub fn list(&self, key: &str) -> Option<&[f64]> {
        Some(self.parameters.get(key)?.values())
    }
}
