//! Homing of an axis of the drive system: the sequence of [`crate::homing`] with the machine, its switches and its origin.

use super::drive_system::DriveSystem;
use super::output::DriveOutput;
use super::sequence::Sequence;
use crate::feedback::Reading;
use crate::homing::{
    Direction, HardStop, HardStopSettings, Homing, HomingAction, HomingError, HomingInput, HomingRun,
    HomingSettings, HomingStatus,
};
use crate::safety::Power;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize, O: DriveOutput<S>> DriveSystem<'_, S, N, O> {
    /// Starts to home an axis, which loses its present reference. [`DriveSystem::plan_leg`] has to be called
    /// until it has ended. Not part of a tick.
    ///
    /// # Errors
    /// [`HomingError::NotReady`] unless the drives are on, the axes at rest and no homing runs; [`HomingError::Setting`].
    /// Nothing is changed then.
    pub fn home(&mut self, axis: usize, settings: &HomingSettings) -> Result<(), HomingError> {
        let tick_hz = self.ready_for_sequence(axis).ok_or(HomingError::NotReady)?;
        let homing = Homing::new(settings, tick_hz, self.machine().uses_scale(axis))?;
        self.start_homing(axis, HomingRun::ToMark(homing));
        Ok(())
    }

    /// Starts to home an axis to a hard stop, as [`DriveSystem::home`]. Its force is limited until the homing has ended.
    ///
    /// # Errors
    /// As [`DriveSystem::home`]; [`HomingError::Weight`].
    pub fn home_to_stop(&mut self, axis: usize, settings: &HardStopSettings) -> Result<(), HomingError> {
        let tick_hz = self.ready_for_sequence(axis).ok_or(HomingError::NotReady)?;
        if self.machine().carries_weight(axis) {
            return Err(HomingError::Weight);
        }
        let homing = HardStop::new(settings, tick_hz, self.machine().uses_scale(axis))?;
        self.start_homing(axis, HomingRun::ToStop(homing));
        Ok(())
    }

    fn start_homing(&mut self, axis: usize, homing: HomingRun) {
        self.machine_mut().lose_reference(axis);
        let limit = homing.force_limit_n().map(S::signal);
        self.machine_mut().limit_force(axis, limit);
        self.sequence = Some((axis, Sequence::Homing(homing)));
    }

    /// Axis and state of the homing that runs or that ran last; `None` if a probing has run since.
    #[must_use]
    pub fn homing_status(&self) -> Option<(usize, HomingStatus)> {
        match &self.sequence {
            Some((axis, Sequence::Homing(homing))) => Some((*axis, homing.status())),
            _ => None,
        }
    }

    /// The axis of a homing that runs.
    pub(super) fn homing_axis(&self) -> Option<usize> {
        self.homing_status().filter(|(_, status)| *status == HomingStatus::Running).map(|(axis, _)| axis)
    }

    /// The part of a homing in a tick, before the machine's.
    pub(super) fn home_tick(&mut self, from_power_up: &[Reading; N]) {
        let Some(axis) = self.homing_axis() else { return };
        let (at_rest, is_on) = (self.machine().is_at_rest(), self.machine().power() == Power::On);
        let axis_inputs = self.inputs().axes;
        let (commands, forces) = (self.machine().command(), self.forces);
        let edge = self.before(self.debounce.ticks_since_home(axis)).readings;
        let (Some(input), Some(reading), Some(edge), Some(command), Some(force), Some(origin)) = (
            axis_inputs.get(axis),
            from_power_up.get(axis),
            edge.get(axis),
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
        let Some((_, Sequence::Homing(homing))) = &mut self.sequence else { return };
        let action = homing.tick(&HomingInput {
            home: input.home,
            home_reading: edge.shifted(*origin),
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
