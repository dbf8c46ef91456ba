//! Scopes: sets of stages that are fitted together because they share parameters.

use super::fit_data::FitData;
use crate::input::signals::AxisSignals;
use model::effects::{Effect, Stage};
use model::machine::Axis;

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

/// The scopes that can be evaluated with the logs and the declared model of an axis, in the order in which they are fitted
/// (mechanics, servo loop, structure), and the stages that cannot be evaluated.
#[must_use]
pub fn scopes(axis: &Axis, data: &FitData<'_>) -> (Vec<Scope>, Vec<NotTestable>) {
    let mut testable = Vec::new();
    let mut not_testable = Vec::new();
    for (stage, needs) in requirements(axis, data) {
        let missing: Vec<&str> =
            needs.iter().filter(|(is_present, _)| !is_present).map(|(_, what)| *what).collect();
        if missing.is_empty() {
            testable.push(stage);
        } else {
            not_testable.push(NotTestable { stage, needs: missing.join(", ") });
        }
    }
    let among = |wanted: &[Stage]| {
        wanted.iter().copied().filter(|stage| testable.contains(stage)).collect::<Vec<_>>()
    };
    let mechanics = among(&[Stage::Table, Stage::Force]);
    let on_motor = match &mechanics[..] {
        [] => Mechanics::All,
        stages if stages.contains(&Stage::Force) => Mechanics::MotorMass,
        _ => Mechanics::Values,
    };
    let servo = Scope { stages: among(&[Stage::Motor]), mechanics: on_motor };
    let structure = Scope { stages: among(&[Stage::Tool]), mechanics: Mechanics::None };
    let mechanics = Scope { stages: mechanics, mechanics: Mechanics::All };
    let scopes = [mechanics, servo, structure].into_iter().filter(|scope| !scope.stages.is_empty()).collect();
    (scopes, not_testable)
}

/// The requirements of each stage, with a flag whether each is met, in the order in which missing ones are reported.
fn requirements(axis: &Axis, data: &FitData<'_>) -> [(Stage, Vec<(bool, &'static str)>); 4] {
    let logs = || (0..data.logs.len()).map(|log| data.signals(log));
    let all_have = |has: fn(&AxisSignals) -> bool| !data.logs.is_empty() && logs().all(has);
    let min_travel_mm = data.options.admission.min_travel_mm;
    let motor = (all_have(|a| a.motor.is_some()), "a motor channel");
    let table = (all_have(|a| a.table.is_some()), "a table channel");
    let table_or_motor = (table.0 || motor.0, "a table or motor channel");
    let command = (all_have(|a| a.command.is_some()), "a command channel");
    let tool = (all_have(|a| a.tool.is_some()), "a tool channel");
    let force = (all_have(|a| a.force.is_some()), "a force channel");
    let controller = (axis.settings.has_controller(), "the controller's keys in the machine file");
    let masses = (axis.settings.has_mass(), "masses in the machine file");
    let motion = (logs().any(|signals| signals.moves(min_travel_mm)), "motion of the axis");
    [
        (Stage::Motor, vec![command, motor, controller, masses, motion]),
        (Stage::Table, vec![motor, table, motion]),
        (Stage::Tool, vec![table_or_motor, tool]),
        (Stage::Force, vec![motor, force, masses, motion]),
    ]
}
