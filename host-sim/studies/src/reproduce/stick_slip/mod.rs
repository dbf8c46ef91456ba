//! Stick-slip in the circular test (Chattopadhyay 2008).
//!
//! - [`table_model`]: the paper's equation of motion.
//! - [`contributors`]: the other contributors to circle error that the paper lists, from
//!   [`simulated_circle`] or [`closed_form_circle`].
//! - [`experiment`]: runs all simulations; [`outcomes`], [`sentences`] and [`pictures`] present the result.

mod closed_form_circle;
mod contributors;
mod experiment;
mod lap;
mod outcomes;
mod pictures;
mod sentences;
mod simulated_circle;
mod table_model;

use super::study::{ReproduceError, Study};
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
