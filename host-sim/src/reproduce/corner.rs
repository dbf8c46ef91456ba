//! Motion error at the corner (Matsubara).

use super::{ReproduceError, Study};

/// Runs the experiments of the paper.
///
/// # Errors
/// When a loop does not hold.
pub fn run() -> Result<Study, ReproduceError> {
    Ok(Study {
        paper: "Matsubara",
        title: "Motion error at the corner",
        said: Vec::new(),
        outcomes: Vec::new(),
        pictures: Vec::new(),
        notes: Vec::new(),
    })
}
