//! Comparison of the paper's values with ours.

use super::experiment::{Experiment, FEEDFORWARD_PERCENT, LawAtGain};
use super::machine::{ACCELERATION_M_PER_S2, RAPID_M_PER_S};
use crate::reproduce::study::{Outcome, Printed};

/// Printed: maximum difference of simulated and measured contours, also of those used in the identification, µm.
const DIFFERENCE_UM: Printed = Printed::Below(5.0);

/// All outcomes.
pub fn all(experiment: &Experiment) -> Vec<Outcome> {
    [
        rapid_moves(experiment),
        circle_shrinkage(experiment),
        contours(experiment),
        overshoot_over_gain(experiment),
        overshoot_by_cause(experiment),
    ]
    .concat()
}

/// Table 1: speed and acceleration of both axes.
fn rapid_moves(experiment: &Experiment) -> Vec<Outcome> {
    let mut outcomes = Vec::new();
    for (axis, [speed, acceleration]) in ["X", "Y"].into_iter().zip(experiment.reached) {
        let printed = Printed::to_digit(60.0 * RAPID_M_PER_S, 1.0);
        outcomes.push(Outcome::new(format!("{axis}: speed reached"), printed, 60.0 * speed, "m/min"));
        let printed = Printed::to_digit(ACCELERATION_M_PER_S2[usize::from(axis == "Y")], 0.1);
        outcomes.push(Outcome::new(format!("{axis}: acceleration reached"), printed, acceleration, "m/s²"));
    }
    outcomes
}

/// The printed feed-forward, which was set for minimum circle shrinkage.
fn circle_shrinkage(experiment: &Experiment) -> Vec<Outcome> {
    let outcome = |run: &LawAtGain| {
        let quantity = format!("Kf of least circle shrinkage, HPC, motors, Kp = {}", run.gain_per_s);
        let printed = Printed::to_digit(FEEDFORWARD_PERCENT, 1.0);
        Outcome::new(quantity, printed, run.feedforward.motor_percent, "%")
    };
    experiment.hpc.iter().map(outcome).collect()
}

/// Distances of predicted and simulated contours at the corner.
fn contours(experiment: &Experiment) -> Vec<Outcome> {
    let runs = || experiment.hpc.iter().zip(&experiment.predictions);
    let motors = runs().map(|(run, prediction)| {
        let corner = &run.printed;
        let quantity = format!("motor contour, from the command, Kp = {}", run.gain_per_s);
        let difference_um = corner.difference_um(&corner.motion.motor, &prediction.motor);
        Outcome::new(quantity, DIFFERENCE_UM, difference_um, "µm")
    });
    let identified = Outcome::new(
        "tool contour, from the motors, Kp = 33 (identified)",
        DIFFERENCE_UM,
        experiment.identification_residual_um(),
        "µm",
    );
    let tools = runs().map(|(run, prediction)| {
        let corner = &run.printed;
        let quantity = format!("tool contour, from the command, Kp = {}", run.gain_per_s);
        let difference_um = corner.difference_um(&corner.motion.tool, &prediction.tool);
        Outcome::new(quantity, DIFFERENCE_UM, difference_um, "µm")
    });
    motors.chain([identified]).chain(tools).collect()
}

/// Overshoot of the tool at each gain over that at the next lower one.
fn overshoot_over_gain(experiment: &Experiment) -> Vec<Outcome> {
    let outcome = |pair: &[LawAtGain]| {
        let [low, high] = [&pair[0], &pair[1]];
        let quantity = format!("corner overshoot, Kp = {} over Kp = {}", high.gain_per_s, low.gain_per_s);
        let ratio = high.printed.overshoot_um() / low.printed.overshoot_um();
        Outcome::new(quantity, Printed::Below(1.0), ratio, "")
    };
    experiment.hpc.windows(2).map(outcome).collect()
}

/// Contributions of feed-forward and mechanics to the overshoot.
fn overshoot_by_cause(experiment: &Experiment) -> Vec<Outcome> {
    let (low, high) = (&experiment.hpc[0], &experiment.hpc[2]);
    let added_by_mechanics_um =
        |run: &LawAtGain| run.printed.overshoot_um() - run.printed.motor_overshoot_um();
    vec![
        Outcome::new(
            "command beyond the corner by feed-forward, Kp = 33 over 75",
            Printed::Above(1.0),
            low.printed.feedforward_overshoot_um() / high.printed.feedforward_overshoot_um(),
            "",
        ),
        Outcome::new(
            "overshoot at Kf of least shrinkage, Kp = 75 over 33",
            Printed::Below(1.0),
            high.radius_kept.overshoot_um() / low.radius_kept.overshoot_um(),
            "",
        ),
        Outcome::new(
            "overshoot that Kf of least shrinkage adds, Kp = 33",
            Printed::Above(0.0),
            low.radius_kept.overshoot_um() - low.without.overshoot_um(),
            "µm",
        ),
        Outcome::new(
            "overshoot that the mechanics adds, Kp = 75 less Kp = 33",
            Printed::Below(0.0),
            added_by_mechanics_um(high) - added_by_mechanics_um(low),
            "µm",
        ),
    ]
}
