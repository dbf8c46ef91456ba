//! The controller of a machine.

mod between_ticks;
mod following;
mod gantry;

use super::config::MachineConfig;
use super::error::MachineError;
use super::output::Output;
use super::reference::{Reference, References};
use super::state::State;
use crate::compensate::{AxisCompensation, AxisOf, CompensationKind, CompensationSettings, Dependence};
use crate::config::{AxisConfig, AxisSettings, ConfigError, Rates};
use crate::feedback::{OriginShift, Reading};
use crate::interpolate::{Block, PathError};
use crate::safety::{Event, Fault, Power};
use crate::scalar::Scalar;
use crate::units::Position;

/// The controller of N axes on one path.
///
/// It is large (tables, blocks, filter windows). On a chip it is a static that is initialised at compile time
/// ([`Machine::UNCONFIGURED`]) and configured in place ([`Machine::configure`]), so that it never has to be on a stack.
// In this order: see `State`.
#[repr(C)]
#[derive(Clone, Debug)]
pub struct Machine<S: Scalar, const N: usize> {
    /// `None`: not configured; the drives stay off.
    config: Option<MachineConfig<S, N>>,
    references: References<N>,
    state: State<S, N>,
    /// The force limits of the settings of the axes whose force is [limited](Machine::limit_force) further.
    full_forces: [Option<S>; N],
}

impl<S: Scalar, const N: usize> Machine<S, N> {
    /// A machine without settings: it rejects blocks and stays off.
    pub const UNCONFIGURED: Self =
        Self { config: None, state: State::NEW, references: References::NEW, full_forces: [None; N] };

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
    ///
    /// `start` is taken as absolute: every axis is homed. A board that does not know the positions of its axes calls
    /// [`Machine::lose_reference`] afterwards.
    pub fn configure(&mut self, config: MachineConfig<S, N>, start: &[Position; N]) {
        self.references = References::NEW;
        self.full_forces = [None; N];
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
        let (Some(loops), Some(state), Some(smoothing), Some(sensors), Some(reference)) = (
            config.axes.get(axis),
            self.state.axes.get_mut(axis),
            config.smoothing.get(axis),
            config.sensors.get_mut(axis),
            self.references.of(axis),
        ) else {
            return Err(MachineError::NoSuchAxis);
        };
        let gantry = settings.gantry.map(|gantry| usize::from(gantry.first));
        if gantry != config.gantries.get(axis).and_then(|gantry| gantry.map(|gantry| gantry.first)) {
            return Err(rejected(ConfigError::NotWhileRunning("gantry")));
        }
        let changed = AxisConfig::new(settings, config.rates).map_err(rejected)?;
        let schedule = AxisConfig::schedule(settings, config.rates).map_err(rejected)?;
        if settings.smoothing != *smoothing {
            return Err(rejected(ConfigError::NotWhileRunning("smoothing")));
        }
        if !settings.sensors.have_feedback_of(sensors) && self.state.power.is_on() {
            return Err(rejected(ConfigError::NotWhileRunning("sensors")));
        }
        state.change(loops, &changed);
        *sensors = settings.sensors;
        config.replace(axis, changed, reference);
        config.replace_schedule(axis, schedule);
        if let Some(full) = self.full_forces.get_mut(axis) {
            *full = None;
        }
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
        let rates = config.rates;
        AxisCompensation::convert_for(settings, rates, AxisOf { axis, axes: N }, |compensation| {
            #[expect(clippy::cast_possible_truncation, reason = "fewer axes than 256")]
            self.references.set_dependence(axis, Dependence::of(axis as u8, settings));
            self.apply_switches();
            self.state.compensation.replace(axis, compensation);
        })
        .map_err(|error| MachineError::Config { axis, error })
    }

