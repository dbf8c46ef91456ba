//! A controller at the other end of a connection that answers each frame with one frame.

use shared::axis::Reading;
use shared::compensate::{AxisCompensation, CompensationSettings};
use shared::config::{AxisSettings, Rates};
use shared::interpolate::PathError;
use shared::machine::MachineError;
use shared::protocol::{
    self, AXES, Answer, FRAME, LONGEST_ORDER, Order, PART, Part, Refusal, SOURCES, Setup, TickResult,
};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

use crate::controller::{
    AxisOutput, Controller, ControllerError, Format, PathBlock, PathShape, Status, in_process,
};

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
        let setup = Setup {
            format: match format {
                Format::Fixed => protocol::Format::Fixed,
                Format::F32 => protocol::Format::F32,
                Format::F64 => protocol::Format::F64,
            },
            rates,
            axes: padded(settings, settings[0]),
            start: padded(start, Position(0)),
        };
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

    /// Sends a frame; returns a refusal as error.
    fn exchange(&mut self, mut frame: Frame) -> Result<Answer, ControllerError> {
        self.connection.exchange(&mut frame).map_err(ControllerError::Link)?;
        match protocol::decode(&frame).map_err(|error| unexpected(&error))? {
            Answer::Refused(Refusal::Path(error)) => Err(MachineError::Path(error).into()),
            Answer::Refused(refusal) => Err(unexpected(&refusal)),
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
        let checked = match self.format {
            Format::Fixed => AxisCompensation::<Fixed>::new(settings, self.rates, self.axes).err(),
            Format::F32 => AxisCompensation::<f32>::new(settings, self.rates, self.axes).err(),
            Format::F64 => AxisCompensation::<f64>::new(settings, self.rates, self.axes).err(),
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
mod tests {
    use shared::session::{NoMeter, Session};

    use super::*;

    /// A direct connection to the session of the chip's program.
    #[derive(Default)]
    struct Direct {
        session: Session,
        /// Whether answers are overwritten.
        is_damaged: bool,
    }

    impl Connection for Direct {
        fn exchange(&mut self, frame: &mut Frame) -> Result<(), String> {
            let answer = self.session.answer(frame, &mut NoMeter).ok_or("ended")?;
            protocol::encode(&answer, frame).map_err(|error| error.to_string())?;
            if self.is_damaged {
                frame.fill(0xff);
            }
            Ok(())
        }
    }

    const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };
    const FORMATS: [Format; 3] = [Format::Fixed, Format::F32, Format::F64];

    fn line(to_m: &[f64]) -> PathBlock {
        PathBlock::new(PathShape::Line { to_m: to_m.to_vec() }, 0.1, 2.0)
    }

    fn arc(plane: [u8; 2]) -> PathBlock {
        let shape = PathShape::Arc { plane, centre_m: [0.02, 0.0], turns: 0.3 };
        PathBlock { shape, ..line(&[]) }
    }

    /// Runs both controllers with the command of the previous tick plus a drift as readings, and compares their outputs.
    fn assert_same(
        mut local: Box<dyn Controller>,
        mut remote: Remote<Direct>,
        blocks: &[PathBlock],
        axes: usize,
    ) {
        for controller in [local.as_mut(), &mut remote as &mut dyn Controller] {
            for block in blocks {
                controller.push(block).unwrap();
            }
            controller.enable().unwrap();
        }
        let mut outputs = vec![AxisOutput::default(); axes];
        let mut others = outputs.clone();
        for k in 0..5000 {
            let reading = |out: &AxisOutput| Reading {
                motor: out.command + 1000 * k,
                table: Some(out.command + 500 * k),
            };
            let readings: Vec<_> = outputs.iter().map(reading).collect();
            let status = local.tick(&readings, &mut outputs).unwrap();
            let other = remote.tick(&readings, &mut others).unwrap();
            assert_eq!((&outputs, status.power, status.done), (&others, other.power, other.done), "tick {k}");
        }
    }

    #[test]
    fn one_axis_gives_the_same_bits_as_in_this_process() {
        let sensors = shared::config::Sensors::Dual { time_constant_s: 0.01 };
        let settings = [AxisSettings { sensors, ..AxisSettings::default() }];
        // This position has no exact value in f64 metres.
        let start = [Position((1 << 56) + 12_345_677)];
        for format in FORMATS {
            let local = in_process(format, RATES, &settings, &start).unwrap();
            let remote = Remote::set_up(Direct::default(), format, RATES, &settings, &start).unwrap();
            assert_same(local, remote, &[line(&[68.73]), line(&[68.71])], 1);
        }
    }

    #[test]
    fn two_axes_give_the_same_bits_as_in_this_process() {
        let settings = [
            AxisSettings::default(),
            AxisSettings { law: shared::config::Law::Hpc, ..AxisSettings::default() },
        ];
        let start = [Position(0), Position(0)];
        for format in FORMATS {
            let local = in_process(format, RATES, &settings, &start).unwrap();
            let remote = Remote::set_up(Direct::default(), format, RATES, &settings, &start).unwrap();
            assert_same(local, remote, &[arc([0, 1]), line(&[0.0, 0.0])], 2);
        }
    }

    #[test]
    fn settings_are_refused_with_the_same_message_as_in_this_process() {
        let here = |settings: &[AxisSettings], start: &[Position]| {
            in_process(Format::Fixed, RATES, settings, start).err().map(|error| error.to_string())
        };
        let there = |settings: &[AxisSettings], start: &[Position]| {
            Remote::set_up(Direct::default(), Format::Fixed, RATES, settings, start)
                .err()
                .map(|error| error.to_string())
        };
        let good = AxisSettings::default();
        let bad = AxisSettings { position_gain_per_s: -1.0, ..good };
        for settings in [&[good, bad][..], &[bad], &[], &[good; 4]] {
            let start = vec![Position(0); settings.len()];
            assert!(here(settings, &start).is_some());
            assert_eq!(there(settings, &start), here(settings, &start));
        }
        assert_eq!(
            there(&[good; 3], &[Position(0); 3]).unwrap(),
            "port: expected a machine of 1 to 2 axes, found 3"
        );
    }

    #[test]
    fn blocks_are_refused_with_the_same_message_as_in_this_process() {
        let far = PathBlock {
            shape: PathShape::Arc { plane: [0, 0], centre_m: [1e9, 0.0], turns: 1.0 },
            ..line(&[])
        };
        let to = PathBlock {
            shape: PathShape::ArcTo {
                plane: [0, 1],
                centre_m: [0.01, 0.0],
                to_m: [0.5, 0.0],
                positive: true,
            },
            ..line(&[])
        };
        let blocks =
            [line(&[0.0]), line(&[0.0, 0.0]), line(&[f64::NAN, 1.0]), arc([0, 1]), arc([0, 2]), far, to];
        for axes in [1, 2] {
            let settings = vec![AxisSettings::default(); axes];
            let start = vec![Position(0); axes];
            for block in &blocks {
                let mut local = in_process(Format::Fixed, RATES, &settings, &start).unwrap();
                let mut remote =
                    Remote::set_up(Direct::default(), Format::Fixed, RATES, &settings, &start).unwrap();
                let words = |pushed: Result<(), ControllerError>| pushed.map_err(|error| error.to_string());
                assert_eq!(words(remote.push(block)), words(local.push(block)), "{axes} axes, {block:?}");
            }
        }
    }

    /// With a compensation on each axis, set before the motion: the same bits as in this process, and other bits than
    /// without it.
    #[test]
    fn a_compensation_gives_the_same_bits_as_in_this_process() {
        let settings = [AxisSettings::default(); 2];
        let start = [Position(0), Position(0)];
        let compensation = CompensationSettings {
            backlash_width_m: Some(5e-6),
            squareness: Some((1, 3e-5)),
            ..CompensationSettings::default()
        };
        for format in FORMATS {
            let mut local = in_process(format, RATES, &settings, &start).unwrap();
            let mut remote = Remote::set_up(Direct::default(), format, RATES, &settings, &start).unwrap();
            local.compensate(0, &compensation).unwrap();
            remote.compensate(0, &compensation).unwrap();
            assert_same(local, remote, &[arc([0, 1]), line(&[0.0, 0.0])], 2);
        }
    }

    #[test]
    fn compensations_are_refused_with_the_same_message_as_in_this_process() {
        let none = CompensationSettings::default();
        let wide = CompensationSettings { backlash_width_m: Some(1.0), ..none.clone() };
        let other_axis = CompensationSettings { squareness: Some((1, 3e-5)), ..none.clone() };
        for axes in [1, 2] {
            let settings = vec![AxisSettings::default(); axes];
            let start = vec![Position(0); axes];
            for (axis, compensation) in [(0, &none), (0, &wide), (0, &other_axis), (1, &none), (2, &none)] {
                let mut local = in_process(Format::Fixed, RATES, &settings, &start).unwrap();
                let mut remote =
                    Remote::set_up(Direct::default(), Format::Fixed, RATES, &settings, &start).unwrap();
                let words = |set: Result<(), ControllerError>| set.map_err(|error| error.to_string());
                let here = words(local.compensate(axis, compensation));
                assert_eq!(words(remote.compensate(axis, compensation)), here);
                let is_refused = std::ptr::eq(compensation, &raw const wide)
                    || axis >= axes
                    || axes == 1 && compensation.squareness.is_some();
                assert_eq!(here.is_err(), is_refused, "{axes} axes, axis {axis}: {here:?}");
            }
        }
    }

    #[test]
    fn a_damaged_answer_is_an_error_of_the_link() {
        let connection = Direct { is_damaged: true, ..Direct::default() };
        let error =
            Remote::set_up(connection, Format::Fixed, RATES, &[AxisSettings::default()], &[Position(0)])
                .err();
        let Some(ControllerError::Link(message)) = error else { panic!("{error:?}") };
        assert!(message.contains("unexpected answer") && !message.contains('\n'), "{message}");
    }

    /// Answers every frame by the same answer.
    struct Other(Answer);

    impl Connection for Other {
        fn exchange(&mut self, frame: &mut Frame) -> Result<(), String> {
            protocol::encode(&self.0, frame).map_err(|error| error.to_string())
        }
    }

    #[test]
    fn a_program_of_another_version_is_refused() {
        assert!(identify(&mut Direct::default()).is_ok());
        // A version that does not know the order answers that it cannot read it.
        for answer in [Answer::Sources(SOURCES ^ 1), Answer::Refused(Refusal::Unreadable), Answer::Ready] {
            let message = identify(&mut Other(answer)).unwrap_err().to_string();
            assert!(message.contains("build it with `cargo emulated`"), "{message}");
        }
    }
}
