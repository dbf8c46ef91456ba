//! Motion error at the corner (Matsubara, Hatozaki, Ibaraki).
//!
//! A machining centre moves along two 45° lines at three position gains. The motors are predicted from the command by
//! the controller's equations, and the tool from the motors by one second-order system per axis, identified at the
//! lowest gain.
//!
//! - [`machine`]: the plant. [`drive_model`]: the prediction. [`identify`]: ωi and ζi of the prediction from a log.
//! - [`contour`]: overshoot, rounding and distance of contours.
//! - [`circle_shrinkage`]: the feed-forward that keeps a circle's radius.
//! - [`rapid_move`]: speed and acceleration of table 1.
//! - [`experiment`]: runs all simulations; [`outcomes`], [`sentences`] and [`pictures`] present the result.

mod circle_shrinkage;
mod contour;
mod drive_model;
mod experiment;
mod identify;
mod machine;
mod outcomes;
mod pictures;
mod rapid_move;
mod sentences;

use super::study::{ReproduceError, Study};
use experiment::Experiment;

/// Runs the experiments of the paper.
///
/// # Errors
/// If a simulation or a fit fails.
pub fn run() -> Result<Study, ReproduceError> {
    let experiment = Experiment::run()?;
    Ok(Study {
        paper: "Matsubara",
        title: "Motion error at the corner",
        findings: sentences::findings(&experiment),
        outcomes: outcomes::all(&experiment),
        pictures: pictures::all(&experiment)?,
        notes: sentences::notes(&experiment),
    })
}
