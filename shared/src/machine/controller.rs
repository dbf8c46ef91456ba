//! The controller of a machine.

use super::config::MachineConfig;
use super::error::MachineError;
use super::output::Output;
use super::state::State;
use crate::compensate::{AxisCompensation, CompensationKind, CompensationSettings};
use crate::config::{AxisConfig, AxisSettings, ConfigError, Rates};
use crate::feedback::Reading;
use crate::interpolate::feed_hold::FeedState;
use crate::interpolate::{Block, Path, PathError};
use crate::safety::{Event, Fault, Power};
use crate::scalar::Scalar;
use crate::units::Position;

/// The controller of N axes on one path.
///
/// It is large (tables, blocks, filter windows). On a chip it is a static that is initialised at compile time
/// ([`Machine::UNCONFIGURED`]) and configured in place ([`Machine::configure`]), so that it never has to be on a stack.
#[derive(Clone, Debug)]
pub struct Machine<S: Scalar, const N: usize> {
    /// `None`: not configured; the drives stay off.
    config: Option<MachineConfig<S, N>>,
    state: State<S, N>,
}

impl<S: Scalar, const N: usize> Machine<S, N> {
    /// A machine without settings: it rejects blocks and stays off.
    pub const UNCONFIGURED: Self = Self { config: None, state: State::NEW };

    /// A machine at rest at `start`, drives off.
    ///
    /// # Errors
    /// [`MachineError`] for the axis and the setting that is rejected.
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

    /// Reconfigures the machine in place, at rest at `start`, drives off. Not part of a tick.
    pub fn configure(&mut self, config: MachineConfig<S, N>, start: &[Position; N]) {
        self.state.reset(&config, start);
        self.config = Some(config);
    }

    /// Changes the loops of an axis, also during motion, without a jump of velocity command or force. Not part of a tick.
    ///
    /// # Errors
    /// [`MachineError::Config`] if a setting is rejected, if the axis filter ([`AxisSettings::smoothing`]) differs, or if the
    /// [sensors](AxisSettings::sensors) differ while the drives are on (the axis would jump to their reading);
    /// [`MachineError::NoSuchAxis`]. Nothing is changed then.
    pub fn change(&mut self, axis: usize, settings: &AxisSettings) -> Result<(), MachineError> {
        let rejected = |error| MachineError::Config { axis, error };
        let config = self.config.as_mut().ok_or(MachineError::NoSuchAxis)?;
        let (Some(loops), Some(state), Some(smoothing), Some(sensors)) = (
            config.axes.get_mut(axis),
            self.state.axes.get_mut(axis),
            config.smoothing.get(axis),
            config.sensors.get_mut(axis),
        ) else {
            return Err(MachineError::NoSuchAxis);
        };
        let changed = AxisConfig::new(settings, config.rates).map_err(rejected)?;
        if settings.smoothing != *smoothing {
            return Err(rejected(ConfigError::NotWhileRunning("smoothing")));
        }
        if settings.sensors != *sensors && self.state.power.is_on() {
            return Err(rejected(ConfigError::NotWhileRunning("sensors")));
        }
        state.change(loops, &changed);
        (*loops, *sensors) = (changed, settings.sensors);
        self.state.path.set_travel(config.travel());
        Ok(())
    }

    /// Replaces the compensation of an axis. Not part of a tick. Corrections change over at their limited rates.
    ///
    /// # Errors
    /// [`MachineError::Config`] if a setting is rejected, [`MachineError::NoSuchAxis`]. Nothing is changed then.
    // Tables are large: inlined into the caller, those of every number format would be on its stack at once.
    #[inline(never)]
    pub fn compensate(&mut self, axis: usize, settings: &CompensationSettings) -> Result<(), MachineError> {
        let config = self.config.as_ref().filter(|_| axis < N).ok_or(MachineError::NoSuchAxis)?;
        let compensation = AxisCompensation::new(settings, config.rates, N)
            .map_err(|error| MachineError::Config { axis, error })?;
        self.state.compensation.replace(axis, compensation);
        Ok(())
    }

    /// Replaces the compensation of an axis by one that was converted before, in the time of a copy: the conversion of tables
    /// takes longer than a tick.
    ///
    /// # Errors
    /// [`MachineError::NoSuchAxis`].
    pub fn set_compensation(
        &mut self,
        axis: usize,
        compensation: AxisCompensation<S>,
    ) -> Result<(), MachineError> {
        if axis >= N || self.config.is_none() {
            return Err(MachineError::NoSuchAxis);
        }
        self.state.compensation.replace(axis, compensation);
        Ok(())
    }

    /// Switches one compensation of an axis on or off.
    ///
    /// # Errors
    /// [`MachineError::NoSuchAxis`].
    pub fn switch(&mut self, axis: usize, kind: CompensationKind, on: bool) -> Result<(), MachineError> {
        if axis >= N || self.config.is_none() {
            return Err(MachineError::NoSuchAxis);
        }
        self.state.compensation.switch(axis, kind, on);
        Ok(())
    }

