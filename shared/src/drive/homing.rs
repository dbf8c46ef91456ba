//! Homing of an axis of the drive system: the sequence of [`crate::homing`] with the machine, its switches and its origin.

use super::drive_system::DriveSystem;
use super::output::DriveOutput;
use crate::feedback::Reading;
use crate::homing::{
    Direction, HardStop, HardStopSettings, Homing, HomingAction, HomingError, HomingInput, HomingRun,
    HomingSettings, HomingStatus,
};
use crate::interpolate::{Block, PathError};
use crate::safety::Power;
use crate::scalar::Scalar;
use crate::units::Position;

impl<S: Scalar, const N: usize, O: DriveOutput<S>> DriveSystem<'_, S, N, O> {
    /// Starts to home an axis, which loses its present reference. [`DriveSystem::plan_homing`] has to be called
    /// until it has ended. Not part of a tick.
    ///
    /// # Errors
    /// [`HomingError::NotReady`] unless the drives are on, the axes at rest and no homing runs; [`HomingError::Setting`].
    /// Nothing is changed then.
    pub fn home(&mut self, axis: usize, settings: &HomingSettings) -> Result<(), HomingError> {
        let tick_hz = self.ready_to_home(axis)?;
        let homing = Homing::new(settings, tick_hz, self.machine().uses_scale(axis))?;
        self.start_homing(axis, HomingRun::ToMark(homing));
        Ok(())
    }

    /// Starts to home an axis to a hard stop, as [`DriveSystem::home`]. Its force is limited until the homing has ended.
    ///
    /// # Errors
    /// As [`DriveSystem::home`]; [`HomingError::Weight`].
    pub fn home_to_stop(&mut self, axis: usize, settings: &HardStopSettings) -> Result<(), HomingError> {
        let tick_hz = self.ready_to_home(axis)?;
        if self.machine().carries_weight(axis) {
            return Err(HomingError::Weight);
        }
        let homing = HardStop::new(settings, tick_hz, self.machine().uses_scale(axis))?;
        self.start_homing(axis, HomingRun::ToStop(homing));
        Ok(())
    }

    /// The tick rate, Hz, if a homing of an axis may start.
    fn ready_to_home(&self, axis: usize) -> Result<f64, HomingError> {
        let rates = self.machine().rates().filter(|_| axis < N).ok_or(HomingError::NotReady)?;
        if self.is_homing()
            || self.is_checking()
            || self.machine().power() != Power::On
            || !self.machine().is_at_rest()
        {
            return Err(HomingError::NotReady);
        }
        Ok(rates.velocity_loop_hz)
    }

    /// Whether a homing runs.
    fn is_homing(&self) -> bool {
        self.homing.as_ref().is_some_and(|(_, homing)| homing.is_running())
    }

    fn start_homing(&mut self, axis: usize, homing: HomingRun) {
        self.machine_mut().lose_reference(axis);
        let limit = homing.force_limit_n().map(S::signal);
        self.machine_mut().limit_force(axis, limit);
        self.homing = Some((axis, homing));
    }

    /// Axis and state of the homing that runs or that ran last.
    #[must_use]
    pub fn homing_status(&self) -> Option<(usize, HomingStatus)> {
        self.homing.as_ref().map(|(axis, homing)| (*axis, homing.status()))
    }

    /// Stops a homing; the axis decelerates to rest. No effect if none runs.
    pub fn stop_homing(&mut self) {
        if let Some((axis, homing)) = self.homing.as_mut().filter(|(_, homing)| homing.is_running()) {
            homing.stop();
            let axis = *axis;
            self.machine_mut().limit_force(axis, None);
            self.machine_mut().halt();
        }
    }

    /// Plans the motion that a homing waits for. To be called regularly, not in a tick: planning takes longer than one.
    pub fn plan_homing(&mut self) {
        if let Some(leg) = self.homing_leg() {
            let planned = self.machine_mut().jog(&leg);
            self.homing_leg_planned(planned);
        }
    }

    /// The motion that a homing waits for, to be planned elsewhere; [`DriveSystem::homing_leg_planned`] has to follow.
    #[must_use]
    pub fn homing_leg(&self) -> Option<Block<N>> {
        let (axis, homing) = self.homing.as_ref()?;
        let leg = homing.leg_to_plan()?;
        let mut to_m = self.machine().command().map(Position::to_m);
        if let Some(to_m) = to_m.get_mut(*axis) {
            *to_m += leg.distance_m;
        }
        Some(Block::line(to_m, leg.speed_m_per_s, leg.acceleration_m_per_s2))
    }

    /// The motion of [`DriveSystem::homing_leg`] was appended to the path, or rejected by it.
    pub fn homing_leg_planned(&mut self, planned: Result<(), PathError>) {
        if let Some((axis, homing)) = &mut self.homing {
            homing.leg_planned(planned);
            let axis = *axis;
            if !self.is_homing() {
                self.machine_mut().limit_force(axis, None);
            }
        }
    }

    /// The part of a homing in a tick, before the machine's.
    pub(super) fn home_tick(&mut self, from_power_up: &[Reading; N]) {
        let running = self.homing.as_ref().filter(|(_, homing)| homing.is_running());
        let Some(axis) = running.map(|(axis, _)| *axis) else { return };
        let (at_rest, is_on) = (self.machine().is_at_rest(), self.machine().power() == Power::On);
        let axis_inputs = self.inputs().axes;
        let (commands, forces) = (self.machine().command(), self.forces);
        let (Some(input), Some(reading), Some(command), Some(force), Some(origin)) = (
            axis_inputs.get(axis),
            from_power_up.get(axis),
            commands.get(axis),
            forces.get(axis),
            self.origins.get(axis),
        ) else {
            return;
        };
        let at_force_limit = match self.machine().is_at_force_limit(axis, *force) {
            [true, _] => Some(Direction::Positive),
            [_, true] => Some(Direction::Negative),
            _ => None,
        };
        let Some((_, homing)) = &mut self.homing else { return };
        let action = homing.tick(&HomingInput {
            home: input.home,
            limits: input.limits,
            reading: reading.shifted(*origin),
            command: *command,
            at_force_limit,
            motor_index: input.motor_index.map(|index| index + origin.motor),
            scale_index: input.scale_index.map(|index| index + origin.table),
            at_rest,
            is_on,
        });
        if !homing.is_running() {
            self.machine_mut().limit_force(axis, None);
        }
        match action {
            None => {}
            Some(HomingAction::Halt) => self.machine_mut().halt(),
            Some(HomingAction::SetOrigin(shift)) => {
                let before = self.machine().command();
                if self.machine_mut().set_origin(axis, shift).is_ok() {
                    self.shift_origin(axis, before, shift);
                }
            }
        }
    }
}
