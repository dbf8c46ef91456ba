//! Comparison of the paper's values with ours.

use super::contributors::Contributor;
use super::experiment::{Experiment, StickSlip};
use crate::reproduce::study::{Outcome, Printed};
use contour::circular_test::{Ballbar, to_axis_rad};

/// The error printed for the lower speed, µm.
const ERROR_UM: Printed = Printed::Between(2.0, 3.0);

/// All outcomes.
pub fn all(experiment: &Experiment) -> Vec<Outcome> {
    let shapes = experiment.contributors.iter();
    stick_slip(&experiment.stick_slip)
        .into_iter()
        .chain(shapes.filter_map(|(contributor, ballbar)| shape(contributor, ballbar)))
        .collect()
}

fn stick_slip([lower, higher]: &[StickSlip; 2]) -> Vec<Outcome> {
    let (lower_um, higher_um) = (lower.lap.peak_to_peak_um(), higher.lap.peak_to_peak_um());
    let radial_um = [lower, higher].map(|run| run.ballbar.circular_deviation_um());
    let [lower_deg, higher_deg] = [lower, higher].map(StickSlip::max_error_to_axis_degrees);
    // Closer to an axis than to a diagonal.
    let at_an_axis = || Printed::Below(22.5);
    let more = Printed::Above(1.0);
    vec![
        Outcome::new("deviation of X from end to end, 0.5 rad/s", ERROR_UM, lower_um[0], "µm"),
        Outcome::new("deviation of Y from end to end, 0.5 rad/s", ERROR_UM, lower_um[1], "µm"),
        Outcome::new("deviation of X, 1.5 over 0.5 rad/s", more.clone(), higher_um[0] / lower_um[0], ""),
        Outcome::new("deviation of Y, 1.5 over 0.5 rad/s", more.clone(), higher_um[1] / lower_um[1], ""),
        Outcome::new("the same error read radially, 0.5 rad/s", ERROR_UM, radial_um[0], "µm"),
        Outcome::new("radial error, 1.5 over 0.5 rad/s", more, radial_um[1] / radial_um[0], ""),
        Outcome::new("quadrant change to greatest radial error, 0.5 rad/s", at_an_axis(), lower_deg, "°"),
        Outcome::new("quadrant change to greatest radial error, 1.5 rad/s", at_an_axis(), higher_deg, "°"),
    ]
}

/// The paper's statement on the shape of a contributor; `None` if there is none.
fn shape(contributor: &Contributor, ballbar: &Ballbar) -> Option<Outcome> {
    match contributor {
        Contributor::Squareness { .. } => {
            let fraction = ballbar.positive.oval_fraction().min(ballbar.negative.oval_fraction());
            let bound = Printed::Above(0.5);
            Some(Outcome::new("squareness: share of the oval in the error", bound, fraction, ""))
        }
        Contributor::Backlash { width_um } => {
            let [x, y] = ballbar.reversal_um();
            let ratio = 0.5 * (x + y) / width_um;
            Some(Outcome::new("backlash: reversal value over its width", Printed::Above(0.5), ratio, ""))
        }
        Contributor::MasterSlaveChangeover { .. } => {
            let degrees = to_axis_rad(ballbar.positive.max_change_rad()).to_degrees();
            let printed = Printed::to_digit(45.0, 1.0);
            Some(Outcome::new("changeover: the glitch, from an axis", printed, degrees, "°"))
        }
        _ => None,
    }
}
