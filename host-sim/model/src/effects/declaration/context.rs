//! The context of an effect: the declared axis, the other axes, and the logged channels.

use shared::config::Rates;

use super::residual_shape::ResidualShape;
use super::stage::Stage;
use crate::axis::{Drive, Settings};

/// Channels of an axis in the logs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoggedChannels {
    /// A motor reading: that of a stepper may be its command, which is none.
    pub motor: bool,
    /// A linear scale.
    pub scale: bool,
    /// The force, in every log.
    pub force: bool,
    /// Mean temperature, °C; `None` where a log lacks it, or it hardly varies.
    pub temperature_c: Option<f64>,
}

impl LoggedChannels {
    /// All of them.
    pub const ALL: Self = Self { motor: true, scale: true, force: true, temperature_c: Some(22.0) };
}

/// Data from which initial guesses are derived.
#[derive(Clone, Copy, Debug)]
pub struct EffectContext<'a> {
    /// Settings of the declared axis.
    pub axis: &'a Settings,
    /// Whether the axis is the machine's first.
    pub first: bool,
    /// Names of the machine's other axes.
    pub others: &'a [String],
    /// Stages that can be evaluated with the logs and the declared model, in any order.
    pub stages: &'a [Stage],
    /// Channels of the axis in the logs.
    pub logged: LoggedChannels,
    /// Lowest and highest position of the logged motor or table, mm.
    pub travel_mm: [f64; 2],
    /// Names of the model's effects.
    pub effects: &'a [&'static str],
    /// How the residual depends on the position.
    pub residual: &'a ResidualShape,
}

impl EffectContext<'_> {
    /// Whether a stage can be evaluated.
    #[must_use]
    pub fn has(&self, stage: Stage) -> bool {
        self.stages.contains(&stage)
    }

    /// Whether nothing distinguishes a gap from the stretch of the drive train: neither stiffness and masses nor the force are known.
    #[must_use]
    pub fn hides_windup(&self) -> bool {
        !self.axis.has_drive_train() && !self.logged.force
    }

    /// Number of the model's effects of this name.
    #[must_use]
    pub fn count(&self, name: &str) -> usize {
        self.effects.iter().filter(|effect| **effect == name).count()
    }

    /// Whether friction is the only unknown between motor and logged force. With a linear scale, friction also deflects
    /// the screw, and small changes of friction cannot be separated from the tolerances of the drive train. They are
    /// therefore not searched for.
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
    /// Number of other axes.
    pub others: usize,
}

/// Whether an effect can be searched for on an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prerequisite {
    /// The machine file contains all that is required.
    Met,
    /// What is missing.
    Needs(&'static str),
    /// The effect does not exist on an axis of this kind.
    NotApplicable,
}

impl Prerequisite {
    /// Prerequisite of effects that require [`EffectContext::shows_friction_alone`].
    pub const WITHOUT_TABLE: Self = Self::Needs("logs without a table channel");

    /// `Met` if the required item is present.
    #[must_use]
    pub const fn needs(is_present: bool, what: &'static str) -> Self {
        if is_present { Self::Met } else { Self::Needs(what) }
    }

    /// Requires another axis.
    #[must_use]
    pub const fn another_axis(neighbours: Neighbours) -> Self {
        Self::needs(neighbours.others > 0, "another axis")
    }

    /// Requires the masses of the axis.
    #[must_use]
    pub fn masses(axis: &Settings) -> Self {
        Self::needs(axis.has_mass(), "masses in the machine file")
    }

    /// Requires a stiffness between motor and table, and their masses.
    #[must_use]
    pub const fn elastic(axis: &Settings) -> Self {
        let has_stiffness = axis.mechanics.stiffness_n_per_um.is_some();
        Self::needs(has_stiffness, "stiffness_n_per_um in the machine file")
            .and(Self::needs(!axis.is_rigid(), "motor_mass_kg and table_mass_kg in the machine file"))
    }

    /// Requires the lead of the screw.
    #[must_use]
    pub const fn lead(axis: &Settings) -> Self {
        Self::needs(axis.mechanics.lead_mm.is_some(), "lead_mm in the machine file")
    }

    /// Requires both; the first that is not met is returned.
    #[must_use]
    pub const fn and(self, next: Self) -> Self {
        match self {
            Self::Met => next,
            _ => self,
        }
    }
}

/// The surroundings of an effect in a machine file.
#[derive(Clone, Copy, Debug)]
pub struct Placement<'a> {
    /// Settings of the axis.
    pub axis: &'a Settings,
    /// Number of axes of the machine.
    pub axes: usize,
    /// Whether the machine is also declared as rigid bodies.
    pub has_structure: bool,
    /// Rates of the loops.
    pub rates: Rates,
}

/// Why an effect is refused on its axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misplaced {
    /// The key that is refused.
    pub key: &'static str,
    /// What was expected at this key, in words.
    pub expected: String,
}

impl Misplaced {
    /// Refuses an effect of stepper motors on another axis.
    #[must_use]
    pub fn unless_stepper(place: &Placement<'_>) -> Option<Self> {
        let is_stepper = place.axis.controller.drive == Drive::Stepper;
        (!is_stepper).then(|| Self::name("this effect only on an axis with drive = \"stepper\""))
    }

    /// Refuses the effect itself, at its key `name`.
    #[must_use]
    pub fn name(expected: &str) -> Self {
        Self { key: "name", expected: expected.to_owned() }
    }
}
