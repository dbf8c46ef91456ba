//! The controller in the loop: `shared` in this process, or on a chip at the end of a link.

use shared::axis::Reading;
use shared::config::{AxisSettings, Rates};
use shared::interpolate::{Block, Joint, Ramps};
use shared::machine::{Machine, MachineError};
use shared::safety::{Fault, Power};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

/// The most axes that a machine may have.
pub const MOST_AXES: usize = 3;

/// What a tick asks of one drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisOutput {
    /// Force until the next tick, N.
    pub force_n: f64,
    /// The same force to the last bit of the controller's number format.
    pub force_bits: u64,
    /// Where the path is.
    pub command: Position,
}

/// How the machine stands after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Status {
    /// State of the drives.
    pub power: Power,
    /// The first fault that the machine has gone on with.
    pub warning: Option<Fault>,
    /// Whether every block has been travelled.
    pub done: bool,
    /// Cost of the tick where it is counted: instructions on the emulated core.
    pub cost: Option<u32>,
}

/// A block of any number of axes; see [`shared::interpolate::Block`].
#[derive(Clone, Debug, PartialEq)]
pub struct PathBlock {
    /// Geometry.
    pub shape: PathShape,
    /// Along the path, m/s.
    pub feed_m_per_s: f64,
    /// m/s².
    pub acceleration_m_per_s2: f64,
    /// How the speed rises and falls.
    pub ramps: Ramps,
    /// How the path goes on behind it.
    pub joint: Joint,
}

/// Geometry of a [`PathBlock`].
#[derive(Clone, Debug, PartialEq)]
pub enum PathShape {
    /// Stand still.
    Dwell {
        /// How long.
        seconds: f64,
    },
    /// Straight to a point.
    Line {
        /// One coordinate an axis.
        to_m: Vec<f64>,
    },
    /// Round a centre.
    Arc {
        /// Numbers of the two axes.
        plane: [u8; 2],
        /// Centre in those axes.
        centre_m: [f64; 2],
        /// Signed turns.
        turns: f64,
    },
    /// Round a centre to a point on the circle.
    ArcTo {
        /// Numbers of the two axes.
        plane: [u8; 2],
        /// Centre in those axes.
        centre_m: [f64; 2],
        /// End point in those axes.
        to_m: [f64; 2],
        /// From the first axis towards the second.
        positive: bool,
    },
}

impl PathBlock {
    /// A shape with trapezoidal ramps, from rest to rest.
    #[must_use]
    pub const fn new(shape: PathShape, feed_m_per_s: f64, acceleration_m_per_s2: f64) -> Self {
        Self { shape, feed_m_per_s, acceleration_m_per_s2, ramps: Ramps::Trapezoid, joint: Joint::Stop }
    }

    /// A pause.
    #[must_use]
    pub const fn dwell(seconds: f64) -> Self {
        Self::new(PathShape::Dwell { seconds }, 0.0, 0.0)
    }

    /// The block for a machine of `N` axes; `None` if it is for another number.
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

/// Why the controller could not go on.
#[derive(Debug, thiserror::Error)]
pub enum ControllerError {
    /// Settings or blocks were refused.
    #[error(transparent)]
    Refused(#[from] MachineError),
    /// A machine of this many axes cannot be controlled.
    #[error("{0} axes: expected 1 to {MOST_AXES}")]
    Axes(usize),
    /// There is no such port, or its board has not what the machine needs.
    #[error("port: {0}")]
    Port(String),
    /// The link to a board failed.
    #[error("link: {0}")]
    Link(String),
}

/// A controller of some machine, wherever it runs. All slices hold one element an axis.
pub trait Controller {
    /// Appends a block to the path.
    ///
    /// # Errors
    /// When the block is refused or the link fails.
    fn push(&mut self, block: &PathBlock) -> Result<(), ControllerError>;

    /// Switches the drives on with the next tick.
    ///
    /// # Errors
    /// When the link fails.
    fn enable(&mut self) -> Result<(), ControllerError>;

    /// One tick.
    ///
    /// # Errors
    /// When the link fails.
    fn tick(&mut self, readings: &[Reading], outputs: &mut [AxisOutput]) -> Result<Status, ControllerError>;
}

impl<S: Scalar, const N: usize> Controller for Machine<S, N> {
    fn push(&mut self, block: &PathBlock) -> Result<(), ControllerError> {
        let block = block.for_axes::<N>().ok_or(ControllerError::Axes(N))?;
        Ok(Machine::push(self, &block).map_err(MachineError::from)?)
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

/// `shared` in this process.
///
/// # Errors
/// When settings are refused or there are too many axes.
pub fn in_process(
    format: Format,
    rates: Rates,
    settings: &[AxisSettings],
    start: &[Position],
) -> Result<Box<dyn Controller>, ControllerError> {
    match format {
        Format::Fixed => of_axes::<Fixed>(rates, settings, start),
        Format::F32 => of_axes::<f32>(rates, settings, start),
        Format::F64 => of_axes::<f64>(rates, settings, start),
    }
}

fn of_axes<S: Scalar>(
    rates: Rates,
    settings: &[AxisSettings],
    start: &[Position],
) -> Result<Box<dyn Controller>, ControllerError> {
    fn machine<S: Scalar, const N: usize>(
        rates: Rates,
        settings: &[AxisSettings],
        start: &[Position],
    ) -> Result<Box<dyn Controller>, ControllerError> {
        let wrong = || ControllerError::Axes(settings.len());
        let settings = settings.try_into().map_err(|_| wrong())?;
        let start = start.try_into().map_err(|_| wrong())?;
        Ok(Box::new(Machine::<S, N>::new(rates, settings, start)?))
    }
    match settings.len() {
        1 => machine::<S, 1>(rates, settings, start),
        2 => machine::<S, 2>(rates, settings, start),
        3 => machine::<S, 3>(rates, settings, start),
        n => Err(ControllerError::Axes(n)),
    }
}
