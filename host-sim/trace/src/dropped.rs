//! Effects that leave a model, with the reason: the search and the judgement drop effects at different times, but only in this way.

use schemars::JsonSchema;
use serde::Serialize;

use crate::task::Progress;
use model::effects::Effect;

/// Why an effect leaves a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// Effects that were added later describe what it did.
    NotNeeded,
    /// Its size or shape is too uncertain, or it is what another effect leaves.
    Uncertain,
    /// It is small beside the parts of the residual that no effect describes, and describes what their exclusion leaves.
    RemnantOfExclusion,
    /// It made up for a declared value that was bounded.
    MadeUpForBound,
    /// A parameter is at a limit of its range.
    AtLimit,
    /// It is too uncertain after the final fit, or within the tolerance of what is declared.
    NotShown,
    /// Its interval, with what earlier fits leave uncertain, contains zero.
    IntervalContainsZero,
    /// The validation logs refute it.
    Refuted,
    /// A law describes its stage better without it.
    DescribedByLaw,
    /// The machine file is that of another machine.
    OtherMachine,
    /// It made up for an effect that was then called by another name.
    MadeUpForName,
}

impl Reason {
    /// The reason in words, after the name of the effect.
    const fn words(self) -> &'static str {
        match self {
            Self::NotNeeded => "is no longer needed",
            Self::Uncertain => "is too uncertain",
            Self::RemnantOfExclusion => "describes what an exclusion leaves",
            Self::MadeUpForBound => "made up for a value that was bounded",
            Self::AtLimit => "is at a limit of its range",
            Self::NotShown => "is too uncertain or within tolerance",
            Self::IntervalContainsZero => "has an interval that contains zero",
            Self::Refuted => "is refuted by the validation logs",
            Self::DescribedByLaw => "leaves more than a law without it",
            Self::OtherMachine => "is none, as the machine file is that of another machine",
            Self::MadeUpForName => "made up for the name of another effect",
        }
    }
}

/// An effect that left a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Dropped {
    effect: Effect,
    reason: Reason,
}

impl Dropped {
    /// An effect of an axis that leaves its model; the progress says so.
    #[must_use]
    pub fn new(effect: &Effect, reason: Reason, axis: &str, progress: &Progress<'_>) -> Self {
        progress(&format!("{axis}: {} {}", effect.name(), reason.words()));
        Self { effect: effect.clone(), reason }
    }

    /// The effect.
    #[must_use]
    pub const fn effect(&self) -> &Effect {
        &self.effect
    }

    /// The reason.
    #[must_use]
    pub const fn reason(&self) -> Reason {
        self.reason
    }
}
