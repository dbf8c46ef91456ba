//! Errors of a comparison.

use shared::interpolate::PathError;
use shared::machine::MachineError;
use shared::safety::Fault;

use files::error::InputError;
use plant::controller::ControllerError;
use plant::simulate::SimulationError;

/// Errors of a comparison.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// The built-in machine file is refused.
    #[error(transparent)]
    Machine(#[from] InputError),
    /// The machine cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A controller refused the motion, or the link broke.
    #[error(transparent)]
    Controller(#[from] ControllerError),
    /// A controller switched the drives off.
    #[error("{motion}: the drives were switched off: {fault:?}")]
    Fault {
        /// Name of the motion.
        motion: &'static str,
        /// The fault that the controller reports.
        fault: Fault,
    },
}

impl From<PathError> for CompareError {
    fn from(error: PathError) -> Self {
        Self::Controller(MachineError::Path(error).into())
    }
}