    /// Plans a block and appends it to the queue. Not part of a tick.
    ///
    /// # Errors
    /// [`PathError`]; nothing is changed then.
    pub fn push(&mut self, block: &Block<N>) -> Result<(), PathError> {
        self.accepts_blocks()?;
        self.state.path.push(block)
    }

    /// Copies the queue of blocks: [`Path::push`] on the copy and [`Machine::adopt_queue`] append a block without planning it
    /// within the time of a tick.
    ///
    /// # Errors
    /// [`PathError`] if the machine accepts no blocks.
    pub fn copy_queue(&self, copy: &mut Path<N>) -> Result<(), PathError> {
        self.accepts_blocks()?;
        copy.copy_queue(&self.state.path);
        Ok(())
    }

    /// Adopts a copy of the queue with one more block. False, with nothing changed, if the queue has changed since.
    ///
    /// # Errors
    /// [`PathError`] if the machine accepts no blocks.
    pub fn adopt_queue(&mut self, planned: &Path<N>) -> Result<bool, PathError> {
        self.accepts_blocks()?;
        Ok(self.state.path.adopt_queue(planned))
    }

    /// Whether a block could be appended now.
    fn accepts_blocks(&self) -> Result<(), PathError> {
        if self.config.is_none() {
            return Err(PathError::NotConfigured);
        }
        let stopping = matches!(self.state.power, Power::Stopping(_));
        if stopping || self.state.was_on && !self.state.power.is_on() {
            return Err(PathError::Interrupted);
        }
        Ok(())
    }

    /// Whether every block has ended and the command is at rest.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.state.path.is_done()
    }

    /// Feed hold: decelerates along the path with the declared deceleration of a stop. The drives remain on.
    pub fn hold(&mut self) {
        if let Some(config) = &self.config {
            self.state.path.hold(config.stop_deceleration());
        }
    }

    /// Continues after [`Machine::hold`].
    pub fn resume(&mut self) {
        if let Some(config) = &self.config {
            self.state.path.resume(config.stop_deceleration());
        }
    }

    /// Decelerates as [`Machine::hold`], then discards the rest of the path. The drives remain on.
    pub fn discard_path(&mut self) {
        if let Some(config) = &self.config {
            self.state.path.discard(config.stop_deceleration());
        }
    }

    /// What the feed hold does.
    #[must_use]
    pub const fn feed_state(&self) -> FeedState {
        self.state.path.feed_state()
    }

    /// Whether the last tick ran the position loops.
    #[must_use]
    pub fn was_position_tick(&self) -> bool {
        self.config.as_ref().is_some_and(|config| self.state.is_after_position_tick(config))
    }

    /// Ticks per position tick; 0 without a configuration.
    #[must_use]
    pub fn position_loop_divider(&self) -> u32 {
        self.config.as_ref().map_or(0, |config| config.rates.position_loop_divider)
    }

    /// The first warning since the drives were enabled.
    #[must_use]
    pub const fn warning(&self) -> Option<Fault> {
        self.state.warning
    }

    /// Whether the queue has room for another block.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.state.path.has_room()
    }

    /// Requests that the drives are enabled in the next tick. No effect until a fault is acknowledged, and on a machine that
    /// is not configured.
    pub fn enable(&mut self) {
        self.state.enable_requested = true;
    }

    /// Disables the drives, or acknowledges a fault. The path is discarded.
    pub fn disable(&mut self) {
        self.state.enable_requested = false;
        self.state.warning = None;
        self.state.power = self.state.power.after(Event::Disable);
    }

    /// Reports, after the configuration, a fault that ended the previous run. It has to be acknowledged before an enable.
    pub fn inhibit_enable(&mut self, fault: Fault) {
        self.state.power = self.state.power.after(Event::Inhibit(fault));
    }

    /// Reports an external fault, such as an overrun.
    pub fn fault(&mut self, fault: Fault) {
        if let Some(config) = &self.config {
            self.state.fault(config, fault);
        }
    }

    /// Power state of the drives.
    #[must_use]
    pub const fn power(&self) -> Power {
        self.state.power
    }

    /// The present command, without corrections.
    #[must_use]
    pub const fn command(&self) -> [Position; N] {
        self.state.path.command()
    }

    /// One tick: the velocity loops, and path and position loops when they are due.
    ///
    /// While the drives are off and no path is waiting, the command follows the axes, so that they do not jump when they are
    /// enabled. A path is discarded if the drives are switched off while it runs, and if the axes are away from its start
    /// when they are enabled ([`FaultKind::Displaced`](crate::safety::FaultKind::Displaced)).
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
    fn a_following_error_needs_an_acknowledgement_and_a_new_enable() {
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
        // The command is the position of the axis, so the axis does not jump back.
        assert!(output.enabled && output.forces[0].value().abs() < 1e-3);
    }

    #[test]
    fn a_rejected_block_changes_nothing() {
        let mut machine = machine();
        assert_eq!(machine.push(&Block::line([0.0], 0.1, 1.0)), Err(PathError::ZeroLength));
        machine.enable();
        assert!(machine.tick(&at(0.0)).done);
    }
}
