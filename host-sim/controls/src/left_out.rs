//! What a control does not take of a compensation, and what to do instead.

use shared::compensate::CompensationSettings;

use crate::control::Control;
use crate::errors::AxisErrors;

/// Sentences for what the files of an axis lack.
#[must_use]
pub fn of(control: Control, axis: &AxisErrors<'_>) -> Vec<String> {
    let settings = &axis.compensation.compensation;
    let changed = &axis.compensation.controller;
    let has_table = settings.pitch.is_some() || !settings.screw.is_empty();
    let has_gains = changed.position_gain_per_s.is_some() || changed.feedforward_percent.is_some();
    let is_linuxcnc = control == Control::Linuxcnc;
    let parts = [
        (
            has_table && axis.table.is_none() && axis.unresolved.is_none(),
            "the error over the position",
            NO_TABLE,
        ),
        (settings.squareness.is_some(), "squareness", squareness(control)),
        (
            settings.straightness.is_some(),
            "straightness",
            "a table of one axis over the position of another, where the control has one",
        ),
        (
            settings.intalk.is_some() || settings.crosstalk.is_some(),
            "displacement by acceleration",
            "lower the acceleration, or stiffen the column",
        ),
        (
            !settings.products.is_empty(),
            "a law of several variables",
            "a table over two axes (volumetric compensation), where the control has one and the law is one of positions",
        ),
        (settings.drift.is_some(), "thermal drift", "warm the machine up, or measure it again warm"),
        (
            !settings.dividing.is_empty(),
            "the periodic error of the motor reading",
            "correct it in the encoder's electronics or the drive",
        ),
        (
            !settings.ripple.is_empty(),
            "force ripple",
            "the cogging compensation of the drive, where it has one",
        ),
        (
            settings.force.as_ref().is_some_and(|force| force.share > 0.0) && !is_linuxcnc,
            "force feed-forward",
            "the torque feed-forward and friction compensation of the drive",
        ),
        (
            settings.stretch_m_per_n.is_some() && !is_linuxcnc,
            "the stretch of the drive",
            "at reversals, its part by friction can be added to the backlash",
        ),
        (
            has_gains && !is_linuxcnc,
            "gains of the loop",
            "enter the changed gains, which the compensation file names, in the drive",
        ),
    ];
    let sentence = |(_, what, instead): &(bool, &str, &str)| {
        format!("{}: {what} is not in the files of this control. Instead: {instead}.", axis.axis)
    };
    let of_linuxcnc = if is_linuxcnc { beside_friction(settings) } else { Vec::new() };
    parts.iter().chain(&of_linuxcnc).filter(|(is_left, ..)| *is_left).map(sentence).collect()
}

/// What LinuxCNC does not take of the forces and what they stretch, beside masses and friction.
fn beside_friction(settings: &CompensationSettings) -> Vec<(bool, &'static str, &'static str)> {
    vec![
        (
            settings.force.as_ref().is_some_and(|force| force.load.is_some()),
            "the load over the position",
            "add its mean to the bias of the force, or balance the weight",
        ),
        (
            settings.stretch_m_per_n.is_some(),
            "the stretch of the drive under acceleration",
            "lower the acceleration; the stretch under friction is in the backlash",
        ),
    ]
}

const NO_TABLE: &str = "correct the steps per mm by the mean slope, or use a control with tables";

const fn squareness(control: Control) -> &'static str {
    match control {
        Control::Linuxcnc => {
            "adjust the axes, or add the position of the other axis times this factor to the motor command of this joint and subtract it from its feedback, each by a sum2 in HAL"
        }
        _ => "adjust the axes, or use the squareness or sag compensation of the control",
    }
}
