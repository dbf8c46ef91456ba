//! Accuracy of machine tools and the dual feedback system (Soeda 1977).
//!
//! - [`lot_scatter`]: the scatter of two lots of turned parts (tables 1 to 4).
//! - [`error_budget`]: the sum of independent errors, on the paper's design example.
//! - [`resolver`]: the resolver's dividing error.
//! - [`closed_forms`] and [`bode`]: the appendix, in the time and frequency domains, against the controller's dual
//!   feedback in an [`ideal_loop`].
//! - [`comparison`]: semi-closed, full-closed and dual feedback on one [`simulated_axis`].

mod bode;
mod closed_forms;
mod comparison;
mod error_budget;
mod frequency_response;
mod ideal_loop;
mod lot_scatter;
mod plotting;
mod resolver;
mod simulated_axis;

use super::study::{ReproduceError, Study};

/// Runs the experiments of the paper.
///
/// # Errors
/// If a simulation or a fit fails.
pub fn run() -> Result<Study, ReproduceError> {
    let mut study = Study {
        paper: "Soeda 1977",
        title: "Accuracy for machine tools and the dual feedback system",
        findings: Vec::new(),
        outcomes: Vec::new(),
        pictures: Vec::new(),
        notes: Vec::new(),
    };
    lot_scatter::add(&mut study);
    error_budget::add(&mut study);
    resolver::add(&mut study)?;
    closed_forms::add(&mut study);
    bode::add(&mut study)?;
    comparison::add(&mut study)?;
    Ok(study)
}
