//! N axes along one path: what a board runs every tick.

use crate::axis::AxisState;
pub use crate::axis::Reading;
use crate::compensate::{AxisCompensation, Compensation, CompensationSettings, Item};
use crate::config::{AxisConfig, AxisSettings, ConfigError, Rates};
use crate::interpolate::{Block, Path, PathError, Smoothing};
use crate::safety::{Event, Fault, Hazard, Power, Reaction};
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
    /// The first fault that the machine has gone on with since it was enabled.
    pub warning: Option<Fault>,
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
    /// The machine has no such axis.
    NoSuchAxis,
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
            Self::NoSuchAxis => write!(f, "the machine has no such axis"),
        }
    }
}

impl core::error::Error for MachineError {}

/// The controller of a machine.
#[derive(Clone, Debug)]
pub struct Machine<S: Scalar, const N: usize> {
    axes: [AxisConfig<S>; N],
    states: [AxisState<S>; N],
    compensation: Compensation<S, N>,
    path: Path<N>,
    until_position_tick: u32,
    power: Power,
    warning: Option<Fault>,
    stop_deceleration: u64,
    rates: Rates,
    smoothing: [Smoothing; N],
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
        let mut path = Path::new(start, rates.position_loop_hz());
        path.smooth(&settings.each_ref().map(|axis| axis.smoothing))?;
        let rest = |place| AxisState::at_rest(place, Reading { motor: place, table: None });
        Ok(Self {
            axes: core::array::from_fn(|i| axes[i]),
            states: start.map(rest),
            compensation: Compensation::none(start),
            path,
            stop_deceleration: least_deceleration(&axes),
            rates,
            smoothing: settings.each_ref().map(|axis| axis.smoothing),
            until_position_tick: 0,
            power: Power::Off,
            warning: None,
            enable_requested: false,
            was_on: false,
            has_been_on: false,
        })
    }

    /// Changes the loops of an axis, moving or not, without a jump of velocity command or force. Not part of a
    /// tick.
    ///
    /// # Errors
    /// [`MachineError::Config`] where a setting is refused, or where the filter behind the path
    /// ([`AxisSettings::smoothing`]) is another; nothing has changed. [`MachineError::NoSuchAxis`].
    pub fn change(&mut self, axis: usize, settings: &AxisSettings) -> Result<(), MachineError> {
        let refused = |error| MachineError::Config { axis, error };
        let (Some(config), Some(state), Some(smoothing)) =
            (self.axes.get_mut(axis), self.states.get_mut(axis), self.smoothing.get(axis))
        else {
            return Err(MachineError::NoSuchAxis);
        };
        let changed = AxisConfig::new(settings, self.rates).map_err(refused)?;
        if settings.smoothing != *smoothing {
            return Err(refused(ConfigError::NotWhileRunning("smoothing")));
        }
        state.change(config, &changed);
        *config = changed;
        self.stop_deceleration = least_deceleration(&self.axes);
        Ok(())
    }

    /// Replaces what is compensated on an axis. Not part of a tick; corrections go over to it at their declared
    /// rates.
    ///
    /// # Errors
    /// [`MachineError::Config`] where a setting is refused, nothing has changed; [`MachineError::NoSuchAxis`].
    pub fn compensate(&mut self, axis: usize, settings: &CompensationSettings) -> Result<(), MachineError> {
        if axis >= N {
            return Err(MachineError::NoSuchAxis);
        }
        let made = AxisCompensation::new(settings, self.rates, N);
        self.compensation.replace(axis, made.map_err(|error| MachineError::Config { axis, error })?);
        Ok(())
    }

    /// Switches one compensation of an axis on or off.
    ///
    /// # Errors
    /// [`MachineError::NoSuchAxis`].
    pub fn switch(&mut self, axis: usize, item: Item, on: bool) -> Result<(), MachineError> {
        if axis >= N {
            return Err(MachineError::NoSuchAxis);
        }
        self.compensation.switch(axis, item, on);
        Ok(())
    }

    /// Plans a block behind those that wait. Not part of a tick.
    ///
    /// # Errors
    /// The [`PathError`] that says what is wrong; nothing has changed.
    pub fn push(&mut self, block: &Block<N>) -> Result<(), PathError> {
        if self.was_on && !self.power.is_on() {
            return Err(PathError::Interrupted);
        }
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
        self.warning = None;
        self.power = self.power.after(Event::Disable);
    }

    /// Reports a fault from outside, such as an overrun.
    pub fn fault(&mut self, fault: Fault) {
        if !self.power.is_on() {
            return;
        }
        match fault.reaction() {
            Reaction::DriveOff => {}
            Reaction::Stop => self.path.brake(self.stop_deceleration),
            Reaction::Warn => self.warning = self.warning.or(Some(fault)),
        }
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
        let readings = &self.compensation.readings(readings);
        if !self.power.is_on() && self.has_been_on && (self.was_on || self.path.is_done()) {
            self.stand(readings);
        }
        if core::mem::take(&mut self.enable_requested) && self.power == Power::Off {
            self.switch_on(readings);
        }
        let mut forces = [S::default(); N];
        if self.power.is_on() {
            if self.until_position_tick == 0 {
                self.until_position_tick = self.rates.position_loop_divider;
                self.position_tick(readings);
            }
            self.until_position_tick -= 1;
            forces = self.velocity_tick(readings);
            if !self.power.is_on() {
                forces = [S::default(); N];
                self.stand(readings);
            }
        }
        self.was_on = self.power.is_on();
        self.has_been_on |= self.was_on;
        Output {
            forces,
            commands: self.path.command(),
            enabled: self.was_on,
            warning: self.warning,
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

    /// The next command with what corrects it, and the position loops.
    fn position_tick(&mut self, readings: &[Reading; N]) {
        let commands = self.path.advance();
        let corrections = self.compensation.commands(&commands);
        let mut hazards = [None; N];
        for (((((hazard, state), axis), command), correction), reading) in hazards
            .iter_mut()
            .zip(&mut self.states)
            .zip(&self.axes)
            .zip(commands)
            .zip(corrections)
            .zip(readings)
        {
            *hazard = state.position_tick(axis, command, correction, *reading);
        }
        self.raise(hazards);
        if self.path.has_stopped() {
            self.power = self.power.after(Event::Stopped);
        }
    }

    /// The velocity loops, with the forces that are added.
    fn velocity_tick(&mut self, readings: &[Reading; N]) -> [S; N] {
        let added = self.compensation.forces(readings);
        let (mut forces, mut hazards) = ([S::default(); N], [None; N]);
        for (((((force, hazard), state), axis), reading), added) in
            forces.iter_mut().zip(&mut hazards).zip(&mut self.states).zip(&self.axes).zip(readings).zip(added)
        {
            (*force, *hazard) = state.velocity_tick(axis, *reading, added);
        }
        self.raise(hazards);
        forces
    }

    fn raise(&mut self, hazards: [Option<Hazard>; N]) {
        if hazards.iter().all(Option::is_none) {
            return;
        }
        for (axis, hazard) in hazards.into_iter().enumerate() {
            #[expect(clippy::cast_possible_truncation, reason = "no machine has 256 axes")]
            if let Some(hazard) = hazard {
                self.fault(Fault::Axis { axis: axis as u8, hazard });
            }
        }
    }

    /// Forgets the path and makes the command what the position loops read: no error, no jump.
    fn stand(&mut self, readings: &[Reading; N]) {
        let mut place = self.path.command();
        let standing = self.compensation.standing();
        for (((place, axis), reading), added) in place.iter_mut().zip(&self.axes).zip(readings).zip(standing)
        {
            *place = axis.feedback.settled(reading.motor, reading.table).moved(-added);
        }
        self.compensation.stand_at(&place);
        self.path.stand_at(place);
    }
}

/// A path stops with the least of its axes.
fn least_deceleration<S: Scalar>(axes: &[AxisConfig<S>]) -> u64 {
    axes.iter().map(|axis| axis.stop_deceleration).min().unwrap_or(u64::MAX)
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
        assert_eq!(machine.power(), Power::Faulted(Fault::Axis { axis: 0, hazard: Hazard::FollowingError }));
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
