//! Where the controller of a simulated machine runs.

use lockstep::emulator::DEFAULT_TIMEOUT;
use lockstep::remote::Remote;
use model::machine::Machine;
use plant::controller::Controller;
use plant::simulate::{self, SimulationError};
use shared::scalar::Format;

/// Where a controller runs. Its results are the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControllerHost {
    /// In this process.
    Host,
    /// On the emulated core.
    EmulatedCore,
}

impl ControllerHost {
    /// The emulated core if the emulator is installed and its program is built; this process otherwise.
    #[must_use]
    pub fn found() -> Self {
        if lockstep::open("emulated", DEFAULT_TIMEOUT).is_ok() { Self::EmulatedCore } else { Self::Host }
    }

    /// A fixed-point controller for a machine at rest at `start_m`, drives off.
    ///
    /// # Errors
    /// If the file lacks a key, a setting is refused, or the emulator does not answer.
    pub fn controller(
        self,
        machine: &Machine,
        start_m: &[f64],
    ) -> Result<Box<dyn Controller>, SimulationError> {
        match self {
            Self::Host => simulate::controller(machine, Format::Fixed, start_m),
            Self::EmulatedCore => {
                let (settings, start) = simulate::controller_setup(machine, start_m)?;
                let connection = lockstep::open("emulated", DEFAULT_TIMEOUT)?;
                Ok(Box::new(Remote::set_up(connection, Format::Fixed, machine.rates(), &settings, &start)?))
            }
        }
    }

    /// The words for a sentence: "the controller ran …".
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Host => "in this process",
            Self::EmulatedCore => "on the emulated core",
        }
    }
}
