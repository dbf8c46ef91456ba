//! A controller at the other end of a connection that answers each frame with one frame.

use shared::SOURCES;
use shared::axis::Reading;
use shared::compensate::{AxisCompensation, AxisOf, CompensationSettings};
use shared::config::{AxisSettings, Rates};
use shared::interpolate::PathError;
use shared::lockstep::protocol::{
    self, AXES, Answer, FRAME, LONGEST_ORDER, Order, PART, Part, Rejection, Setup, TickResult,
};
use shared::machine::MachineError;
use shared::scalar::{Fixed, Format, Scalar};
use shared::units::Position;

use motion::{PathBlock, PathShape};
use plant::controller::{AxisOutput, Controller, ControllerError, Status, in_process};

/// One frame of the protocol.
pub type Frame = [u8; FRAME];

/// A connection that answers frames.
pub trait Connection {
    /// Sends a frame and replaces it by the answer.
    ///
    /// # Errors
    /// The failure of the connection, in one line.
    fn exchange(&mut self, frame: &mut Frame) -> Result<(), String>;
}

/// Checks that the program at the other end was built from the same sources as this one.
///
/// # Errors
/// [`ControllerError::Link`] if it was not, or the connection fails.
pub fn identify(connection: &mut impl Connection) -> Result<(), ControllerError> {
    let mut frame = [0; FRAME];
    protocol::encode(&Order::Identify, &mut frame).map_err(|error| unexpected(&error))?;
    connection.exchange(&mut frame).map_err(ControllerError::Link)?;
    match protocol::decode(&frame) {
        Ok(Answer::Sources(SOURCES)) => Ok(()),
        _ => Err(ControllerError::Link(
            "the program of the emulated core has another version than this one: build it with `cargo emulated`"
                .to_owned(),
        )),
    }
}

/// The controller of a machine of one or two axes at the other end of a connection.
///
/// The protocol has two axes. For a machine of one axis, the second axis is at rest at 0. It adds exactly 0 to every path
/// length, so that the results of the first axis are bit-identical to those without it.
#[derive(Debug)]
pub struct Remote<C: Connection> {
    connection: C,
    format: Format,
    rates: Rates,
    axes: usize,
}

impl<C: Connection> Remote<C> {
    /// Configures the controller at the other end, with the drives off.
    ///
    /// # Errors
    /// [`ControllerError::Refused`] if the same controller in this process refuses the settings; [`ControllerError::Port`]
    /// for more axes than the protocol has; [`ControllerError::Link`] if the connection fails.
    pub fn set_up(
        connection: C,
        format: Format,
        rates: Rates,
        settings: &[AxisSettings],
        start: &[Position],
    ) -> Result<Self, ControllerError> {
        in_process(format, rates, settings, start)?;
        let axes = settings.len();
        if axes > AXES {
            return Err(ControllerError::Port(format!(
                "expected a machine of 1 to {AXES} axes, found {axes}"
            )));
        }
        let setup =
            Setup { format, rates, axes: padded(settings, settings[0]), start: padded(start, Position(0)) };
        let mut remote = Self { connection, format, rates, axes };
        remote.command(&Order::Setup(setup))?;
        Ok(remote)
    }

    /// Sends an order, in parts if it does not fit into one frame; returns the answer.
    fn request(&mut self, order: &Order) -> Result<Answer, ControllerError> {
        let mut frame = [0; FRAME];
        if protocol::encode(order, &mut frame).is_ok() {
            return self.exchange(frame);
        }
        let mut bytes = [0; LONGEST_ORDER];
        let bytes = postcard::to_slice(order, &mut bytes).map_err(|error| unexpected(&error))?;
        let mut pieces = bytes.chunks(PART).peekable();
        loop {
            let piece = heapless::Vec::from_slice(pieces.next().unwrap_or_default());
            let last = pieces.peek().is_none();
            let part = Order::Part(Part { bytes: piece.unwrap_or_default(), last });
            protocol::encode(&part, &mut frame).map_err(|error| unexpected(&error))?;
            let answer = self.exchange(frame)?;
            if last || answer != Answer::Ready {
                return Ok(answer);
            }
        }
    }

