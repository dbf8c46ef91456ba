//! The tick, in the order of the signal.

use super::brakes::Brakes;
use super::config::MachineConfig;
use super::output::Output;
use super::state::State;
use crate::axis::AxisState;
use crate::compensate::Correction;
use crate::config::{AxisConfig, ScheduledOver};
use crate::control::gain_schedule::Gains;
use crate::feedback::Reading;
use crate::interpolate::following::Ending;
use crate::safety::{Event, Fault, FaultKind, FaultSet, Power};
use crate::scalar::Scalar;
use crate::units::{PER_NM, Position};

/// Greatest distance of an axis from the start of a waiting path at enable, position units: 0.1 mm. With a position gain of
/// 50 /s the axis would start at 5 mm/s.
const DISPLACEMENT_LIMIT: u64 = 100_000 * PER_NM.unsigned_abs();

/// The readings as the position loop uses them: the scale's with the correction for errors between motor and scale.
fn with_screw<S: Scalar>(reading: Reading, correction: Correction<S>) -> Reading {
    Reading { table: reading.table.map(|table| table + correction.screw.distance()), ..reading }
}

impl<S: Scalar, const N: usize> MachineConfig<S, N> {
    /// One tick.
    pub(super) fn tick(&mut self, state: &mut State<S, N>, readings: &[Reading; N]) -> Output<S, N> {
        let mut corrected = *readings;
        state.compensation.correct(&mut corrected);
        let readings = &corrected;
        if !matches!(state.power, Power::On) {
            self.tick_brakes(state);
            if !state.power.is_on() {
                self.tick_disabled(state, readings);
            }
        }
        state.enable_requested = false;
        let mut forces = [S::ZERO; N];
        if state.power.is_on() {
            if state.until_position_tick == 0 {
                self.position_tick(state, readings);
                state.until_position_tick = self.rates.position_loop_divider;
            }
            state.until_position_tick -= 1;
            if !state.was_on {
                self.preload(state, readings);
            }
            forces = self.velocity_tick(state, readings);
            if !state.power.is_on() {
                forces = [S::ZERO; N];
                self.hold_axes(state, readings);
            }
        }
        state.was_on = state.power.is_on();
        state.output(forces)
    }

    /// The brakes of a machine that is not simply on. They are closed while it is off.
    #[cold]
    #[inline(never)]
    fn tick_brakes(&self, state: &mut State<S, N>) {
        let at_rest = state.is_at_rest();
        if let Some(times) = self.brake_times()
            && let Some(event) = state.brakes.tick(state.power, times, at_rest)
        {
            state.power = state.power.after(event);
            if state.power == Power::Off {
                state.warning = None;
            }
        }
        if !state.power.is_on() {
            state.brakes = Brakes::CLOSED;
        }
    }

    /// The first tick after an enable: the force begins with the preload. That of the compensations, which does not rise from zero then,
    /// is part of it, and the integrals make up the rest.
    #[cold]
    #[inline(never)]
    fn preload(&self, state: &mut State<S, N>, readings: &[Reading; N]) {
        let State { axes, compensation, .. } = state;
        for (index, ((axis, config), reading)) in axes.iter_mut().zip(&self.axes).zip(readings).enumerate() {
            if let Some(preload) = config.preload {
                axis.preload(preload - compensation.settle_force(index, reading));
            }
        }
    }

    /// The tick of a machine that is off, before the loops: the commands follow the axes; an enable that is requested is done.
    #[cold]
    #[inline(never)]
    fn tick_disabled(&self, state: &mut State<S, N>, readings: &[Reading; N]) {
        if state.was_on || state.path.is_done() {
            self.hold_axes(state, readings);
        }
        if state.enable_requested && state.power == Power::Off {
            self.enable(state, readings);
        }
    }

    /// Closes the loops at the present command, with every integral at zero.
    fn enable(&self, state: &mut State<S, N>, readings: &[Reading; N]) {
        if let Some(fault) = self.missing_scale(readings) {
            state.power = state.power.after(Event::Inhibit(fault));
            return;
        }
        if state.has_gantry
            && let Some(fault) = self.skewed(state, readings)
        {
            state.power = state.power.after(Event::Inhibit(fault));
            return;
        }
        let displaced = self.displaced(state, readings);
        if displaced.is_some() {
            self.hold_axes(state, readings);
            state.warning = displaced;
        }
        let corrections = state.compensation.active_corrections();
        for (((axis, command), reading), correction) in
            state.axes.iter_mut().zip(state.commands).zip(readings).zip(corrections)
        {
            *axis = AxisState::at_rest(command, with_screw(*reading, correction))
                .corrected(correction.total.distance());
        }
        state.until_position_tick = 0;
        let has_brakes = self.brake_times().is_some();
        state.power = state.power.after(if has_brakes { Event::EnableWithBrakes } else { Event::Enable });
    }

    /// The first axis whose loop uses a scale that has no reading.
    fn missing_scale(&self, readings: &[Reading; N]) -> Option<Fault> {
        let missing = |(config, reading): (&AxisConfig<S>, &Reading)| {
            config.feedback.uses_scale() && reading.table.is_none()
        };
        let mut axes = (0..).zip(self.axes.iter().zip(readings).map(missing));
        axes.find(|(_, missing)| *missing).map(|(axis, _)| Fault::Axis { axis, kind: FaultKind::ScaleLost })
    }

