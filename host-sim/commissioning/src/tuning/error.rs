//! Why no settings can be proposed.

use crate::compensate::prediction::PredictionError;
use crate::margins::MarginError;

/// Why no settings can be proposed.
#[derive(Debug, thiserror::Error)]
pub enum TuningError {
    /// The machine file lacks what the margins follow from.
    #[error(transparent)]
    Margins(#[from] MarginError),
    /// The machine cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] PredictionError),
    /// A measured response cannot be used.
    #[error("the response of {axis}: {problem}")]
    Measured {
        /// Name of the axis.
        axis: String,
        /// What was expected, and what was found.
        problem: String,
    },
    /// No velocity loop of an axis has the margins.
    #[error("axis {axis}: no gain of the velocity loop has the margins")]
    NoVelocityLoop {
        /// Name of the axis.
        axis: String,
    },
}
