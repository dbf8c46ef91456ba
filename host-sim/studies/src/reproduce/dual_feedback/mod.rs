//! Accuracy for machine tools and the dual feedback system (Soeda 1977).
//!
//! One file a part of the paper: the turned lots, the sums of errors and the resolver's own, the closed forms of
//! the dual feedback system, and that system beside the two that it stands between.

mod bode;
mod closed_forms;
mod errors;
mod lots;
mod resolver;
mod response;
mod systems;
mod trial;

use super::{ReproduceError, Study};

/// Runs the experiments of the paper.
///
/// # Errors
/// When a loop does not hold.
pub fn run() -> Result<Study, ReproduceError> {
    let mut study = Study {
        paper: "Soeda 1977",
        title: "Accuracy for machine tools and the dual feedback system",
        said: Vec::new(),
        outcomes: Vec::new(),
        pictures: Vec::new(),
        notes: Vec::new(),
    };
    lots::add(&mut study);
    errors::add(&mut study);
    resolver::add(&mut study)?;
    closed_forms::add(&mut study);
    bode::add(&mut study)?;
    systems::add(&mut study)?;
    Ok(study)
}

/// A figure whose tolerance is half of its last digit, `unit` being one in that digit.
fn printed(value: f64, unit: f64) -> super::Printed {
    super::Printed::Figure { value, tolerance: 0.5 * unit }
}