    /// The fault of the first gantry with more skew than its limit. The positions are those of the commands at which the motors would hold: the
    /// corrections of each screw and scale are taken out.
    #[cold]
    #[inline(never)]
    fn skewed(&self, state: &mut State<S, N>, readings: &[Reading; N]) -> Option<Fault> {
        let positions = self.holding_commands(state, readings);
        let axis = u8::try_from(state.gantries.skewed(&positions)?).unwrap_or(u8::MAX);
        Some(Fault::Axis { axis, kind: FaultKind::GantrySkew })
    }

    /// The first axis that is away from the start of the path.
    fn displaced(&self, state: &State<S, N>, readings: &[Reading; N]) -> Option<Fault> {
        let holding = self.holding_commands(state, readings);
        let mut axes = (0..).zip(holding.into_iter().zip(state.commands));
        let axis =
            axes.find(|&(_, (holding, command))| (holding - command).unsigned_abs() > DISPLACEMENT_LIMIT);
        axis.map(|(axis, _)| Fault::Axis { axis, kind: FaultKind::Displaced })
    }

    /// The commands that hold each axis at its present position.
    fn holding_commands(&self, state: &State<S, N>, readings: &[Reading; N]) -> [Position; N] {
        let mut commands = [Position(0); N];
        let corrections = state.compensation.active_corrections();
        for (((command, config), reading), correction) in
            commands.iter_mut().zip(&self.axes).zip(readings).zip(corrections)
        {
            let Reading { motor, table } = with_screw(*reading, correction);
            *command = config.feedback.settled(motor, table) - correction.total.distance();
        }
        commands
    }

    /// Sets the gains of the axes with a schedule, for the commands of the last position tick.
    // Few axes have one, and those without are not to pay for it.
    #[cold]
    #[inline(never)]
    fn schedule(&mut self, state: &State<S, N>) {
        let axes = self.axes.iter_mut().zip(&self.schedules).zip(self.are_homed);
        for (((config, schedule), is_homed), (axis, command)) in
            axes.zip(state.axes.iter().zip(state.commands))
        {
            let Some(schedule) = schedule else { continue };
            let Gains { proportional, integral } = match schedule.over {
                ScheduledOver::Speed => schedule.gains(axis.command_speed()),
                ScheduledOver::Position if is_homed => schedule.gains(command.0),
                ScheduledOver::Position => schedule.base,
            };
            (config.velocity.proportional, config.velocity.integral) = (proportional, integral);
        }
    }

    /// The position loops, with the next commands and their corrections.
    fn position_tick(&mut self, state: &mut State<S, N>, readings: &[Reading; N]) {
        if self.is_scheduled {
            self.schedule(state);
        }
        state.follow_next();
        let mut faults = [FaultSet::NONE; N];
        for (((((faults, axis), config), command), reading), correction) in faults
            .iter_mut()
            .zip(&mut state.axes)
            .zip(&self.axes)
            .zip(state.commands)
            .zip(readings)
            .zip(state.compensation.corrections())
        {
            *faults = axis.position_tick(config, command, correction, *reading);
        }
        state.raise(self, faults);
        if state.has_gantry
            && let Some(fault) = self.skewed(state, readings)
        {
            state.fault(self, fault);
        }
        if !state.path.is_planned() {
            self.not_planned(state);
        }
    }

    /// A stop of the path, or axes that follow counters: raises the fault of one that does so no longer, and ends a stop.
    #[cold]
    #[inline(never)]
    fn not_planned(&self, state: &mut State<S, N>) {
        if let Some((axis, ending)) = state.path.take_ended() {
            let kind = match ending {
                Ending::Lag => FaultKind::GearLag,
                Ending::Travel => FaultKind::SoftLimit,
            };
            state.fault(self, Fault::Axis { axis: u8::try_from(axis).unwrap_or(u8::MAX), kind });
        }
        if state.path.has_stopped() {
            self.stopped(state);
        }
    }

    /// The path has stopped: the drives go off if it was by a fault, with brakes after these have closed.
    fn stopped(&self, state: &mut State<S, N>) {
        let has_brakes = self.brake_times().is_some();
        let event = if has_brakes && matches!(state.power, Power::Stopping(_)) {
            Event::DisableWithBrakes
        } else {
            Event::Stopped
        };
        state.power = state.power.after(event);
        if matches!(state.power, Power::On | Power::Disabling(_)) {
            state.path.rest_at(&state.commands);
        }
    }

    /// The velocity loops, with the forces of the compensations.
    fn velocity_tick(&self, state: &mut State<S, N>, readings: &[Reading; N]) -> [S; N] {
        let (mut forces, mut faults) = ([S::ZERO; N], [FaultSet::NONE; N]);
        let State { axes, compensation, excitation, .. } = state;
        for (i, (((((force, faults), axis), config), reading), excitation)) in forces
            .iter_mut()
            .zip(&mut faults)
            .zip(axes)
            .zip(&self.axes)
            .zip(readings)
            .zip(excitation)
            .enumerate()
        {
            let added = compensation.force(i, reading) + *excitation;
            (*force, *faults) = axis.velocity_tick(config, *reading, added);
        }
        state.raise(self, faults);
        forces
    }

    /// Discards the path and sets the commands to the positions of the axes, so that there is no following error.
    #[cold]
    #[inline(never)]
    fn hold_axes(&self, state: &mut State<S, N>, readings: &[Reading; N]) {
        let commands = self.holding_commands(state, readings);
        state.compensation.rest_at(&commands);
        state.rest_at(&commands);
    }
}
