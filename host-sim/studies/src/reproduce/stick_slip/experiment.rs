//! All simulations of the paper.

use super::contributors::{CONTRIBUTORS, Contributor};
use super::table_model::{self, CircularPath, Deflections, SPEEDS_RAD_PER_S};
use crate::reproduce::study::ReproduceError;
use contour::circular_test::{Ballbar, to_axis_rad};

/// Results of all simulations.
pub struct Experiment {
    /// The paper's tables at the lower and the higher speed.
    pub stick_slip: [StickSlip; 2],
    /// Each contributor with its circular test.
    pub contributors: Vec<(Contributor, Ballbar)>,
}

impl Experiment {
    /// Runs everything.
    ///
    /// # Errors
    /// If a simulation or an integration fails.
    pub fn run() -> Result<Self, ReproduceError> {
        let [lower, higher] = SPEEDS_RAD_PER_S;
        Ok(Self {
            stick_slip: [StickSlip::at(lower)?, StickSlip::at(higher)?],
            contributors: CONTRIBUTORS
                .into_iter()
                .map(|contributor| Ok((contributor.clone(), contributor.ballbar()?)))
                .collect::<Result<Vec<_>, ReproduceError>>()?,
        })
    }
}

/// The paper's tables on the circle at one speed.
pub struct StickSlip {
    /// Deflections over one lap, counter-clockwise.
    pub lap: Deflections,
    /// The circular test in both directions.
    pub ballbar: Ballbar,
}

impl StickSlip {
    fn at(speed_rad_per_s: f64) -> Result<Self, ReproduceError> {
        let lap = Deflections::on(CircularPath { speed_rad_per_s })?;
        Ok(Self { lap, ballbar: table_model::ballbar(speed_rad_per_s)? })
    }

    /// Angle from the nearest quadrant change to the maximum radial error, degrees.
    pub fn max_error_to_axis_degrees(&self) -> f64 {
        to_axis_rad(self.ballbar.positive.max_deviation_rad()).to_degrees()
    }
}
