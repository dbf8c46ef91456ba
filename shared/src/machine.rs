//! N axes along one path: what a board runs every tick.

use crate::axis::AxisState;
pub use crate::axis::Reading;
use crate::config::{AxisConfig, AxisSettings, ConfigError, Rates};
use crate::feedback::dual::Feedback;
use crate::interpolate::{Block, Path, PathError};
use crate::safety::{Event, Fault, Power};
use crate::scalar::Scalar;
use crate::units::Position;

/// What a tick gives to the drives and to whoever watches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output<S, const N: usize> {
    /// Force for each axis until the next tick; zero while the drives are off.
    pub forces: [S; N],
    /// The command that the position loops follow.
    pub commands: [Position; N],
    /// Whether the drives may be on.
    pub enabled: bool,
    /// Whether every block has been travelled.
    pub done: bool,
}

/// Why a machine could not be made or a block not taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MachineError {
    /// A setting of an axis (counted from 0).
    Config {
        /// Axis.
        axis: usize,
        /// What is wrong.
        error: ConfigError,
    },
    /// A block.
    Path(PathError),
}

impl From<PathError> for MachineError {
    fn from(error: PathError) -> Self {
        Self::Path(error)
    }
}

impl core::fmt::Display for MachineError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Config { axis, error } => write!(f, "axis {axis}: {error}"),
            Self::Path(error) => write!(f, "{error}"),
        }
    }
}

impl core::error::Error for MachineError {}

/// The controller of a machine.
#[derive(Clone, Debug)]
pub struct Machine<S: Scalar, const N: usize> {
    axes: [AxisConfig<S>; N],
    states: [AxisState<S>; N],
    path: Path<N>,
    divider: u32,
    until_position_tick: u32,
    power: Power,
    enable_requested: bool,
    /// Whether the drives were on in the tick before.
    was_on: bool,
    /// Whether they have been on at all: until then the path keeps the start that it was given.
    has_been_on: bool,
}

impl<S: Scalar, const N: usize> Machine<S, N> {
    /// A machine that stands at `start`, drives off.
    ///
    /// # Errors
    /// [`MachineError::Config`] with the axis and the setting that was refused.
    pub fn new(
        rates: Rates,
        settings: &[AxisSettings; N],
        start: [Position; N],
    ) -> Result<Self, MachineError> {
        let configured = |axis: usize, settings: &AxisSettings| {
            AxisConfig::new(settings, rates).map_err(|error| MachineError::Config { axis, error })
        };
        let mut axes = heapless::Vec::<_, N>::new();
        for (axis, settings) in settings.iter().enumerate() {
            // The vector holds N, as many as there are settings.
            let _ = axes.push(configured(axis, settings)?);
        }
        let rest = |place| AxisState::at_rest(place, Reading { motor: place, table: None });
        Ok(Self {
            axes: core::array::from_fn(|i| axes[i]),
            states: start.map(rest),
            path: Path::new(start, rates.position_loop_hz()),
            divider: rates.position_loop_divider,
            until_position_tick: 0,
            power: Power::Off,
            enable_requested: false,
            was_on: false,
            has_been_on: false,
        })
    }

    /// Plans a block behind those that wait. Not part of a tick.
    ///
    /// # Errors
    /// The [`PathError`] that says what is wrong; nothing has changed.
    pub fn push(&mut self, block: &Block<N>) -> Result<(), PathError> {
        self.path.push(block)
    }

