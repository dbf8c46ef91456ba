//! Laws of residuals.

use schemars::JsonSchema;
use serde::Serialize;

use super::figures::{Channel, Rms, number};
use crate::analysis::law::{FoundLaw, FoundTerm};
use crate::result::identification::AxisIdentification;
use crate::stages::residual_unit;
use model::residual_law::Term;

/// A residual that no effect describes, as an equation.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Law {
    channel: Channel,
    axis: String,
    /// Unit of the residual: of the constant, of the rms, and of the coefficients per unit of the variables.
    unit: &'static str,
    /// The equation in words.
    equation: String,
    constant: f64,
    terms: Vec<LawTerm>,
    /// Rms without the law.
    before: Rms,
    /// Rms with the law.
    after: Rms,
}

/// A term of a law.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LawTerm {
    /// `product`, `wave` or `hysteresis`.
    kind: &'static str,
    /// Its form, with the names of the axes.
    form: String,
    /// The variables on which it depends.
    of: Vec<Variable>,
    /// Period of a wave.
    #[serde(skip_serializing_if = "Option::is_none")]
    period_mm: Option<f64>,
    /// Distance of a hysteresis.
    #[serde(skip_serializing_if = "Option::is_none")]
    distance_mm: Option<f64>,
    /// The coefficient; of a wave, those of cosine and sine.
    coefficient: Vec<f64>,
    /// The interval of each.
    ci95: Vec<[Option<f64>; 2]>,
    /// By how many standard errors the term, fitted to the held-out logs alone, differs from zero.
    held_out_t: f64,
    /// Whether these logs determine that the term is in the law.
    is_certain: bool,
    /// Forms that describe the fitted logs as well in its place.
    rivals: Vec<String>,
}

/// A variable of a law.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(transparent)]
pub struct Variable(#[schemars(with = "String")] model::residual_table::TableVariable);

impl Law {
    pub(super) fn of(axis: &AxisIdentification, law: &FoundLaw) -> Self {
        Self {
            channel: law.stage.into(),
            axis: law.axis.clone(),
            unit: residual_unit(axis.unit, law.stage).1,
            equation: law.equation(axis.unit),
            constant: law.constant,
            terms: law.terms.iter().map(|found| LawTerm::of(law, found)).collect(),
            before: law.before.into(),
            after: law.after.into(),
        }
    }
}

impl LawTerm {
    fn of(law: &FoundLaw, found: &FoundTerm) -> Self {
        let (kind, period_mm, distance_mm, coefficient) = match &found.term {
            Term::Product { coefficient, .. } => ("product", None, None, vec![*coefficient]),
            Term::Wave { period_mm, cosine, sine, .. } => {
                ("wave", Some(*period_mm), None, vec![*cosine, *sine])
            }
            Term::Hysteresis { distance_mm, coefficient } => {
                ("hysteresis", None, Some(*distance_mm), vec![*coefficient])
            }
        };
        let interval = |(value, half): (&f64, f64)| [number(value - half), number(value + half)];
        Self {
            kind,
            form: law.form(&found.term),
            of: found.term.variables().into_iter().map(Variable).collect(),
            period_mm,
            distance_mm,
            ci95: coefficient.iter().zip(found.half_widths).map(interval).collect(),
            coefficient,
            held_out_t: found.held_out_t,
            is_certain: law.is_certain(found),
            rivals: found.rivals.iter().map(|rival| law.form(rival)).collect(),
        }
    }
}