    /// Switches one compensation of an axis on or off. One that is [held](Machine::is_held) is applied when its axis is homed.
    ///
    /// # Errors
    /// [`MachineError::NoSuchAxis`].
    pub fn switch(&mut self, axis: usize, kind: CompensationKind, on: bool) -> Result<(), MachineError> {
        if axis >= N || self.config.is_none() {
            return Err(MachineError::NoSuchAxis);
        }
        self.references.switch(axis, kind, on);
        self.apply_switches();
        Ok(())
    }

    /// Switches each compensation by the request of the user and the references of the axes.
    fn apply_switches(&mut self) {
        for axis in 0..N {
            for kind in CompensationKind::ALL {
                self.state.compensation.switch(axis, kind, self.references.is_applied(axis, kind));
            }
        }
    }

    /// Whether a compensation of an axis is held off until an axis is homed.
    #[must_use]
    pub fn is_held(&self, axis: usize, kind: CompensationKind) -> bool {
        self.references.is_held(axis, kind)
    }

    /// Whether the positions of an axis are absolute; `None`: no such axis.
    #[must_use]
    pub fn reference(&self, axis: usize) -> Option<Reference> {
        self.references.of(axis)
    }

    /// Declares the positions of an axis as relative to those at power-up, and of the other motor of its gantry. Its soft limits and what
    /// depends on its position are held off; corrections return to zero at their limited rates.
    pub fn lose_reference(&mut self, axis: usize) {
        self.set_reference(axis, Reference::Relative);
        if let Some(other) = self.other_motor(axis) {
            self.set_reference(other, Reference::Relative);
            for motor in [axis, other] {
                self.state.gantries.set_referenced(motor, false);
            }
        }
    }

    fn set_reference(&mut self, axis: usize, reference: Reference) {
        self.references.set(axis, reference);
        if let Some(config) = &mut self.config {
            config.set_reference(axis, reference);
            self.state.path.set_travel(config.travel());
        }
        self.apply_switches();
    }

    /// Sets the origin of an axis: from the next tick on, its readings are shifted by `shift`. The command is shifted with
    /// them, so that the loops continue without a step, and the axis is homed. A motor of a gantry is homed with the other one
    /// ([`Machine::square`], [`Machine::gantry_homed`]).
    ///
    /// # Errors
    /// [`MachineError::PathRunning`] unless the path is done, [`MachineError::NoSuchAxis`]. Nothing is changed then.
    pub fn set_origin(&mut self, axis: usize, shift: OriginShift) -> Result<(), MachineError> {
        let config = self.config.as_ref().filter(|_| axis < N).ok_or(MachineError::NoSuchAxis)?;
        if !self.state.is_done() {
            return Err(MachineError::PathRunning);
        }
        self.state.shift_origin(config, axis, shift);
        if self.other_motor(axis).is_none() {
            self.set_reference(axis, Reference::Homed);
        }
        Ok(())
    }

    /// Plans a block and appends it to the queue. Not part of a tick. What it says of the second motor of a gantry is not used.
    ///
    /// # Errors
    /// [`PathError`], [`PathError::NotHomed`] for an axis with soft limits that is not homed; nothing is changed then.
    pub fn push(&mut self, block: &Block<N>) -> Result<(), PathError> {
        let not_homed = self.not_homed()?;
        self.append(block, &not_homed)
    }

    /// [`Machine::push`] for a jog or a part of homing, which starts from the present position: also moves axes that are not
    /// homed.
    ///
    /// # Errors
    /// [`PathError`]; nothing is changed then.
    pub fn jog(&mut self, block: &Block<N>) -> Result<(), PathError> {
        self.append(block, &[false; N])
    }

    fn append(&mut self, block: &Block<N>, not_homed: &[bool; N]) -> Result<(), PathError> {
        self.accepts_blocks()?;
        self.state.path.push_holding(block, not_homed)
    }

