//! What the closed loop needs of a controller, and the controller in this process.

use motion::{MAX_AXES, PathBlock};
use shared::axis::Reading;
use shared::compensate::CompensationSettings;
use shared::config::{AxisSettings, Rates};
use shared::machine::{Machine, MachineError};
use shared::safety::{Fault, Power};
use shared::scalar::{Fixed, Format, Scalar};
use shared::units::Position;

/// Output of a tick for one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisOutput {
    /// Force until the next tick, N.
    pub force_n: f64,
    /// The force as bits of the controller's number format; narrower formats use the low bits.
    pub force_bits: u64,
    /// Position command of the path.
    pub command: Position,
}

/// State of the machine after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Status {
    /// State of the drives.
    pub power: Power,
    /// The first fault that did not stop the machine.
    pub warning: Option<Fault>,
    /// Whether all blocks are finished.
    pub done: bool,
    /// Number of instructions of the tick, if counted (on the emulated core).
    pub cost: Option<u32>,
}

/// Errors of a controller.
#[derive(Debug, thiserror::Error)]
pub enum ControllerError {
    /// Settings or blocks were refused.
    #[error(transparent)]
    Refused(#[from] MachineError),
    /// There is no controller for this number of axes.
    #[error("{0} axes: expected 1 to {MAX_AXES}")]
    Axes(usize),
    /// There is no such port, or its controller has too few axes.
    #[error("port: {0}")]
    Port(String),
    /// This kind of controller does not have the function.
    #[error("{0}: this controller does not have it")]
    NotSupported(&'static str),
    /// The connection failed.
    #[error("link: {0}")]
    Link(String),
}

/// A controller of a machine, in this process or elsewhere. All slices have one element per axis.
pub trait Controller {
    /// Appends a block to the path.
    ///
    /// # Errors
    /// If the block is refused or the connection fails.
    fn push(&mut self, block: &PathBlock) -> Result<(), ControllerError>;

    /// Replaces the compensation of an axis, counted from 0; also during motion, as the corrections change over at their
    /// limited rates.
    ///
    /// # Errors
    /// If a setting is refused ([`MachineError::Config`] with its name; nothing is changed then), the machine has no such
    /// axis, or the connection fails.
    fn compensate(&mut self, axis: usize, settings: &CompensationSettings) -> Result<(), ControllerError>;

    /// Switches the drives on at the next tick.
    ///
    /// # Errors
    /// If the connection fails.
    fn enable(&mut self) -> Result<(), ControllerError>;

    /// Runs one tick of the velocity loop: readings in, outputs out.
    ///
    /// # Errors
    /// If the number of axes is wrong or the connection fails.
    fn tick(&mut self, readings: &[Reading], outputs: &mut [AxisOutput]) -> Result<Status, ControllerError>;
}

impl<S: Scalar, const N: usize> Controller for Machine<S, N> {
    fn push(&mut self, block: &PathBlock) -> Result<(), ControllerError> {
        let block = block.for_axes::<N>().ok_or(ControllerError::Axes(N))?;
        Ok(Machine::push(self, &block).map_err(MachineError::from)?)
    }

    fn compensate(&mut self, axis: usize, settings: &CompensationSettings) -> Result<(), ControllerError> {
        Ok(Machine::compensate(self, axis, settings)?)
    }

    fn enable(&mut self) -> Result<(), ControllerError> {
        Machine::enable(self);
        Ok(())
    }

    fn tick(&mut self, readings: &[Reading], outputs: &mut [AxisOutput]) -> Result<Status, ControllerError> {
        let readings: &[Reading; N] =
            readings.try_into().map_err(|_| ControllerError::Axes(readings.len()))?;
        let output = Machine::tick(self, readings);
        // As a board does.
        self.prepare();
        for ((out, force), command) in outputs.iter_mut().zip(output.forces).zip(output.commands) {
            *out = AxisOutput { force_n: force.value(), force_bits: force.bits(), command };
        }
        Ok(Status { power: self.power(), warning: output.warning, done: output.done, cost: None })
    }
}

/// The controller of the crate `shared` in this process, with the drives off, at position `start`.
///
/// # Errors
/// If settings are refused or there are too many axes.
pub fn in_process(
    format: Format,
    rates: Rates,
    settings: &[AxisSettings],
    start: &[Position],
) -> Result<Box<dyn Controller>, ControllerError> {
    match format {
        Format::Fixed => for_settings::<Fixed>(rates, settings, start),
        Format::F32 => for_settings::<f32>(rates, settings, start),
        Format::F64 => for_settings::<f64>(rates, settings, start),
    }
}

fn for_settings<S: Scalar>(
    rates: Rates,
    settings: &[AxisSettings],
    start: &[Position],
) -> Result<Box<dyn Controller>, ControllerError> {
    fn machine<S: Scalar, const N: usize>(
        rates: Rates,
        settings: &[AxisSettings],
        start: &[Position],
    ) -> Result<Box<dyn Controller>, ControllerError> {
        let error = || ControllerError::Axes(settings.len());
        let settings = settings.try_into().map_err(|_| error())?;
        let start = start.try_into().map_err(|_| error())?;
        Ok(Box::new(Machine::<S, N>::new(rates, settings, start)?))
    }
    match settings.len() {
        1 => machine::<S, 1>(rates, settings, start),
        2 => machine::<S, 2>(rates, settings, start),
        3 => machine::<S, 3>(rates, settings, start),
        n => Err(ControllerError::Axes(n)),
    }
}
