//! The pipeline whose positions are f32 metres, to show their rounding error. It exists for the comparison only.
//!
//! The control laws are those of `shared` in f32, the path is a [`SinglePath`], and the readings are rounded to f32
//! before they are subtracted. The difference of two f32 of one sign and similar size is exact, so the control
//! laws may subtract them as integers.

use shared::axis::{AxisState, Reading};
use shared::compensate::{CompensationSettings, Correction};
use shared::config::{AxisConfig, AxisSettings, Rates};
use shared::interpolate::{Path, PathError};
use shared::machine::MachineError;
use shared::safety::{Event, Fault, Power};
use shared::scalar::Scalar;
use shared::units::Position;

use super::point::{AXES, Point};
use super::single_path::{SinglePath, metres, position};
use motion::PathBlock;
use plant::controller::{AxisOutput, Controller, ControllerError, Status};

/// A controller of two axes whose positions are f32 metres.
pub struct SinglePrecision {
    axes: Vec<(AxisConfig<f32>, AxisState<f32>)>,
    /// The exact path, which gives the length of each step.
    exact: Path<AXES>,
    path: SinglePath,
    command: Point,
    divider: u32,
    until_position_tick: u32,
    enable_requested: bool,
    power: Power,
}

impl SinglePrecision {
    /// A controller of a machine at rest at `start`, drives off.
    ///
    /// # Errors
    /// [`ControllerError::Refused`] as from `shared`.
    pub fn new(rates: Rates, settings: &[AxisSettings], start: Point) -> Result<Self, ControllerError> {
        let command = start.map(|exact| position(metres(exact)));
        let axis = |(axis, settings)| {
            let config = AxisConfig::new(settings, rates)
                .map_err(|error| ControllerError::Refused(MachineError::Config { axis, error }))?;
            let at = command[axis];
            Ok((config, AxisState::at_rest(at, Reading { motor: at, table: None })))
        };
        Ok(Self {
            axes: settings.iter().enumerate().map(axis).collect::<Result<_, ControllerError>>()?,
            exact: Path::new(start, rates.position_loop_hz()),
            path: SinglePath::standing(start),
            command,
            divider: rates.position_loop_divider,
            until_position_tick: 0,
            enable_requested: false,
            power: Power::Off,
        })
    }

    /// Advances the command by a step as long as that of the exact path, in the end to the programmed point.
    fn advance(&mut self) {
        let from = self.exact.command();
        let to = self.exact.advance();
        let point = self.path.advance(self.path.step_m(from, to));
        let point = if self.exact.is_done() { to.map(metres) } else { point };
        self.command = point.map(position);
    }
}

impl Controller for SinglePrecision {
    /// Accepts one block at a time.
    fn push(&mut self, block: &PathBlock) -> Result<(), ControllerError> {
        let refused = |error| ControllerError::Refused(MachineError::Path(error));
        if !self.exact.is_done() {
            return Err(refused(PathError::QueueFull));
        }
        let planned = block.for_axes::<AXES>().ok_or(ControllerError::Axes(AXES))?;
        self.exact.push(&planned).map_err(refused)?;
        self.path = SinglePath::new(block, self.exact.command());
        Ok(())
    }

    fn compensate(&mut self, _: usize, _: &CompensationSettings) -> Result<(), ControllerError> {
        Err(ControllerError::NotSupported("compensation"))
    }

    fn enable(&mut self) -> Result<(), ControllerError> {
        self.enable_requested = true;
        Ok(())
    }

    fn tick(&mut self, readings: &[Reading], outputs: &mut [AxisOutput]) -> Result<Status, ControllerError> {
        let rounded = |exact: Position| position(metres(exact));
        let readings: Vec<Reading> = readings
            .iter()
            .map(|reading| Reading { motor: rounded(reading.motor), table: reading.table.map(rounded) })
            .collect();
        if std::mem::take(&mut self.enable_requested) && self.power == Power::Off {
            for (((_, state), command), reading) in self.axes.iter_mut().zip(self.command).zip(&readings) {
                *state = AxisState::at_rest(command, *reading);
            }
            self.until_position_tick = 0;
            self.power = self.power.after(Event::Enable);
        }
        if self.power == Power::On && self.until_position_tick == 0 {
            self.until_position_tick = self.divider;
            self.advance();
            for (number, ((config, state), reading)) in (0u8..).zip(self.axes.iter_mut().zip(&readings)) {
                let command = self.command[usize::from(number)];
                for kind in state.position_tick(config, command, Correction::NONE, *reading).iter() {
                    self.power = self.power.after(Event::Fault(Fault::Axis { axis: number, kind }));
                }
            }
        }
        self.until_position_tick = self.until_position_tick.saturating_sub(1);
        for ((((config, state), reading), command), output) in
            self.axes.iter_mut().zip(&readings).zip(self.command).zip(outputs)
        {
            let force = match self.power {
                Power::On => state.velocity_tick(config, *reading, 0.0).0,
                _ => 0.0,
            };
            *output = AxisOutput { force_n: force.value(), force_bits: force.bits(), command };
        }
        Ok(Status { power: self.power, warning: None, done: self.exact.is_done(), cost: None })
    }
}

#[cfg(test)]
mod tests {
    use shared::safety::FaultKind;

    use super::*;
    use crate::compare::motion::Motion;

    /// A controller at the start of the circle, with its drives requested.
    fn controller() -> SinglePrecision {
        let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };
        let start = Motion::Circle.start();
        let mut controller = SinglePrecision::new(rates, &[AxisSettings::default(); AXES], start).unwrap();
        controller.enable().unwrap();
        controller
    }

    #[test]
    fn a_second_block_is_refused() {
        let mut controller = controller();
        let block = &Motion::Circle.blocks(1)[1];
        controller.push(block).unwrap();
        assert_eq!(controller.push(block).unwrap_err().to_string(), PathError::QueueFull.to_string());
    }

    /// The limits are those of `shared`: beyond 50 mm of following error the drives are switched off in the same tick.
    #[test]
    fn a_following_error_switches_off() {
        let mut controller = controller();
        let mut outputs = [AxisOutput::default(); AXES];
        let mut tick = |x_m: f64| {
            let reading = |m: f64| Reading { motor: Position::from_m(m).unwrap(), table: None };
            let status = controller.tick(&[reading(x_m), reading(0.0)], &mut outputs).unwrap();
            (status.power, outputs[0].force_n)
        };
        assert_eq!(tick(0.1), (Power::On, 0.0));
        assert!((0..4).all(|_| tick(0.149).0 == Power::On));
        let (power, force_n) = tick(0.149);
        // 49 mm too far: the force is negative.
        assert!(power == Power::On && force_n < -1.0, "{force_n}");
        let last = (0..5).map(|_| tick(0.151)).last().unwrap();
        assert_eq!(last, (Power::Faulted(Fault::Axis { axis: 0, kind: FaultKind::FollowingError }), 0.0));
    }
}
