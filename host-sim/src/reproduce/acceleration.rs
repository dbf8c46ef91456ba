//! Acceleration-correlated position errors (Nguyen).

use super::{ReproduceError, Study};

/// Runs the experiments of the paper.
///
/// # Errors
/// When a loop does not hold.
pub fn run() -> Result<Study, ReproduceError> {
    Ok(Study {
        paper: "Nguyen",
        title: "Acceleration-correlated position errors",
        said: Vec::new(),
        outcomes: Vec::new(),
        pictures: Vec::new(),
        notes: Vec::new(),
    })
}
