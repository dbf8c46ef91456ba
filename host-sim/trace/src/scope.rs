//! Which stages are explained together, because the same parameters shape them.

use super::signals::{AxisSignals, Signals};
use model::effects::{Effect, Stage};
use model::machine::Axis;

/// Which of the declared mechanical values are fitted on a set of stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mechanics {
    /// All of them, and the mechanical effects.
    All,
    /// The motor's mass: the loop shows the sum of the masses to a few per mille, better than a force
    /// whose motion is differentiated; what the loop's own effects explain must not be such an error.
    MotorMass,
    /// None.
    None,
}

/// A set of stages with the parameters that are fitted on them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scope {
    /// Stages whose residuals are made small together.
    pub stages: Vec<Stage>,
    /// Masses, stiffness, friction and mechanical effects that are fitted here.
    pub mechanics: Mechanics,
}

/// A stage that cannot be formed, and what it would need.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct NotTestable {
    /// Stage.
    pub stage: Stage,
    /// The missing channels or keys.
    pub needs: String,
}

impl Scope {
    /// Whether an effect is looked for and fitted here. A mechanical effect shapes the motor stage,
    /// too, but is fitted there only where neither table nor force show it more directly.
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

/// The scopes of an axis for what its logs and its declared model allow, in the order in which they
/// are explained (the servo loop holds the mechanics), and the stages that cannot be formed.
#[must_use]
pub fn scopes(axis: &Axis, index: usize, logs: &[Signals]) -> (Vec<Scope>, Vec<NotTestable>) {
    let all_have =
        |has: fn(&AxisSignals) -> bool| !logs.is_empty() && logs.iter().all(|log| has(&log.axes[index]));
    let [command, motor, table, tool, force] = [
        all_have(|a| a.command.is_some()),
        all_have(|a| a.motor.is_some()),
        all_have(|a| a.table.is_some()),
        all_have(|a| a.tool.is_some()),
        all_have(|a| a.force.is_some()),
    ];
    let moves = logs.iter().any(|log| log.axes[index].moves());
    let conditions = [
        (
            Stage::Motor,
            vec![
                (command, "a command channel"),
                (motor, "a motor channel"),
                (axis.settings.has_controller(), "the controller's keys in the machine file"),
                (axis.settings.has_mass(), "masses in the machine file"),
                (moves, "motion of the axis"),
            ],
        ),
        (
            Stage::Table,
            vec![(motor, "a motor channel"), (table, "a table channel"), (moves, "motion of the axis")],
        ),
        (Stage::Tool, vec![(table || motor, "a table or motor channel"), (tool, "a tool channel")]),
        (
            Stage::Force,
            vec![
                (motor, "a motor channel"),
                (force, "a force channel"),
                (axis.settings.has_mass(), "masses in the machine file"),
                (moves, "motion of the axis"),
            ],
        ),
    ];
    let mut formed = Vec::new();
    let mut not_testable = Vec::new();
    for (stage, needs) in conditions {
        let missing: Vec<&str> = needs.iter().filter(|(there, _)| !there).map(|(_, what)| *what).collect();
        if missing.is_empty() {
            formed.push(stage);
        } else {
            not_testable.push(NotTestable { stage, needs: missing.join(", ") });
        }
    }
    let among =
        |wanted: &[Stage]| wanted.iter().copied().filter(|stage| formed.contains(stage)).collect::<Vec<_>>();
    let mechanics = among(&[Stage::Table, Stage::Force]);
    let on_motor = if mechanics.is_empty() { Mechanics::All } else { Mechanics::MotorMass };
    let servo = Scope { stages: among(&[Stage::Motor]), mechanics: on_motor };
    let structure = Scope { stages: among(&[Stage::Tool]), mechanics: Mechanics::None };
    let mechanics = Scope { stages: mechanics, mechanics: Mechanics::All };
    let scopes = [mechanics, servo, structure].into_iter().filter(|scope| !scope.stages.is_empty()).collect();
    (scopes, not_testable)
}
