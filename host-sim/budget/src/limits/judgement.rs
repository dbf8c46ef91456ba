//! A limit with its outcome, and what it is judged by.

use std::fmt;

use files::format::significant;
use schemars::JsonSchema;
use serde::Serialize;

use super::limit::Figure;

/// Whether a limit is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It is.
    Pass,
    /// It cannot be told.
    Unknown,
    /// It is not.
    Fail,
}

impl Outcome {
    /// The outcome in a word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Unknown => "unknown",
            Self::Fail => "fail",
        }
    }
}

/// What a limit is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Basis {
    /// A log of the tool.
    Measured,
    /// The simulation of the model on a standard motion.
    Predicted,
    /// Nothing.
    None,
}

/// A limit with what it is judged by.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "LimitResult")]
pub struct Judgement {
    /// The figure.
    pub name: Figure,
    /// Its limit.
    pub limit_um: f64,
    /// Whether it is kept.
    pub result: Outcome,
    /// What it is judged by.
    pub basis: Basis,
    /// The value of the figure; `null`: none is known.
    pub value_um: Option<f64>,
    /// The value may be this much larger or smaller: by the interval of a prediction, or smaller by the noise of a measurement.
    pub uncertainty_um: Option<f64>,
    /// The log, or the motion of the budget; may be empty.
    pub of: String,
    /// Why it cannot be told; empty if it can.
    pub why: String,
}

impl Judgement {
    /// What the limit is judged by, in words.
    #[must_use]
    pub fn judged_by(&self) -> String {
        match self.basis {
            Basis::Measured => format!("measured at the tool in {}", self.of),
            Basis::Predicted => format!("predicted by the model for the standard motion {}", self.of),
            Basis::None => "nothing".to_owned(),
        }
    }
}

impl fmt::Display for Judgement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, limit_um, result, value_um, uncertainty_um, why, .. } = self;
        let limit = significant(*limit_um, 3);
        write!(f, "Limit {} {limit} µm: {}", name.name(), result.word())?;
        if let Some(um) = value_um {
            write!(f, "; {}", significant(*um, 3))?;
            if self.basis == Basis::Predicted {
                write!(f, " ± {}", significant(uncertainty_um.unwrap_or(0.0), 2))?;
            }
            write!(f, " µm, {}", self.judged_by())?;
        }
        if why.is_empty() { write!(f, ".") } else { write!(f, "; {why}.") }
    }
}

/// What all limits come to, in a few words; `None` without limits.
#[must_use]
pub fn summary(judgements: &[Judgement]) -> Option<String> {
    let named = |outcome: Outcome| {
        let of = judgements.iter().filter(|judgement| judgement.result == outcome);
        of.map(|judgement| judgement.name.name()).collect::<Vec<_>>().join(", ")
    };
    let parts = [
        ("beyond the limit: ", named(Outcome::Fail)),
        ("not known whether within the limit: ", named(Outcome::Unknown)),
        ("within the limit: ", named(Outcome::Pass)),
    ];
    let parts: Vec<String> = parts
        .into_iter()
        .filter(|(_, names)| !names.is_empty())
        .map(|(what, names)| what.to_owned() + &names)
        .collect();
    (!parts.is_empty()).then(|| parts.join("; "))
}
