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

/// The stages in which an axis shows the effects of stages without a channel of their own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShownIn {
    /// Where the tool shows what the missing linear scale does not: the tool is then predicted from the motor, through the screw.
    pub table_in_tool: bool,
    /// Where table or tool show what the missing motor reading does not: the motor is a stepper, and taken as its command.
    pub motor_in_next: bool,
}

impl ShownIn {
    /// The stage in which the effects of a stage are seen.
    #[must_use]
    pub fn of(self, stage: Stage) -> Stage {
        let next = if stage == Stage::Motor && self.motor_in_next { Stage::Table } else { stage };
        if next == Stage::Table && self.table_in_tool { Stage::Tool } else { next }
    }

    /// The stages of an effect in which it is seen, each once.
    #[must_use]
    pub fn stages_of(self, effect: &Effect) -> Vec<Stage> {
        let mut stages: Vec<Stage> = Vec::new();
        for stage in effect.stages().iter().map(|&stage| self.of(stage)) {
            if !stages.contains(&stage) {
                stages.push(stage);
            }
        }
        stages
    }
}

/// A set of stages with the parameters that are fitted on them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scope {
    /// Stages whose residuals are minimized together.
    pub stages: Vec<Stage>,
    /// Mechanical values that are fitted on these stages.
    pub mechanics: Mechanics,
    /// Where the axis shows the effects of stages without a channel.
    pub shown_in: ShownIn,
}

/// A stage that cannot be evaluated, with the missing channels or keys.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct NotTestable {
    /// Stage.
    pub stage: Stage,
    /// The missing channels or keys.
    pub needs: String,
}

impl NotTestable {
    /// Whether keys of the machine file are missing, which may be estimated from logs.
    #[must_use]
    pub fn lacks_keys(&self) -> bool {
        self.needs.contains("in the machine file")
    }
}

impl Scope {
    /// Whether the table driven by the measured motor is simulated for some of the stages.
    #[must_use]
    pub fn is_driven(&self) -> bool {
        let is_driven = |stage: &Stage| match stage {
            Stage::Table | Stage::Force => true,
            Stage::Tool => self.shown_in.table_in_tool,
            Stage::Motor => false,
        };
        self.stages.iter().any(is_driven)
    }

    /// The stages whose effects this scope shows, without those that another scope shows as well.
    #[must_use]
    pub fn shown_stages(&self) -> Vec<Stage> {
        let all = [Stage::Motor, Stage::Table, Stage::Tool, Stage::Force];
        all.into_iter().filter(|&stage| self.stages.contains(&self.shown_in.of(stage))).collect()
    }

    /// Whether an effect is searched for and fitted in this scope. A mechanical effect also changes the motor stage, but is
    /// fitted there only if neither the table nor the force stage can be evaluated.
    #[must_use]
    pub fn holds(&self, effect: &Effect) -> bool {
        let stages = effect.stages();
        if let Some(&first) = stages.first().filter(|&&first| self.shown_in.of(first) != first) {
            return self.stages.contains(&self.shown_in.of(first));
        }
        match stages {
            [Stage::Motor] => self.stages.contains(&Stage::Motor),
            [Stage::Tool] => self.stages.contains(&Stage::Tool),
            stages => {
                self.mechanics == Mechanics::All && stages.iter().any(|stage| self.stages.contains(stage))
            }
        }
    }
}
