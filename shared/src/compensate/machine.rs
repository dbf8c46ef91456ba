//! The compensations of all axes of a machine.

use super::axis::AxisCompensation;
use super::kind::CompensationKind;
use super::motion::CommandMotion;
use super::round_robin::{Inputs, Schedule};
use super::state::{Correction, State};
use crate::feedback::Reading;
use crate::one_after_the_other;
use crate::scalar::Scalar;
use crate::units::Position;

/// Ticks for which round-robin terms may wait: two are at the end of a segment of a speed ramp, four if a short segment follows.
pub const MAX_WAIT: u8 = 4;

/// The compensations of all axes, with their state.
// In this order: an instruction reaches the first 4 KiB.
#[repr(C)]
#[derive(Clone, Debug)]
pub struct Compensation<S: Scalar, const N: usize> {
    inputs: Inputs<S, N>,
    states: [State<S>; N],
    /// Ticks for which the round-robin terms have waited.
    waited: u8,
    /// Whether a compensation has been set, for each axis.
    is_set: [bool; N],
    schedule: Schedule<N>,
    axes: [AxisCompensation<S>; N],
}

impl<S: Scalar, const N: usize> Compensation<S, N> {
    /// No compensation, axes at zero.
    pub const NONE: Self = Self {
        axes: [const { AxisCompensation::NONE }; N],
        states: [State::NEW; N],
        inputs: Inputs { motions: [CommandMotion::at(Position(0)); N], clock: 0 },
        waited: 0,
        schedule: Schedule::EMPTY,
        is_set: [false; N],
    };

    /// No compensation, axes at `start`.
    #[must_use]
    pub fn none(start: [Position; N]) -> Self {
        Self { inputs: Inputs { motions: start.map(CommandMotion::at), clock: 0 }, ..Self::NONE }
    }

    /// Resets to no compensation, axes at `start`, in place: tables are large.
    pub fn reset(&mut self, start: &[Position; N]) {
        self.states = [State::NEW; N];
        self.inputs.motions = start.map(CommandMotion::at);
        self.is_set = [false; N];
        self.schedule = Schedule::EMPTY;
    }

    /// Replaces the compensation of an axis. Its corrections change over at their limited rates.
    // Tables are large: not inlined, the copy is not on the stack while they are converted.
    #[inline(never)]
    pub fn replace(&mut self, axis: usize, compensation: &AxisCompensation<S>) {
        if let (Some(slot), Some(state)) = (self.axes.get_mut(axis), self.states.get_mut(axis)) {
            *slot = *compensation;
            slot.activate(state);
            slot.start(state, axis, &self.inputs);
        }
        if let Some(is_set) = self.is_set.get_mut(axis) {
            *is_set = true;
        }
        self.schedule = Schedule::EMPTY;
        for ((axis, compensation), is_set) in (0..).zip(&self.axes).zip(&self.is_set) {
            if *is_set {
                self.schedule.add(axis, compensation.round_robin);
            }
        }
    }

    /// Switches one compensation of an axis on or off.
    pub fn switch(&mut self, axis: usize, item: CompensationKind, on: bool) {
        let Some(state) = self.states.get_mut(axis) else { return };
        state.switch(item, on);
        if let (Some(true), Some(compensation)) = (self.is_set.get(axis), self.axes.get(axis)) {
            compensation.activate(state);
        }
    }

    /// Sets the axes to rest at other positions, without force.
    pub fn rest_at(&mut self, positions: &[Position; N]) {
        self.inputs.motions = positions.map(CommandMotion::at);
        for (state, motion) in self.states.iter_mut().zip(&self.inputs.motions) {
            state.rest_at(motion);
        }
    }

    /// Continues after the command of an axis has been shifted by a distance, position units.
    pub fn shift(&mut self, axis: usize, command: i64) {
        if let (Some(motion), Some(state)) = (self.inputs.motions.get_mut(axis), self.states.get_mut(axis)) {
            *motion = motion.shifted(command);
            state.model.shift(command);
        }
    }

