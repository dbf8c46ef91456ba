//! Where an effect stands: the axis as declared, its neighbours, and what was logged.

use shared::config::Rates;

use super::stage::Stage;
use crate::axis::Settings;

/// What initial guesses are made from.
#[derive(Clone, Copy, Debug)]
pub struct EffectContext<'a> {
    /// Declared axis.
    pub axis: &'a Settings,
    /// Whether the axis is the machine's first.
    pub first: bool,
    /// Names of the machine's other axes.
    pub others: &'a [String],
    /// Which stages the logs and the declared model allow, in no order.
    pub stages: &'a [Stage],
    /// Lowest and highest position of the logged motor or table, mm.
    pub travel_mm: [f64; 2],
}

impl EffectContext<'_> {
    /// Whether a stage can be formed.
    #[must_use]
    pub fn has(&self, stage: Stage) -> bool {
        self.stages.contains(&stage)
    }

    /// Whether friction alone lies between the motor and the force that was logged. Beside a linear scale friction also
    /// bends the screw, and small differences of it are lost in what a machine file leaves open of the drive train:
    /// they are not looked for there.
    #[must_use]
    pub fn shows_friction_alone(&self) -> bool {
        self.axis.has_mass() && self.has(Stage::Force) && !self.has(Stage::Table)
    }
}

/// The other axes of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Neighbours {
    /// Whether the axis is the machine's first.
    pub is_first: bool,
    /// How many other axes there are.
    pub others: usize,
}

/// Whether an effect can be looked for on an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prerequisite {
    /// It can, as far as the machine file goes.
    Met,
    /// It could, with this.
    Needs(&'static str),
    /// There is no such effect on an axis of this kind.
    NotApplicable,
}

impl Prerequisite {
    /// Of effects that [`EffectContext::shows_friction_alone`] decides on.
    pub const WITHOUT_TABLE: Self = Self::Needs("logs without a table channel");

    /// Something that must be there.
    #[must_use]
    pub const fn needs(is_there: bool, what: &'static str) -> Self {
        if is_there { Self::Met } else { Self::Needs(what) }
    }

    /// Masses of the axis.
    #[must_use]
    pub fn masses(axis: &Settings) -> Self {
        Self::needs(axis.has_mass(), "masses in the machine file")
    }

    /// The lead of the screw.
    #[must_use]
    pub const fn lead(axis: &Settings) -> Self {
        Self::needs(axis.mechanics.lead_mm.is_some(), "lead_mm in the machine file")
    }

    /// This, and then another.
    #[must_use]
    pub const fn and(self, next: Self) -> Self {
        match self {
            Self::Met => next,
            _ => self,
        }
    }
}

/// Where an effect stands in a machine file.
#[derive(Clone, Copy, Debug)]
pub struct Placement<'a> {
    /// Its axis.
    pub axis: &'a Settings,
    /// How many axes the machine has.
    pub axes: usize,
    /// Whether the machine is also declared as rigid bodies.
    pub has_structure: bool,
    /// Of its loops.
    pub rates: Rates,
}

/// What is wrong about an effect in its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misplaced {
    /// The key that is refused.
    pub key: &'static str,
    /// What was expected there, in words.
    pub expected: String,
}

impl Misplaced {
    /// The effect itself is refused.
    #[must_use]
    pub fn name(expected: &str) -> Self {
        Self { key: "name", expected: expected.to_owned() }
    }
}