    /// The axes with soft limits that are not homed.
    fn not_homed(&self) -> Result<[bool; N], PathError> {
        let config = self.config.as_ref().ok_or(PathError::NotConfigured)?;
        let mut not_homed = config.have_soft_limits();
        for (axis, not_homed) in not_homed.iter_mut().enumerate() {
            *not_homed &= self.references.of(axis) == Some(Reference::Relative);
        }
        Ok(not_homed)
    }

    /// Whether a block could be appended now.
    fn accepts_blocks(&self) -> Result<(), PathError> {
        if self.config.is_none() {
            return Err(PathError::NotConfigured);
        }
        let off = self.state.was_on && !self.state.power.is_on();
        let off = off || matches!(self.state.power, Power::Disabling(_));
        if off || self.state.path.is_braking() {
            return Err(PathError::Interrupted);
        }
        if self.state.path.follows() { Err(PathError::Following) } else { Ok(()) }
    }

    /// Decelerates along the path and discards what remains of it. The drives stay on and hold the axes. Blocks are refused
    /// until the axes have stopped.
    pub fn halt(&mut self) {
        if let Some(config) = &self.config
            && self.state.power.is_on()
        {
            self.state.path.brake(config.stop_deceleration());
        }
    }

    /// Sets which limit switches are active, at the negative and the positive end of each axis: blocks that move an axis further
    /// onto one are rejected.
    pub const fn set_limit_switches(&mut self, active: [[bool; 2]; N]) {
        self.state.path.set_blocked(active);
    }

    /// Rates of the loops; `None`: not configured.
    #[must_use]
    pub fn rates(&self) -> Option<Rates> {
        self.config.as_ref().map(|config| config.rates)
    }

    /// Force limit of an axis, N; `None`: no such axis.
    #[must_use]
    pub fn force_limit_n(&self, axis: usize) -> Option<f64> {
        self.config.as_ref()?.axes.get(axis).map(|config| config.velocity.force_limit.value())
    }

    /// Limits the force of an axis from the next tick on to less than its settings do; `None`: to what they do. A greater limit, and an axis
    /// that does not exist, change nothing. Ends with the next settings.
    pub fn limit_force(&mut self, axis: usize, limit: Option<S>) {
        let config = self.config.as_mut().and_then(|config| config.axes.get_mut(axis));
        if let (Some(config), Some(full)) = (config, self.full_forces.get_mut(axis)) {
            let settings = full.take().unwrap_or(config.velocity.force_limit);
            config.velocity.force_limit = settings;
            if let Some(limit) = limit.filter(|limit| *limit < settings) {
                (config.velocity.force_limit, *full) = (limit, Some(settings));
            }
        }
    }

    /// Whether a force is at the limit of an axis: forwards or backwards.
    #[must_use]
    pub fn is_at_force_limit(&self, axis: usize, force: S) -> [bool; 2] {
        let config = self.config.as_ref().and_then(|config| config.axes.get(axis));
        config.map_or([false; 2], |config| {
            let limit = config.velocity.force_limit;
            [force >= limit, S::ZERO - force >= limit]
        })
    }

    /// Whether the position loop of an axis uses a linear scale.
    #[must_use]
    pub fn uses_scale(&self, axis: usize) -> bool {
        let config = self.config.as_ref().and_then(|config| config.axes.get(axis));
        config.is_some_and(|config| config.feedback.uses_scale())
    }

    /// Whether every block has ended and the command is at rest.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.state.is_at_rest()
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

    /// Disables the drives at once, or acknowledges a fault. The path is discarded.
    pub fn disable(&mut self) {
        self.state.enable_requested = false;
        self.state.warning = None;
        self.state.power = self.state.power.after(Event::Disable);
    }

