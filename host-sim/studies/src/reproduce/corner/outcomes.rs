//! Every figure and finding of the paper beside ours.

use super::machine::{ACCELERATION_M_PER_S2, RAPID_M_PER_S};
use super::{Experiment, FEEDFORWARD_PERCENT, Tuned};
use crate::reproduce::{Outcome, Printed};

/// Half of the last digit of the printed Kf.
const FEEDFORWARD_TOLERANCE: f64 = 0.5;

/// Printed: how far simulated and measured contours differ, and what the identification had to keep, µm.
const DIFFERENCE_UM: f64 = 5.0;

pub(super) fn outcomes(experiment: &Experiment) -> Vec<Outcome> {
    let mut outcomes = Vec::new();
    let mut say = |quantity: String, printed, ours, unit| {
        outcomes.push(Outcome::new(quantity, printed, ours, unit));
    };
    for (axis, [speed, acceleration]) in ["X", "Y"].into_iter().zip(experiment.reached) {
        let printed = Printed::Figure { value: 60.0 * RAPID_M_PER_S, tolerance: 0.5 };
        say(format!("{axis}: speed reached"), printed, 60.0 * speed, "m/min");
        let value = ACCELERATION_M_PER_S2[usize::from(axis == "Y")];
        let printed = Printed::Figure { value, tolerance: 0.05 };
        say(format!("{axis}: acceleration reached"), printed, acceleration, "m/s²");
    }
    for tuned in &experiment.hpc {
        let printed = Printed::Figure { value: FEEDFORWARD_PERCENT, tolerance: FEEDFORWARD_TOLERANCE };
        let quantity = format!("Kf of least circle shrinkage, HPC, motors, Kp = {}", tuned.gain_per_s);
        say(quantity, printed, tuned.kept.motor_percent, "%");
    }
    let below = Printed::Below(DIFFERENCE_UM);
    for (tuned, predicted) in experiment.hpc.iter().zip(&experiment.predicted) {
        let corner = &tuned.printed;
        let difference = corner.difference_um(&corner.motion.motor, &predicted.motor);
        say(
            format!("motor contour, from the command, Kp = {}", tuned.gain_per_s),
            below.clone(),
            difference,
            "µm",
        );
    }
    say(
        "tool contour, from the motors, Kp = 33 (identified)".to_owned(),
        below.clone(),
        experiment.identified_um(),
        "µm",
    );
    for (tuned, predicted) in experiment.hpc.iter().zip(&experiment.predicted) {
        let corner = &tuned.printed;
        let difference = corner.difference_um(&corner.motion.tool, &predicted.tool);
        say(
            format!("tool contour, from the command, Kp = {}", tuned.gain_per_s),
            below.clone(),
            difference,
            "µm",
        );
    }
    for pair in experiment.hpc.windows(2) {
        let [low, high] = [&pair[0], &pair[1]];
        let quantity = format!("corner overshoot, Kp = {} over Kp = {}", high.gain_per_s, low.gain_per_s);
        say(quantity, Printed::Below(1.0), high.printed.overshoot_um() / low.printed.overshoot_um(), "");
    }
    let (low, high) = (&experiment.hpc[0], &experiment.hpc[2]);
    let ratio = low.printed.lead_um() / high.printed.lead_um();
    say(
        "command beyond the corner by feed-forward, Kp = 33 over 75".to_owned(),
        Printed::Above(1.0),
        ratio,
        "",
    );
    let ratio = high.least.overshoot_um() / low.least.overshoot_um();
    say("overshoot at Kf of least shrinkage, Kp = 75 over 33".to_owned(), Printed::Below(1.0), ratio, "");
    let more = low.least.overshoot_um() - low.without.overshoot_um();
    say("overshoot that Kf of least shrinkage adds, Kp = 33".to_owned(), Printed::Above(0.0), more, "µm");
    let added = |tuned: &Tuned| tuned.printed.overshoot_um() - tuned.printed.motor_overshoot_um();
    let eased = added(high) - added(low);
    say(
        "overshoot that the mechanics adds, Kp = 75 less Kp = 33".to_owned(),
        Printed::Below(0.0),
        eased,
        "µm",
    );
    outcomes
}
