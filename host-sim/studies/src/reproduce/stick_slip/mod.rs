//! Stick-slip in the circular test (Chattopadhyay 2008).
//!
//! - [`table_model`]: the paper's equation of motion.
//! - [`contributors`]: the other contributors to circle error that the paper lists, from
//!   [`simulated_circle`] or [`closed_form_circle`].
//! - [`experiment`]: runs all simulations; [`outcomes`], [`sentences`] and [`pictures`] present the result.

mod closed_form_circle;
mod contributors;
mod experiment;
mod outcomes;
mod pictures;
mod sentences;
mod simulated_circle;
mod table_model;

use super::study::{ReproduceError, Study};
use contour::circular_test::Lap;
use experiment::Experiment;

/// Runs the experiments of the paper.
///
/// # Errors
/// If a simulation or an integration fails.
pub fn run() -> Result<Study, ReproduceError> {
    let experiment = Experiment::run()?;
    Ok(Study {
        paper: "Chattopadhyay 2008",
        title: "Stick-slip in the circular test",
        findings: sentences::findings(&experiment),
        outcomes: outcomes::all(&experiment),
        pictures: pictures::all(&experiment),
        notes: sentences::notes(&experiment),
    })
}

/// [`Lap::from_path`], which requires finite points.
fn lap(path_m: &[[f64; 2]], radius_m: f64) -> Result<Lap, ReproduceError> {
    let no_points = || ReproduceError::Numerics("a circular path without finite points".to_owned());
    Lap::from_path(path_m, radius_m).ok_or_else(no_points)
}
