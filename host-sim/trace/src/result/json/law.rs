//! Laws of residuals.

use schemars::JsonSchema;
use serde::Serialize;

use super::figures::{Channel, Rms, number};
use crate::analysis::law::{FoundLaw, FoundTerm, Resemblance};
use crate::result::identification::AxisIdentification;
use crate::result::refuting_motion::{Instant, Prediction, Refutation};
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
    /// Effects of the catalogue that could describe at least half of the law over the fitted logs, best first, at most three; if there are none,
    /// the best one. A resemblance is no cause.
    resembles: Vec<Resembled>,
    /// A motion that would refute the law; `null` if the axes do not move in the fitted logs.
    refuted_by: Option<RefutedBy>,
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
    /// The interval of the period or the distance.
    #[serde(skip_serializing_if = "Option::is_none")]
    length_ci95_mm: Option<[Option<f64>; 2]>,
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

/// An effect that a law resembles.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Resembled {
    effect: &'static str,
    /// The part of the variance of the law that the effect could describe.
    share: f64,
}

/// A variable of a law.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(transparent)]
pub struct Variable(#[schemars(with = "String")] model::residual_table::TableVariable);

impl Law {
    pub(super) fn of(axis: &AxisIdentification, (law, refutation): (&FoundLaw, Option<&Refutation>)) -> Self {
        Self {
            channel: law.stage.into(),
            axis: law.axis.clone(),
            unit: residual_unit(axis.unit, law.stage).1,
            equation: law.equation(axis.unit),
            constant: law.constant,
            terms: law.terms.iter().map(|found| LawTerm::of(law, found)).collect(),
            resembles: law
                .resembles
                .iter()
                .map(|&Resemblance { effect, share }| Resembled { effect, share })
                .collect(),
            refuted_by: refutation.map(RefutedBy::of),
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
        let length = found.term.length_mm().zip(found.length_half_width);
        Self {
            kind,
            form: law.form(&found.term),
            of: found.term.variables().into_iter().map(Variable).collect(),
            period_mm,
            distance_mm,
            length_ci95_mm: length.map(|(mm, half)| interval((&mm, half))),
            ci95: coefficient.iter().zip(found.half_widths).map(interval).collect(),
            coefficient,
            held_out_t: found.held_out_t,
            is_certain: law.is_certain(found),
            rivals: found.rivals.iter().map(|rival| law.form(rival)).collect(),
        }
    }
}

/// A motion that would refute a law.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RefutedBy {
    /// Which axis moves where, and how.
    how: String,
    /// The motion file.
    motion: String,
    /// What the law says of it; `null` if the machine file does not suffice to simulate the motion.
    prediction: Option<Predicted>,
}

/// The change of the residual between two instants of a motion by a law, in its unit.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Predicted {
    from: AtInstant,
    to: AtInstant,
    change: f64,
    ci95: [Option<f64>; 2],
    /// A measured change outside this interval refutes the law: that of the change, and of what the law leaves at both instants.
    refuted_outside: [Option<f64>; 2],
}

/// An instant of a motion.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct AtInstant {
    /// Time since the start of the motion.
    at_s: f64,
    /// The variables of the law.
    variables: Vec<VariableAt>,
}

/// A variable with its value.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct VariableAt {
    variable: Variable,
    value: f64,
}

impl RefutedBy {
    fn of(refutation: &Refutation) -> Self {
        Self {
            how: refutation.how.clone(),
            motion: refutation.to_toml(),
            prediction: refutation.prediction.as_ref().map(Predicted::of),
        }
    }
}

impl Predicted {
    fn of(Prediction { instants: [from, to], change, half_width, tolerance }: &Prediction) -> Self {
        let around = |half: f64| [number(change - half), number(change + half)];
        Self {
            from: AtInstant::of(from),
            to: AtInstant::of(to),
            change: *change,
            ci95: around(*half_width),
            refuted_outside: around(*tolerance),
        }
    }
}

impl AtInstant {
    fn of(instant: &Instant) -> Self {
        let variables = instant.values.iter();
        let variables =
            variables.map(|&(variable, value)| VariableAt { variable: Variable(variable), value });
        Self { at_s: instant.at_s, variables: variables.collect() }
    }
}
