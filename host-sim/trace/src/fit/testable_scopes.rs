//! The scopes that logs and machine file allow to evaluate.

use super::fit_data::FitData;
use super::scope::{Mechanics, NotTestable, Scope, ShownIn};
use crate::input::signals::{AxisSignals, logged_channels};
use model::axis::{Drive, Feedback, Law, Settings};
use model::effects::Stage;
use model::machine::{Axis, rotary};

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
            let needs = rotary::in_words(&missing.join(", "), axis.settings.names);
            not_testable.push(NotTestable { stage, needs });
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
    let shown_in = shown_in(axis, data);
    let servo = Scope { stages: among(&[Stage::Motor]), mechanics: on_motor, shown_in };
    let structure = Scope { stages: among(&[Stage::Tool]), mechanics: Mechanics::None, shown_in };
    let mechanics = Scope { stages: mechanics, mechanics: Mechanics::All, shown_in };
    let scopes = [mechanics, servo, structure].into_iter().filter(|scope| !scope.stages.is_empty()).collect();
    (scopes, not_testable)
}

/// Where the axis shows the effects of stages whose channel no log has.
fn shown_in(axis: &Axis, data: &FitData<'_>) -> ShownIn {
    let logged = logged_channels(data.logs, data.axis, &data.options.samples);
    let has_driven_tool = |log: usize| data.signals(log).tool.is_some() && data.signals(log).motor.is_some();
    ShownIn {
        table_in_tool: !logged.scale && (0..data.logs.len()).any(has_driven_tool),
        motor_in_next: axis.settings.controller.drive == Drive::Stepper && !logged.motor,
    }
}

/// The requirements of each stage, with a flag whether each is met, in the order in which missing ones are reported.
fn requirements(axis: &Axis, data: &FitData<'_>) -> [(Stage, Vec<(bool, &'static str)>); 4] {
    let logs = || (0..data.logs.len()).map(|log| data.signals(log));
    // A stage is evaluated on the logs that have its channels.
    let one_has = |has: fn(&AxisSignals) -> bool| logs().any(has);
    let min_travel_mm = data.options.admission.min_travel_mm;
    let motor = (one_has(|a| a.motor.is_some()), "a motor channel");
    let own_motor = (one_has(AxisSignals::has_motor_reading), "a motor channel");
    let table = (one_has(|a| a.table.is_some()), "a table channel");
    let table_or_motor = (table.0 || motor.0, "a table or motor channel");
    let command = (one_has(|a| a.command.is_some()), "a command channel");
    let tool = (one_has(|a| a.tool.is_some()), "a tool channel");
    let force = (one_has(|a| a.force.is_some()), "a force channel");
    let masses = (axis.settings.has_mass(), "masses in the machine file");
    let motion = (logs().any(|signals| signals.moves(min_travel_mm)), "motion of the axis");
    let mut for_motor = vec![command, own_motor];
    match axis.settings.controller.drive {
        Drive::Torque => for_motor.extend(loop_keys(&axis.settings).into_iter().chain([masses])),
        Drive::Velocity => {
            for_motor.extend(&loop_keys(&axis.settings)[1..2]);
            for_motor.extend(velocity_loop(&axis.settings));
        }
        Drive::Stepper => {}
    }
    for_motor.push(motion);
    [
        (Stage::Motor, for_motor),
        (Stage::Table, vec![motor, table, motion]),
        (Stage::Tool, vec![table_or_motor, tool]),
        (Stage::Force, vec![motor, force, masses, motion]),
    ]
}

/// The keys of the control loops, with a flag whether each is given.
fn loop_keys(settings: &Settings) -> [(bool, &'static str); 3] {
    let controller = &settings.controller;
    [
        (controller.law.is_some(), "controller in the machine file"),
        (controller.position_gain_per_s.is_some(), "position_gain_per_s in the machine file"),
        (controller.velocity_gain_n_s_per_m.is_some(), "velocity_gain_n_s_per_m in the machine file"),
    ]
}

/// What the model of a loop that commands a velocity asks for, with a flag whether it is so.
fn velocity_loop(settings: &Settings) -> [(bool, &'static str); 2] {
    [
        (settings.controller.law != Some(Law::Hpc), "a proportional position loop"),
        (settings.sensors.feedback == Feedback::Motor, "a position loop that is closed by the motor"),
    ]
}