    /// Sends a frame; returns a rejection as error.
    fn exchange(&mut self, mut frame: Frame) -> Result<Answer, ControllerError> {
        self.connection.exchange(&mut frame).map_err(ControllerError::Link)?;
        match protocol::decode(&frame).map_err(|error| unexpected(&error))? {
            Answer::Rejected(Rejection::Path(error)) => Err(MachineError::Path(error).into()),
            Answer::Rejected(rejection) => Err(unexpected(&rejection)),
            answer => Ok(answer),
        }
    }

    /// Sends an order whose only answer is [`Answer::Ready`].
    fn command(&mut self, order: &Order) -> Result<(), ControllerError> {
        match self.request(order)? {
            Answer::Ready => Ok(()),
            other => Err(unexpected(&other)),
        }
    }
}

impl<C: Connection> Controller for Remote<C> {
    fn push(&mut self, block: &PathBlock) -> Result<(), ControllerError> {
        let block = match (&block.shape, self.axes) {
            (PathShape::Line { to_m }, 1) if to_m.len() == 1 => {
                PathBlock { shape: PathShape::Line { to_m: vec![to_m[0], 0.0] }, ..block.clone() }
            }
            // The other end has a second axis and would accept the arc, but a machine of one axis must refuse it.
            (PathShape::Arc { .. } | PathShape::ArcTo { .. }, 1) => {
                return Err(ControllerError::Refused(MachineError::Path(PathError::BadPlane)));
            }
            (PathShape::Line { to_m }, axes) if to_m.len() != axes => {
                return Err(ControllerError::Axes(axes));
            }
            _ => block.clone(),
        };
        let block = block.for_axes::<AXES>().ok_or(ControllerError::Axes(self.axes))?;
        self.command(&Order::Block(block))
    }

    fn compensate(&mut self, axis: usize, settings: &CompensationSettings) -> Result<(), ControllerError> {
        if axis >= self.axes {
            return Err(MachineError::NoSuchAxis.into());
        }
        // The answer of the other end does not name the setting. It has two axes, also for a machine of one.
        let place = AxisOf { axis, axes: self.axes };
        let checked = match self.format {
            Format::Fixed => AxisCompensation::<Fixed>::new(settings, self.rates, place).err(),
            Format::F32 => AxisCompensation::<f32>::new(settings, self.rates, place).err(),
            Format::F64 => AxisCompensation::<f64>::new(settings, self.rates, place).err(),
        };
        if let Some(error) = checked {
            return Err(MachineError::Config { axis, error }.into());
        }
        let number = u8::try_from(axis).map_err(|_| MachineError::NoSuchAxis)?;
        self.command(&Order::Compensate(number, settings.clone()))
    }

    fn enable(&mut self) -> Result<(), ControllerError> {
        self.command(&Order::Enable)
    }

    fn tick(&mut self, readings: &[Reading], outputs: &mut [AxisOutput]) -> Result<Status, ControllerError> {
        if readings.len() != self.axes {
            return Err(ControllerError::Axes(readings.len()));
        }
        let at_rest = Reading { motor: Position(0), table: Some(Position(0)) };
        let ticked = match self.request(&Order::Tick(padded(readings, at_rest)))? {
            Answer::Tick(ticked) => ticked,
            other => return Err(unexpected(&other)),
        };
        let TickResult { force_bits, commands, power, warning, done, cost } = ticked;
        for ((out, bits), command) in outputs.iter_mut().zip(force_bits).zip(commands) {
            *out = AxisOutput { force_n: force_n(self.format, bits), force_bits: bits, command };
        }
        Ok(Status { power, warning, done, cost: Some(cost) })
    }
}

/// The elements of a slice, followed by `padding`.
fn padded<T: Copy>(elements: &[T], padding: T) -> [T; AXES] {
    core::array::from_fn(|axis| elements.get(axis).copied().unwrap_or(padding))
}

/// The force (N) from its bits in a number format.
#[expect(clippy::cast_possible_truncation, reason = "the narrow formats fill the low bits")]
fn force_n(format: Format, bits: u64) -> f64 {
    match format {
        Format::Fixed => Scalar::value(Fixed::from_bits((bits as u32).cast_signed())),
        Format::F32 => Scalar::value(f32::from_bits(bits as u32)),
        Format::F64 => f64::from_bits(bits),
    }
}

/// The error for an answer that a controller of this version does not send over an intact connection.
fn unexpected(what: &impl core::fmt::Debug) -> ControllerError {
    ControllerError::Link(format!(
        "unexpected answer {what:?}; check that the program has the version of this host"
    ))
}

#[cfg(test)]
mod tests;
