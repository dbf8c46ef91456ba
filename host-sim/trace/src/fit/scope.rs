//! Scopes: sets of stages that are fitted together because they share parameters.

use model::effects::{Effect, Stage};

/// The declared mechanical values that are fitted on a set of stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mechanics {
    /// All values, and the mechanical effects.
    All,
    /// All values without the mechanical effects. Without a force the closed loop determines masses and friction, which the
    /// table stage leaves open.
    Values,
    /// The mass of the motor only. The closed loop determines the sum of the masses to a few per mille, better than the force
    /// stage with its differentiated motion. An error of the mass must not be explained by an effect of the loop.
    MotorMass,
    /// None.
    None,
}

/// A set of stages with the parameters that are fitted on them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scope {
    /// Stages whose residuals are minimized together.
    pub stages: Vec<Stage>,
    /// Mechanical values that are fitted on these stages.
    pub mechanics: Mechanics,
}

/// A stage that cannot be evaluated, with the missing channels or keys.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct NotTestable {
    /// Stage.
    pub stage: Stage,
    /// The missing channels or keys.
    pub needs: String,
}

impl Scope {
    /// Whether the table driven by the measured motor is simulated for some of the stages.
    #[must_use]
    pub fn is_driven(&self) -> bool {
        self.stages.iter().any(|stage| matches!(stage, Stage::Table | Stage::Force))
    }

    /// Whether an effect is searched for and fitted in this scope. A mechanical effect also changes the motor stage, but is
    /// fitted there only if neither the table nor the force stage can be evaluated.
    #[must_use]
    pub fn holds(&self, effect: &Effect) -> bool {
        match effect.stages() {
            [Stage::Motor] => self.stages.contains(&Stage::Motor),
            [Stage::Tool] => self.stages.contains(&Stage::Tool),
            stages => {
                self.mechanics == Mechanics::All && stages.iter().any(|stage| self.stages.contains(stage))
            }
        }
    }
}
