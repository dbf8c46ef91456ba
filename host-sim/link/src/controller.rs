//! The interface between simulator and controller, and the controller in this process.

use shared::axis::Reading;
use shared::compensate::CompensationSettings;
use shared::config::{AxisSettings, Rates};
use shared::interpolate::{Block, Joint, Ramps};
use shared::machine::{Machine, MachineError};
use shared::safety::{Fault, Power};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

/// Maximum number of axes of a machine.
pub const MAX_AXES: usize = 3;

/// Output of a tick for one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisOutput {
    /// Force until the next tick, N.
    pub force_n: f64,
    /// The same force as bits of the controller's number format; narrower formats use the low bits.
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

/// A block of the path for any number of axes; see [`shared::interpolate::Block`].
#[derive(Clone, Debug, PartialEq)]
pub struct PathBlock {
    /// Geometry.
    pub shape: PathShape,
    /// Speed along the path, m/s.
    pub feed_m_per_s: f64,
    /// Acceleration along the path, m/s².
    pub acceleration_m_per_s2: f64,
    /// Profile of the speed at start and end.
    pub ramps: Ramps,
    /// Transition to the next block.
    pub joint: Joint,
}

/// Geometry of a [`PathBlock`].
#[derive(Clone, Debug, PartialEq)]
pub enum PathShape {
    /// Standstill.
    Dwell {
        /// Duration, s.
        seconds: f64,
    },
    /// A straight line to a point.
    Line {
        /// End point, one coordinate per axis, m.
        to_m: Vec<f64>,
    },
    /// An arc about a centre.
    Arc {
        /// Indices of the two axes.
        plane: [u8; 2],
        /// Centre in those axes, m.
        centre_m: [f64; 2],
        /// Number of turns, positive from the first axis to the second.
        turns: f64,
    },
    /// An arc about a centre to a point on its circle.
    ArcTo {
        /// Indices of the two axes.
        plane: [u8; 2],
        /// Centre in those axes, m.
        centre_m: [f64; 2],
        /// End point in those axes, m.
        to_m: [f64; 2],
        /// Whether it turns from the first axis to the second.
        positive: bool,
    },
}

impl PathBlock {
    /// A shape with trapezoidal ramps, from rest to rest.
    #[must_use]
    pub const fn new(shape: PathShape, feed_m_per_s: f64, acceleration_m_per_s2: f64) -> Self {
        Self { shape, feed_m_per_s, acceleration_m_per_s2, ramps: Ramps::Trapezoid, joint: Joint::Stop }
    }

    /// A standstill of some seconds.
    #[must_use]
    pub const fn dwell(seconds: f64) -> Self {
        Self::new(PathShape::Dwell { seconds }, 0.0, 0.0)
    }

    /// The block for a machine of `N` axes; `None` if the number of coordinates differs.
    #[must_use]
    pub fn for_axes<const N: usize>(&self) -> Option<Block<N>> {
        use shared::interpolate::block::Shape;
        let shape = match &self.shape {
            PathShape::Dwell { seconds } => Shape::Dwell { seconds: *seconds },
            PathShape::Line { to_m } => Shape::Line { to_m: to_m.as_slice().try_into().ok()? },
            PathShape::Arc { plane, centre_m, turns } => {
                Shape::Arc { plane: *plane, centre_m: *centre_m, turns: *turns }
            }
            PathShape::ArcTo { plane, centre_m, to_m, positive } => {
                Shape::ArcTo { plane: *plane, centre_m: *centre_m, to_m: *to_m, positive: *positive }
            }
        };
        Some(Block {
            shape,
            feed_m_per_s: self.feed_m_per_s,
            acceleration_m_per_s2: self.acceleration_m_per_s2,
            ramps: self.ramps,
            joint: self.joint,
        })
    }
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
        for ((out, force), command) in outputs.iter_mut().zip(output.forces).zip(output.commands) {
            *out = AxisOutput { force_n: force.value(), force_bits: force.bits(), command };
        }
        Ok(Status { power: self.power(), warning: output.warning, done: output.done, cost: None })
    }
}

/// The number format of a controller in this process.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// Fixed point, as on the chip.
    #[default]
    Fixed,
    /// Single precision.
    F32,
    /// Double precision.
    F64,
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
