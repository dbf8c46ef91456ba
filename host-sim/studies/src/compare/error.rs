//! Why a comparison could not be made.

use shared::interpolate::PathError;
use shared::machine::MachineError;
use shared::safety::Fault;

use files::error::InputError;
use link::controller::ControllerError;
use plant::simulate::SimulationError;

/// Why a comparison could not be made.
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
    #[error("{motion}: the drives went off: {fault:?}")]
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