    /// Disables the drives in order, or acknowledges a fault. With a brake on an axis, the path decelerates, then the brakes close while
    /// the drives hold the axes. Without one it is a [disable](Machine::disable).
    pub fn disable_in_order(&mut self) {
        let braked = self.config.as_ref().filter(|config| config.brake_times().is_some());
        let Some(config) = braked.filter(|_| self.state.power.is_on()) else { return self.disable() };
        self.state.enable_requested = false;
        self.state.power = self.state.power.after(Event::DisableWithBrakes);
        if !self.state.path.is_done() {
            self.state.path.brake(config.stop_deceleration());
        }
    }

    /// Whether the brakes are to be open. They are closed while the drives are off.
    #[must_use]
    pub const fn are_brakes_open(&self) -> bool {
        self.state.power.is_on() && self.state.brakes.are_open()
    }

    /// Whether an axis has a brake.
    #[must_use]
    pub fn has_brake(&self, axis: usize) -> bool {
        let config = self.config.as_ref().and_then(|config| config.axes.get(axis));
        config.is_some_and(|config| config.brake.is_some())
    }

    /// Whether an axis carries a weight: it has a brake, or a preload that is not zero.
    #[must_use]
    pub fn carries_weight(&self, axis: usize) -> bool {
        let config = self.config.as_ref().and_then(|config| config.axes.get(axis));
        let has_preload = config.and_then(|config| config.preload).is_some_and(|force| force != S::ZERO);
        has_preload || self.has_brake(axis)
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
        self.state.commands
    }

    /// The present command with its corrections, which the position loops follow.
    #[must_use]
    pub fn corrected_command(&self) -> [Position; N] {
        self.state.corrected_commands()
    }

    /// One tick: the velocity loops, and path and position loops when they are due.
    ///
    /// While the drives are off and no path is waiting, the command follows the axes, so that they do not jump when they are
    /// enabled. A path is discarded if the drives are switched off while it runs, and if the axes are away from its start
    /// when they are enabled ([`FaultKind::Displaced`](crate::safety::FaultKind::Displaced)).
    pub fn tick(&mut self, readings: &[Reading; N]) -> Output<S, N> {
        match &mut self.config {
            Some(config) => config.tick(&mut self.state, readings),
            None => self.state.output([S::ZERO; N]),
        }
    }

    /// Computes what depends on commands only for the next position tick, after a tick and when its forces have been passed on: no tick
    /// then has all of it. A board does so in every tick.
    ///
    /// Commands, corrections and forces are the same without it, to the last bit, but what stops or changes the path within the last two
    /// ticks before a position tick acts from the next one on (within the last tick with two ticks per position tick). With one tick
    /// per position tick it does nothing.
    pub fn prepare(&mut self) {
        if let Some(config) = &self.config {
            config.prepare(&mut self.state);
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

    /// At the command the controller has no force of its own.
    #[test]
    fn an_excitation_is_added_up_to_the_force_limit_until_it_is_configured_again() {
        let mut machine = machine();
        let limit_n = machine.force_limit_n(0).unwrap();
        machine.enable();
        assert_eq!(machine.tick(&at(0.0)).forces, [Fixed::ZERO]);
        for (force_n, expected_n) in [(12.5, 12.5), (-40.0, -40.0), (1.5 * limit_n, limit_n), (0.0, 0.0)] {
            machine.set_excitation(0, Fixed::signal(force_n));
            // There is no axis 1.
            machine.set_excitation(1, Fixed::signal(77.0));
            assert_eq!(machine.tick(&at(0.0)).forces, [Fixed::signal(expected_n)]);
        }
        machine.set_excitation(0, Fixed::signal(3.0));
        let config = machine.config.clone().unwrap();
        machine.configure(config, &[Position(0)]);
        machine.enable();
        assert_eq!(machine.tick(&at(0.0)).forces, [Fixed::ZERO]);
    }

    #[test]
    fn a_rejected_block_changes_nothing() {
        let mut machine = machine();
        assert_eq!(machine.push(&Block::line([0.0], 0.1, 1.0)), Err(PathError::ZeroLength));
        machine.enable();
        assert!(machine.tick(&at(0.0)).done);
    }
}
