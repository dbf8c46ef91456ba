//! The controller of a machine.

use super::config::MachineConfig;
use super::error::MachineError;
use super::output::Output;
use super::state::State;
use crate::axis::Reading;
use crate::compensate::{AxisCompensation, CompensationSettings, Item};
use crate::config::{AxisConfig, AxisSettings, ConfigError, Rates};
use crate::interpolate::{Block, PathError};
use crate::safety::{Event, Fault, Power};
use crate::scalar::Scalar;
use crate::units::Position;

/// The controller of a machine: its configuration, and what it remembers from tick to tick.
///
/// The state is large (tables, blocks, windows of filters). On a chip it lives in a static that is made at compile
/// time ([`Machine::UNCONFIGURED`]) and is filled in place ([`Machine::configure`]), so that no stack has to hold it.
#[derive(Clone, Debug)]
pub struct Machine<S: Scalar, const N: usize> {
    /// `None`: not configured, the drives stay off.
    config: Option<MachineConfig<S, N>>,
    state: State<S, N>,
}

impl<S: Scalar, const N: usize> Machine<S, N> {
    /// A machine without settings: it takes no block and no enable.
    pub const UNCONFIGURED: Self = Self { config: None, state: State::NEW };

    /// A machine that stands at `start`, drives off.
    ///
    /// # Errors
    /// [`MachineError`] with the axis and the setting that was refused.
    pub fn new(
        rates: Rates,
        settings: &[AxisSettings; N],
        start: [Position; N],
    ) -> Result<Self, MachineError> {
        let config = MachineConfig::new(rates, settings)?;
        let mut machine = Self::UNCONFIGURED;
        machine.configure(config, &start);
        Ok(machine)
    }

    /// Makes it another machine, that stands at `start`, drives off. Not part of a tick.
    pub fn configure(&mut self, config: MachineConfig<S, N>, start: &[Position; N]) {
        self.state.reset(&config, start);
        self.config = Some(config);
    }

    /// Changes the loops of an axis, moving or not, without a jump of velocity command or force. Not part of a
    /// tick.
    ///
    /// # Errors
    /// [`MachineError::Config`] where a setting is refused, where the filter behind the path
    /// ([`AxisSettings::smoothing`]) is another, or where the drives are on and the [sensors](AxisSettings::sensors) are
    /// others, for the axis would go to where these see it; nothing has changed. [`MachineError::NoSuchAxis`].
    pub fn change(&mut self, axis: usize, settings: &AxisSettings) -> Result<(), MachineError> {
        let refused = |error| MachineError::Config { axis, error };
        let config = self.config.as_mut().ok_or(MachineError::NoSuchAxis)?;
        let (Some(loops), Some(state), Some(smoothing), Some(sensors)) = (
            config.axes.get_mut(axis),
            self.state.axes.get_mut(axis),
            config.smoothing.get(axis),
            config.sensors.get_mut(axis),
        ) else {
            return Err(MachineError::NoSuchAxis);
        };
        let changed = AxisConfig::new(settings, config.rates).map_err(refused)?;
        if settings.smoothing != *smoothing {
            return Err(refused(ConfigError::NotWhileRunning("smoothing")));
        }
        if settings.sensors != *sensors && self.state.power.is_on() {
            return Err(refused(ConfigError::NotWhileRunning("sensors")));
        }
        state.change(loops, &changed);
        (*loops, *sensors) = (changed, settings.sensors);
        self.state.path.set_travel(config.travel());
        Ok(())
    }

    /// Replaces what is compensated on an axis. Not part of a tick; corrections go over to it at their declared
    /// rates.
    ///
    /// # Errors
    /// [`MachineError::Config`] where a setting is refused, nothing has changed; [`MachineError::NoSuchAxis`].
    pub fn compensate(&mut self, axis: usize, settings: &CompensationSettings) -> Result<(), MachineError> {
        let config = self.config.as_ref().filter(|_| axis < N).ok_or(MachineError::NoSuchAxis)?;
        let made = AxisCompensation::new(settings, config.rates, N);
        self.state.compensation.replace(axis, made.map_err(|error| MachineError::Config { axis, error })?);
        Ok(())
    }

