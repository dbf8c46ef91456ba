//! Stick-slip in the circular test (Chattopadhyay 2008).

use super::{ReproduceError, Study};

/// Runs the experiments of the paper.
///
/// # Errors
/// When a loop does not hold.
pub fn run() -> Result<Study, ReproduceError> {
    Ok(Study {
        paper: "Chattopadhyay 2008",
        title: "Stick-slip in the circular test",
        said: Vec::new(),
        outcomes: Vec::new(),
        pictures: Vec::new(),
        notes: Vec::new(),
    })
}
