//! The state of a machine.

use super::brakes::Brakes;
use super::config::MachineConfig;
use super::gantry::Gantries;
use super::output::Output;
use crate::axis::AxisState;
use crate::compensate::Compensation;
use crate::feedback::{OriginShift, Reading};
use crate::interpolate::Path;
use crate::safety::{Event, Fault, FaultSet, Power, Reaction};
use crate::scalar::Scalar;
use crate::units::Position;

/// What is computed for the next position tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ahead {
    /// Nothing: path and corrections are those of the position loops.
    Nothing,
    /// The command.
    Command,
    /// The command and its corrections.
    Corrections,
}

/// What a machine keeps from tick to tick.
// In this order: an instruction reaches the first 4 KiB. The tables of the compensations and the queue of the path are large.
#[repr(C)]
#[derive(Clone, Debug)]
pub(super) struct State<S: Scalar, const N: usize> {
    /// Ticks until the next position tick.
    pub until_position_tick: u32,
    pub power: Power,
    pub warning: Option<Fault>,
    pub enable_requested: bool,
    /// Whether the drives were on in the previous tick.
    pub was_on: bool,
    /// What is already computed for the next position tick.
    pub ahead: Ahead,
    /// Whether the path was done before it was advanced ahead.
    pub was_done: bool,
    /// Whether there is a gantry: one test for all that follows from it.
    pub has_gantry: bool,
    /// The commands that the position loops follow, without corrections.
    pub commands: [Position; N],
    pub brakes: Brakes,
    /// Forces that are added behind the velocity controllers.
    pub excitation: [S; N],
    pub axes: [AxisState<S>; N],
    pub compensation: Compensation<S, N>,
    pub path: Path<N>,
    pub gantries: Gantries<N>,
}

impl<S: Scalar, const N: usize> State<S, N> {
    /// At zero, drives off.
    pub const NEW: Self = Self {
        axes: [AxisState::at_rest(Position(0), Reading { motor: Position(0), table: None }); N],
        compensation: Compensation::NONE,
        path: Path::AT_ZERO,
        until_position_tick: 0,
        power: Power::Off,
        warning: None,
        enable_requested: false,
        was_on: false,
        ahead: Ahead::Nothing,
        was_done: false,
        has_gantry: false,
        gantries: Gantries::NONE,
        commands: [Position(0); N],
        brakes: Brakes::CLOSED,
        excitation: [S::ZERO; N],
    };

    /// Resets to the state of a machine at rest at `start`, drives off.
    pub fn reset(&mut self, config: &MachineConfig<S, N>, start: &[Position; N]) {
        self.axes = start.map(|motor| AxisState::at_rest(motor, Reading { motor, table: None }));
        self.compensation.reset(start);
        self.path.reset(start, config.rates.position_loop_hz(), config.filters);
        self.path.set_travel(config.travel());
        self.path.set_second_motors(config.gantries.map(|gantry| gantry.map(|gantry| gantry.first)));
        self.has_gantry = config.gantries.iter().any(Option::is_some);
        self.gantries.reset(&config.gantries, start);
        self.until_position_tick = 0;
        self.power = Power::Off;
        self.warning = None;
        (self.enable_requested, self.was_on, self.brakes) = (false, false, Brakes::CLOSED);
        (self.ahead, self.commands) = (Ahead::Nothing, *start);
        self.excitation = [S::ZERO; N];
    }

    /// Reacts to a fault.
    pub fn fault(&mut self, config: &MachineConfig<S, N>, fault: Fault) {
        if !self.power.is_on() {
            return;
        }
        match fault.reaction() {
            Reaction::DriveOff => {}
            Reaction::Stop => self.path.brake(config.stop_deceleration()),
            Reaction::Warn => self.warning = self.warning.or(Some(fault)),
        }
        self.power = self.power.after(Event::Fault(fault));
    }

    /// The result of the tick.
    pub fn output(&self, forces: [S; N]) -> Output<S, N> {
        Output {
            forces,
            commands: self.commands,
            enabled: self.was_on,
            warning: self.warning,
            done: self.is_done(),
        }
    }

    /// The commands that the position loops follow, with their corrections.
    pub fn corrected_commands(&self) -> [Position; N] {
        if self.ahead == Ahead::Corrections {
            return self.axes.each_ref().map(AxisState::corrected_command);
        }
        let mut commands = self.commands;
        for (command, correction) in commands.iter_mut().zip(self.compensation.active_corrections()) {
            *command += correction.total.distance();
        }
        commands
    }

    /// Whether every block has ended and the loops follow its end.
    #[inline]
    pub fn is_done(&self) -> bool {
        self.path.is_done() && (self.ahead == Ahead::Nothing || self.was_done)
    }

    /// Whether the path is done and does not stop.
    pub fn is_at_rest(&self) -> bool {
        self.is_done() && !self.path.is_braking()
    }

    /// The path and the loops rest at commands.
    pub fn rest_at(&mut self, commands: &[Position; N]) {
        self.path.rest_at(commands);
        self.gantries.rest_at(commands);
        (self.commands, self.ahead) = (*commands, Ahead::Nothing);
    }

    /// The commands of the path, with those of the second motors of gantries.
    #[inline]
    pub fn path_commands(&self) -> [Position; N] {
        let mut commands = self.path.command();
        if self.has_gantry {
            self.gantries.couple(&mut commands);
        }
        commands
    }

    /// Whether the last tick ran the position loops.
    pub const fn is_after_position_tick(&self, config: &MachineConfig<S, N>) -> bool {
        self.was_on && self.until_position_tick + 1 == config.rates.position_loop_divider
    }

    /// Continues after the readings of an axis have been shifted, and its command with them, without a step. The path must be
    /// done.
    pub fn shift_origin(&mut self, config: &MachineConfig<S, N>, index: usize, origin: OriginShift) {
        let (Some(axis), Some(axis_config)) = (self.axes.get_mut(index), config.axes.get(index)) else {
            return;
        };
        let shift = if axis_config.feedback.uses_scale() { origin.table } else { origin.motor };
        let mut commands = self.commands;
        if let Some(command) = commands.get_mut(index) {
            *command += shift;
            *axis = axis.shifted(*command, shift, origin);
        }
        self.path.rest_at(&commands);
        self.commands = commands;
        self.compensation.shift(index, shift);
        self.gantries.shift(index, shift);
    }

    /// Raises the faults of each axis.
    pub fn raise(&mut self, config: &MachineConfig<S, N>, faults: [FaultSet; N]) {
        if faults.iter().any(|faults| !faults.is_empty()) {
            self.raise_each(config, &faults);
        }
    }

    #[cold]
    #[inline(never)]
    fn raise_each(&mut self, config: &MachineConfig<S, N>, faults: &[FaultSet; N]) {
        for (axis, faults) in (0..).zip(faults) {
            for kind in faults.iter() {
                self.fault(config, Fault::Axis { axis, kind });
            }
        }
    }
}