    /// Whether another block would find a place.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.path.has_room()
    }

    /// Asks for the drives to come on with the next tick. Without effect while a fault stands.
    pub fn enable(&mut self) {
        self.enable_requested = true;
    }

    /// Switches the drives off, or acknowledges a fault. The path is forgotten.
    pub fn disable(&mut self) {
        self.enable_requested = false;
        self.power = self.power.after(Event::Disable);
    }

    /// Reports a fault from outside, such as an overrun.
    pub fn fault(&mut self, fault: Fault) {
        self.power = self.power.after(Event::Fault(fault));
    }

    /// State of the drives.
    #[must_use]
    pub const fn power(&self) -> Power {
        self.power
    }

    /// One tick of the velocity loops, and of path and position loops where they are due.
    ///
    /// A path that the drives going off has broken off is forgotten. From then on, with nothing left to
    /// travel, the command goes where the axes are moved, so that they do not jump when enabled again.
    pub fn tick(&mut self, readings: &[Reading; N]) -> Output<S, N> {
        if self.power != Power::On && self.has_been_on && (self.was_on || self.path.is_done()) {
            self.stand(readings);
        }
        if core::mem::take(&mut self.enable_requested) && self.power == Power::Off {
            self.switch_on(readings);
        }
        if self.power == Power::On && self.until_position_tick == 0 {
            self.until_position_tick = self.divider;
            self.position_tick(readings);
        }
        self.until_position_tick = self.until_position_tick.saturating_sub(1);

        let mut forces = [S::default(); N];
        if self.power == Power::On {
            for (((force, state), axis), reading) in
                forces.iter_mut().zip(&mut self.states).zip(&self.axes).zip(readings)
            {
                *force = state.velocity_tick(axis, *reading);
            }
        }
        self.was_on = self.power == Power::On;
        self.has_been_on |= self.was_on;
        Output {
            forces,
            commands: self.path.command(),
            enabled: self.power == Power::On,
            done: self.path.is_done(),
        }
    }

    /// Closes the loops on the command that stands, with nothing integrated.
    fn switch_on(&mut self, readings: &[Reading; N]) {
        for ((state, command), reading) in self.states.iter_mut().zip(self.path.command()).zip(readings) {
            *state = AxisState::at_rest(command, *reading);
        }
        self.until_position_tick = 0;
        self.power = self.power.after(Event::Enable);
    }

    /// The next command, the position loops, and the check of each axis.
    fn position_tick(&mut self, readings: &[Reading; N]) {
        let commands = self.path.advance();
        let mut found = None;
        for (i, (((state, axis), command), reading)) in
            self.states.iter_mut().zip(&self.axes).zip(commands).zip(readings).enumerate()
        {
            let following_error = state.position_tick(axis, command, *reading);
            #[expect(clippy::cast_possible_truncation, reason = "no machine has 256 axes")]
            let number = i as u8;
            if following_error.unsigned_abs() > axis.following_error_limit {
                found = Some(Fault::FollowingError { axis: number });
            }
            if matches!(axis.feedback, Feedback::Table { .. }) && reading.table.is_none() {
                found = Some(Fault::ScaleLost { axis: number });
            }
        }
        if let Some(fault) = found {
            self.power = self.power.after(Event::Fault(fault));
            self.stand(readings);
        }
    }

    /// Forgets the path and makes the command what the position loops read: no error, no jump.
    fn stand(&mut self, readings: &[Reading; N]) {
        let mut place = self.path.command();
        for ((place, axis), reading) in place.iter_mut().zip(&self.axes).zip(readings) {
            *place = axis.feedback.settled(reading.motor, reading.table);
        }
        self.path.stand_at(place);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Fixed;

    fn machine() -> Machine<Fixed, 1> {
        let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };
        Machine::new(rates, &[AxisSettings::default()], [Position(0)]).unwrap()
    }

    fn at(m: f64) -> [Reading; 1] {
        [Reading { motor: Position::from_m(m).unwrap(), table: None }]
    }

    #[test]
    fn nothing_moves_before_enable() {
        let mut machine = machine();
        machine.push(&Block::line([0.1], 0.1, 1.0)).unwrap();
        for _ in 0..100 {
            let output = machine.tick(&at(0.0));
            assert!(!output.enabled && output.forces == [Fixed::ZERO] && output.commands == [Position(0)]);
        }
    }

    #[test]
    fn a_following_error_switches_off_until_acknowledged_and_enabled_afresh() {
        let mut machine = machine();
        machine.enable();
        assert!(machine.tick(&at(0.0)).enabled);
        for _ in 0..5 {
            machine.tick(&at(0.051));
        }
        assert_eq!(machine.power(), Power::Faulted(Fault::FollowingError { axis: 0 }));
        machine.enable();
        assert!(!machine.tick(&at(0.051)).enabled);
        machine.disable();
        assert!(!machine.tick(&at(0.051)).enabled);
        machine.enable();
        let output = machine.tick(&at(0.051));
        // The path stands where the axis was: no jump back.
        assert!(output.enabled && output.forces[0].to_num::<f64>().abs() < 1e-3);
    }

    #[test]
    fn a_refused_block_changes_nothing() {
        let mut machine = machine();
        assert_eq!(machine.push(&Block::line([0.0], 0.1, 1.0)), Err(PathError::ZeroLength));
        machine.enable();
        assert!(machine.tick(&at(0.0)).done);
    }
}