    /// Switches one compensation of an axis on or off.
    ///
    /// # Errors
    /// [`MachineError::NoSuchAxis`].
    pub fn switch(&mut self, axis: usize, item: Item, on: bool) -> Result<(), MachineError> {
        if axis >= N || self.config.is_none() {
            return Err(MachineError::NoSuchAxis);
        }
        self.state.compensation.switch(axis, item, on);
        Ok(())
    }

    /// Plans a block behind those that wait. Not part of a tick.
    ///
    /// # Errors
    /// The [`PathError`] that says what is wrong; nothing has changed.
    pub fn push(&mut self, block: &Block<N>) -> Result<(), PathError> {
        if self.config.is_none() {
            return Err(PathError::NotConfigured);
        }
        let stops = matches!(self.state.power, Power::Stopping(_));
        if stops || self.state.was_on && !self.state.power.is_on() {
            return Err(PathError::Interrupted);
        }
        self.state.path.push(block)
    }

    /// Whether another block would find a place.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.state.path.has_room()
    }

    /// Asks for the drives to come on with the next tick. Without effect while a fault stands, and on a machine that
    /// is not configured.
    pub fn enable(&mut self) {
        self.state.enable_requested = true;
    }

    /// Switches the drives off, or acknowledges a fault. The path is forgotten.
    pub fn disable(&mut self) {
        self.state.enable_requested = false;
        self.state.warning = None;
        self.state.power = self.state.power.after(Event::Disable);
    }

    /// Reports, once the machine is configured, that the run before ended by a fault: it has to be acknowledged like one
    /// of this run.
    pub fn inhibit_enable(&mut self, fault: Fault) {
        self.state.power = self.state.power.after(Event::Inhibit(fault));
    }

    /// Reports a fault from outside, such as an overrun.
    pub fn fault(&mut self, fault: Fault) {
        if let Some(config) = &self.config {
            self.state.fault(config, fault);
        }
    }

    /// State of the drives.
    #[must_use]
    pub const fn power(&self) -> Power {
        self.state.power
    }

    /// The command that the position loops follow.
    #[must_use]
    pub const fn command(&self) -> [Position; N] {
        self.state.path.command()
    }

    /// One tick of the velocity loops, and of path and position loops where they are due.
    ///
    /// While the drives are off and no path waits, the command goes where the axes are moved, so that they do not jump
    /// when they are enabled. A path that the drives going off has broken off is forgotten, and so is one that waits
    /// where the axes no longer are when they are enabled ([`FaultKind::Displaced`](crate::safety::FaultKind::Displaced)).
    pub fn tick(&mut self, readings: &[Reading; N]) -> Output<S, N> {
        match &self.config {
            Some(config) => config.tick(&mut self.state, readings),
            None => self.state.output([S::ZERO; N]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::safety::FaultKind;
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
        assert_eq!(machine.power(), Power::Faulted(Fault::Axis { axis: 0, kind: FaultKind::FollowingError }));
        machine.enable();
        assert!(!machine.tick(&at(0.051)).enabled);
        machine.disable();
        assert!(!machine.tick(&at(0.051)).enabled);
        machine.enable();
        let output = machine.tick(&at(0.051));
        // The path stands where the axis was: no jump back.
        assert!(output.enabled && output.forces[0].value().abs() < 1e-3);
    }

    #[test]
    fn a_refused_block_changes_nothing() {
        let mut machine = machine();
        assert_eq!(machine.push(&Block::line([0.0], 0.1, 1.0)), Err(PathError::ZeroLength));
        machine.enable();
        assert!(machine.tick(&at(0.0)).done);
    }
}
