//! What a machine remembers from tick to tick, and the tick.

use super::config::MachineConfig;
use super::output::Output;
use crate::axis::{AxisState, Reading};
use crate::compensate::Compensation;
use crate::config::AxisConfig;
use crate::interpolate::Path;
use crate::safety::{Event, Fault, FaultKind, FaultSet, Power, Reaction};
use crate::scalar::Scalar;
use crate::units::{PER_NM, Position};

/// An axis that stands further than this from where the waiting path begins has been moved: 0.1 mm. With a position
/// gain of 50 /s it would start at 5 mm/s.
const DISPLACEMENT_LIMIT: u64 = 100_000 * PER_NM.unsigned_abs();

/// The state of a machine.
#[derive(Clone, Debug)]
pub(super) struct State<S: Scalar, const N: usize> {
    pub axes: [AxisState<S>; N],
    pub compensation: Compensation<S, N>,
    pub path: Path<N>,
    until_position_tick: u32,
    pub power: Power,
    pub warning: Option<Fault>,
    pub enable_requested: bool,
    /// Whether the drives were on in the tick before.
    pub was_on: bool,
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
    };

    /// Makes it the state of another machine that stands at `start`, drives off.
    pub fn reset(&mut self, config: &MachineConfig<S, N>, start: &[Position; N]) {
        self.axes = start.map(|place| AxisState::at_rest(place, Reading { motor: place, table: None }));
        self.compensation.reset(start);
        self.path.reset(start, config.rates.position_loop_hz(), config.filters);
        self.path.set_travel(config.travel());
        self.until_position_tick = 0;
        self.power = Power::Off;
        self.warning = None;
        (self.enable_requested, self.was_on) = (false, false);
    }

    /// Takes a fault.
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

    /// What the tick gives to the drives and to whoever watches.
    pub fn output(&self, forces: [S; N]) -> Output<S, N> {
        Output {
            forces,
            commands: self.path.command(),
            enabled: self.power.is_on(),
            warning: self.warning,
            done: self.path.is_done(),
        }
    }

    fn raise(&mut self, config: &MachineConfig<S, N>, faults: [FaultSet; N]) {
        if faults.iter().all(|faults| faults.is_empty()) {
            return;
        }
        for (axis, faults) in (0..).zip(faults) {
            for kind in faults.iter() {
                self.fault(config, Fault::Axis { axis, kind });
            }
        }
    }
}

impl<S: Scalar, const N: usize> MachineConfig<S, N> {
    /// One tick.
    pub(super) fn tick(&self, state: &mut State<S, N>, readings: &[Reading; N]) -> Output<S, N> {
        let readings = &state.compensation.readings(readings);
        if !state.power.is_on() && (state.was_on || state.path.is_done()) {
            self.stand(state, readings);
        }
        if core::mem::take(&mut state.enable_requested) && state.power == Power::Off {
            self.switch_on(state, readings);
        }
        let mut forces = [S::ZERO; N];
        if state.power.is_on() {
            if state.until_position_tick == 0 {
                state.until_position_tick = self.rates.position_loop_divider;
                self.position_tick(state, readings);
            }
            state.until_position_tick -= 1;
            forces = self.velocity_tick(state, readings);
            if !state.power.is_on() {
                forces = [S::ZERO; N];
                self.stand(state, readings);
            }
        }
        state.was_on = state.power.is_on();
        state.output(forces)
    }

    /// Closes the loops on the command that stands, with nothing integrated.
    fn switch_on(&self, state: &mut State<S, N>, readings: &[Reading; N]) {
        if let Some(fault) = self.missing_scale(readings) {
            state.power = state.power.after(Event::Inhibit(fault));
            return;
        }
        let displaced = self.displaced(state, readings);
        if displaced.is_some() {
            self.stand(state, readings);
            state.warning = displaced;
        }
        let standing = state.compensation.standing();
        for (((axis, command), reading), added) in
            state.axes.iter_mut().zip(state.path.command()).zip(readings).zip(standing)
        {
            *axis = AxisState::at_rest(command, *reading).corrected(added);
        }
        state.until_position_tick = 0;
        state.power = state.power.after(Event::Enable);
    }

    /// The first axis whose loop needs a scale that is not read.
    fn missing_scale(&self, readings: &[Reading; N]) -> Option<Fault> {
        let lacks = |(config, reading): (&AxisConfig<S>, &Reading)| {
            config.feedback.uses_scale() && reading.table.is_none()
        };
        let mut axes = (0..).zip(self.axes.iter().zip(readings).map(lacks));
        axes.find(|(_, lacks)| *lacks).map(|(axis, _)| Fault::Axis { axis, kind: FaultKind::ScaleLost })
    }

    /// The first axis that stands away from where the path begins.
    fn displaced(&self, state: &State<S, N>, readings: &[Reading; N]) -> Option<Fault> {
        let places = self.places(state, readings).into_iter().zip(state.path.command());
        let mut axes = (0..).zip(places);
        let axis = axes.find(|&(_, (place, command))| (place - command).unsigned_abs() > DISPLACEMENT_LIMIT);
        axis.map(|(axis, _)| Fault::Axis { axis, kind: FaultKind::Displaced })
    }

    /// Commands that ask of each axis to stay where it is.
    fn places(&self, state: &State<S, N>, readings: &[Reading; N]) -> [Position; N] {
        let mut places = [Position(0); N];
        let standing = state.compensation.standing();
        for (((place, config), reading), added) in
            places.iter_mut().zip(&self.axes).zip(readings).zip(standing)
        {
            *place = config.feedback.settled(reading.motor, reading.table) - added;
        }
        places
    }

    /// The next command with what corrects it, and the position loops.
    fn position_tick(&self, state: &mut State<S, N>, readings: &[Reading; N]) {
        let commands = state.path.advance();
        let corrections = state.compensation.commands(&commands);
        let mut faults = [FaultSet::NONE; N];
        for (((((faults, axis), config), command), correction), reading) in faults
            .iter_mut()
            .zip(&mut state.axes)
            .zip(&self.axes)
            .zip(commands)
            .zip(corrections)
            .zip(readings)
        {
            *faults = axis.position_tick(config, command, correction, *reading);
        }
        state.raise(self, faults);
        if state.path.has_stopped() {
            state.power = state.power.after(Event::Stopped);
        }
    }

    /// The velocity loops, with the forces that are added.
    fn velocity_tick(&self, state: &mut State<S, N>, readings: &[Reading; N]) -> [S; N] {
        let added = state.compensation.forces(readings);
        let (mut forces, mut faults) = ([S::ZERO; N], [FaultSet::NONE; N]);
        for (((((force, faults), axis), config), reading), added) in
            forces.iter_mut().zip(&mut faults).zip(&mut state.axes).zip(&self.axes).zip(readings).zip(added)
        {
            (*force, *faults) = axis.velocity_tick(config, *reading, added);
        }
        state.raise(self, faults);
        forces
    }

    /// Forgets the path and makes the command what the position loops read: no error, no jump.
    fn stand(&self, state: &mut State<S, N>, readings: &[Reading; N]) {
        let places = self.places(state, readings);
        state.compensation.stand_at(&places);
        state.path.rest_at(&places);
    }
}