    /// The present corrections of the commands.
    #[must_use]
    pub fn active_corrections(&self) -> [Correction<S>; N] {
        self.states.each_ref().map(State::correction)
    }

    /// The readings with the errors of the resolvers corrected, once per tick.
    pub fn readings(&mut self, readings: &[Reading; N]) -> [Reading; N] {
        let mut corrected = *readings;
        self.correct(&mut corrected);
        corrected
    }

    /// Corrects the errors of the resolvers, once per tick.
    #[inline(never)]
    pub fn correct(&mut self, readings: &mut [Reading; N]) {
        self.inputs.clock = self.inputs.clock.wrapping_add(1);
        for (((reading, axis), state), is_set) in
            readings.iter_mut().zip(&self.axes).zip(&mut self.states).zip(&self.is_set)
        {
            if *is_set {
                reading.motor = axis.reading(state, reading.motor);
            }
            one_after_the_other();
        }
    }

    /// Sets the time that drift and cold friction depend on forward, or back, by a number of ticks: for commands that are due later.
    pub const fn turn_clock(&mut self, ticks: i8) {
        self.inputs.clock = self.inputs.clock.wrapping_add_signed(ticks as i64);
    }

    /// The corrections of the commands, once per command.
    pub fn commands(&mut self, commands: &[Position; N]) -> [Correction<S>; N] {
        self.advance(commands, false);
        self.correct_commands();
        self.active_corrections()
    }

    /// The forces to add, once per tick.
    pub fn forces(&mut self, readings: &[Reading; N]) -> [S; N] {
        core::array::from_fn(|axis| readings.get(axis).map_or(S::ZERO, |reading| self.force(axis, reading)))
    }

    /// Updates the motion of the commands, once per command, also without a compensation, so that one that is set during
    /// motion starts from the motion of the axes. If this command takes longer than others, round-robin terms wait, for up to
    /// [`MAX_WAIT`] commands.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a call in every tick")]
    pub fn advance(&mut self, commands: &[Position; N], is_long_tick: bool) {
        for (motion, command) in self.inputs.motions.iter_mut().zip(commands) {
            motion.step(*command);
        }
        if is_long_tick && self.waited < MAX_WAIT {
            self.waited += 1;
            return;
        }
        self.waited = 0;
        if let Some((axis, term)) = self.schedule.advance()
            && let (Some(compensation), Some(state)) = (self.axes.get(axis), self.states.get_mut(axis))
        {
            compensation.evaluate(term, state, axis, &self.inputs);
        }
    }

    /// The present corrections of the commands, one axis after the other.
    pub fn corrections(&self) -> impl Iterator<Item = Correction<S>> {
        self.states.iter().map(State::correction)
    }

    /// Computes the corrections of the commands, once after each [`Compensation::advance`].
    pub fn correct_commands(&mut self) {
        let axes = self.axes.iter().zip(&mut self.states).zip(&self.is_set);
        for (axis, ((compensation, state), is_set)) in axes.enumerate() {
            if *is_set {
                compensation.correct_command(state, axis, &self.inputs.motions);
            }
        }
    }

    /// Sets the force of an axis at rest to what it approaches, and returns it: for an axis whose drive has just come on with its load.
    pub fn settle_force(&mut self, axis: usize, reading: &Reading) -> S {
        match (self.is_set.get(axis), self.axes.get(axis), self.states.get_mut(axis)) {
            (Some(true), Some(compensation), Some(state)) => compensation.settle_force(state, reading.motor),
            _ => S::ZERO,
        }
    }

    /// The force to add to that of an axis, once per tick.
    pub fn force(&mut self, axis: usize, reading: &Reading) -> S {
        match (self.is_set.get(axis), self.axes.get(axis), self.states.get_mut(axis)) {
            (Some(true), Some(compensation), Some(state)) => compensation.force(state, reading.motor),
            _ => S::ZERO,
        }
    }
}
