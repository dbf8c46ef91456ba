//! Homing of an axis of the drive system: the sequence of [`crate::homing`] with the machine, its switches and its origin.

use super::drive_system::DriveSystem;
use super::output::DriveOutput;
use crate::feedback::Reading;
use crate::homing::{Homing, HomingAction, HomingError, HomingInput, HomingSettings, HomingStatus};
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
        let rates = self.machine().rates().filter(|_| axis < N).ok_or(HomingError::NotReady)?;
        let is_homing = self.homing.as_ref().is_some_and(|(_, homing)| homing.is_running());
        if is_homing
            || self.is_checking()
            || self.machine().power() != Power::On
            || !self.machine().is_at_rest()
        {
            return Err(HomingError::NotReady);
        }
        let homing = Homing::new(settings, rates.velocity_loop_hz, self.machine().uses_scale(axis))?;
        self.machine_mut().lose_reference(axis);
        self.homing = Some((axis, homing));
        Ok(())
    }

    /// Axis and state of the homing that runs or that ran last.
    #[must_use]
    pub fn homing_status(&self) -> Option<(usize, HomingStatus)> {
        self.homing.as_ref().map(|(axis, homing)| (*axis, homing.status()))
    }

    /// Stops a homing; the axis decelerates to rest. No effect if none runs.
    pub fn stop_homing(&mut self) {
        if let Some((_, homing)) = self.homing.as_mut().filter(|(_, homing)| homing.is_running()) {
            homing.stop();
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
        if let Some((_, homing)) = &mut self.homing {
            homing.leg_planned(planned);
        }
    }

    /// The part of a homing in a tick, before the machine's.
    pub(super) fn home_tick(&mut self, from_power_up: &[Reading; N]) {
        let (at_rest, is_on) = (self.machine().is_at_rest(), self.machine().power() == Power::On);
        let axis_inputs = self.inputs().axes;
        let Some((axis, homing)) = &mut self.homing else { return };
        let axis = *axis;
        let (Some(input), Some(reading), Some(origin)) =
            (axis_inputs.get(axis), from_power_up.get(axis), self.origins.get(axis))
        else {
            return;
        };
        let action = homing.tick(&HomingInput {
            home: input.home,
            limits: input.limits,
            reading: reading.shifted(*origin),
            motor_index: input.motor_index.map(|index| index + origin.motor),
            scale_index: input.scale_index.map(|index| index + origin.table),
            at_rest,
            is_on,
        });
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
