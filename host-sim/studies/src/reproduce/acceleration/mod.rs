//! Measurement and simulation of acceleration-correlated position errors (Nguyen, Weikert, Wegener).
//!
//! - [`machines`]: the machine with the data of the catalogue, the true one, their gains and instruments.
//! - [`closed_loop`]: position and velocity control of either machine.
//! - [`circles`]: the paper's measurement on circles, and its evaluation.
//! - [`least_squares`]: linear fits, and the ellipse fit.
//! - [`identify`]: finds which value of the catalogue is wrong.
//! - [`z_move`]: the 20 mm movement in z.
//! - [`experiment`]: runs all simulations; [`outcomes`], [`sentences`] and [`pictures`] present the result.

mod circles;
mod closed_loop;
mod experiment;
mod identify;
mod least_squares;
mod machines;
mod outcomes;
mod pictures;
mod sentences;
mod z_move;

use super::study::{ReproduceError, Study};
use experiment::Experiment;

/// Runs the experiments of the paper.
///
/// # Errors
/// If a simulation or a fit fails.
pub fn run() -> Result<Study, ReproduceError> {
    let experiment = Experiment::run()?;
    Ok(Study {
        paper: "Nguyen",
        title: "Acceleration-correlated position errors",
        findings: sentences::findings(&experiment),
        outcomes: outcomes::all(&experiment),
        pictures: pictures::all(&experiment),
        notes: sentences::NOTES.map(str::to_owned).to_vec(),
    })
}
