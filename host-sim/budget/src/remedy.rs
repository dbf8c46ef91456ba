//! What to do about a cause.

use model::axis::Drive;
use model::machine::Machine;
use model::machine::evidence::Certainty;

use crate::cause::Cause;

/// What to do about a cause, in words.
#[must_use]
pub fn of(cause: &Cause, machine: &Machine) -> String {
    let doubt = match cause.evidence(machine) {
        Some(evidence) if evidence.certainty == Certainty::Ambiguous && !evidence.rivals.is_empty() => {
            format!(
                "first find out whether it is {} (trace --propose MOTION.toml); then ",
                evidence.rivals.join(" or ")
            )
        }
        _ => String::new(),
    };
    let what = match cause {
        Cause::FollowingLag => of_lag(machine),
        Cause::GainDifference => {
            "give the axes the same position gain and the same feed-forward of the velocity".to_owned()
        }
        Cause::Friction(axis) => of_friction(machine.axis[*axis].settings.controller.drive).to_owned(),
        Cause::Stiffness(_) => "compensate: the stretch of the drive is added to the command".to_owned(),
        Cause::Effect(axis, effect) => machine.axis[*axis].effect[*effect].compensation().remedy(),
        Cause::Unexplained(_) => "find its cause: log more channels, or other motions".to_owned(),
        Cause::Noise => "filter the velocity, or lower the gain of the velocity loop".to_owned(),
        Cause::Quantisation => "use an encoder of a finer resolution".to_owned(),
    };
    format!("{doubt}{what}")
}

fn of_lag(machine: &Machine) -> String {
    let controllers = machine.axis.values().map(|axis| &axis.settings.controller);
    let is_below = |percent: Option<f64>| percent.unwrap_or(0.0) < 100.0;
    if controllers.clone().any(|controller| is_below(controller.feedforward_percent)) {
        "set the feed-forward of the velocity to 100 % on all axes (compensate)".to_owned()
    } else {
        "lower the acceleration, or smooth the path".to_owned()
    }
}

const fn of_friction(drive: Drive) -> &'static str {
    match drive {
        Drive::Torque => {
            "compensate: friction is part of the force feed-forward; lubricate and check the preload"
        }
        Drive::Velocity | Drive::Stepper => {
            "raise the gain of the velocity loop; lubricate and check the preload"
        }
    }
}
