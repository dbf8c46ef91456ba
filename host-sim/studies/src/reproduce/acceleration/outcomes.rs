//! Comparison of the paper's values with ours.

use super::closed_loop::{X, Z};
use super::experiment::Experiment;
use super::{machines, z_move};
use crate::reproduce::study::{Outcome, Printed};

/// Unit of the coefficients.
const TALK: &str = "µm·s²/m";

/// All outcomes.
pub fn all(experiment: &Experiment) -> Vec<Outcome> {
    [on_circles(experiment), on_the_move(experiment), identification(experiment)].concat()
}

/// The circles of 2 mm.
fn on_circles(experiment: &Experiment) -> Vec<Outcome> {
    let Experiment { catalogue, measured, .. } = experiment;
    let [simulated_talk, measured_talk] = [catalogue, measured].map(Experiment::z_to_x);
    // Half a digit, and two standard errors of the plane fit: the probe has the paper's uncertainty.
    let tolerance = 0.005 + 2.0 * measured.deviation_um_s2_per_m[(X, Z)];
    vec![
        Outcome::new(
            "circle of 2 mm at 5 m/s²: frequency",
            Printed::to_digit(8.0, 1.0),
            catalogue.rad_per_s / std::f64::consts::TAU,
            "Hz",
        ),
        Outcome::new(
            "circle, simulated: acceleration reached",
            Printed::to_digit(4.7, 0.1),
            catalogue.reached_m_per_s2,
            "m/s²",
        ),
        Outcome::new(
            "cross-talk of z to x, simulated with catalogue stiffness",
            Printed::to_digit(-0.55, 0.01),
            simulated_talk,
            TALK,
        ),
        Outcome::new(
            "cross-talk of z to x, measured",
            Printed::Figure { value: -1.55, tolerance },
            measured_talk,
            TALK,
        ),
        Outcome::new(
            "cross-talk, measured over simulated",
            Printed::Between(2.0, 3.0),
            measured_talk / simulated_talk,
            "",
        ),
    ]
}

/// The 20 mm movement in z (section 3.4).
fn on_the_move(experiment: &Experiment) -> Vec<Outcome> {
    let (peak, deviation) = experiment.simulated_move.peak(X);
    let [commanded, ..] = experiment.commanded;
    vec![
        Outcome::new("20 mm move: acceleration reached", Printed::to_digit(7.9, 0.1), peak, "m/s²"),
        Outcome::new("20 mm move: deviation in x then", Printed::to_digit(3.7, 0.1), deviation.abs(), "µm"),
        Outcome::new(
            "20 mm move: cross-talk of z to x then",
            Printed::to_digit(-0.48, 0.01),
            deviation / peak,
            TALK,
        ),
        Outcome::new(
            "20 mm move: set acceleration, below its limit of 10",
            Printed::Below(z_move::PRINTED.acceleration_m_per_s2),
            commanded.acceleration_m_per_s2,
            "m/s²",
        ),
        Outcome::new(
            "20 mm move: jerk at its limit",
            Printed::to_digit(250.0, 1.0),
            commanded.jerk_m_per_s3,
            "m/s³",
        ),
        Outcome::new(
            "20 mm move: speed at its limit",
            Printed::to_digit(0.5, 0.01),
            commanded.speed_m_per_s,
            "m/s",
        ),
    ]
}

/// Which part of the catalogue's model is wrong.
fn identification(experiment: &Experiment) -> Vec<Outcome> {
    vec![
        Outcome::new(
            "guideways against the next best part: error left on judging circles",
            Printed::Below(1.0),
            experiment.guideways_over_next(),
            "",
        ),
        // "Quite good accordance": within the standard uncertainty of the probe, half of the printed U(k = 2).
        Outcome::new(
            "error left on judging circles by the identified machine",
            Printed::Below(machines::WEIGHTS.tool_um),
            experiment.residuals_um()[2],
            "µm",
        ),
    ]
}
