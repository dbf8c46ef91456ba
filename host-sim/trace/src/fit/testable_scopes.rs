//! The scopes that logs and machine file allow to evaluate.

use super::fit_data::FitData;
use super::scope::{Mechanics, NotTestable, Scope};
use crate::input::signals::AxisSignals;
use model::effects::Stage;
use model::machine::Axis;

/// The scopes that can be evaluated with the logs and the declared model of an axis, in the order in which they are fitted
/// (mechanics, servo loop, structure), and the stages that cannot be evaluated.
#[must_use]
pub fn scopes(axis: &Axis, data: &FitData<'_>) -> (Vec<Scope>, Vec<NotTestable>) {
    let mut testable = Vec::new();
    let mut not_testable = Vec::new();
    for (stage, needs) in requirements(axis, data) {
        let mut missing: Vec<&str> =
            needs.iter().filter(|(is_present, _)| !is_present).map(|(_, what)| *what).collect();
        if missing.is_empty() && data.logs_with(stage).next().is_none() {
            missing.push("a log with all its channels");
        }
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
    // A stage is evaluated on the logs that have its channels.
    let one_has = |has: fn(&AxisSignals) -> bool| logs().any(has);
    let min_travel_mm = data.options.admission.min_travel_mm;
    let motor = (one_has(|a| a.motor.is_some()), "a motor channel");
    let table = (one_has(|a| a.table.is_some()), "a table channel");
    let table_or_motor = (table.0 || motor.0, "a table or motor channel");
    let command = (one_has(|a| a.command.is_some()), "a command channel");
    let tool = (one_has(|a| a.tool.is_some()), "a tool channel");
    let force = (one_has(|a| a.force.is_some()), "a force channel");
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
