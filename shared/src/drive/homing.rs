//! Homing of an axis of the drive system: the sequence of [`crate::homing`] with the machine, its switches and its origin.

use super::drive_system::DriveSystem;
use super::inputs::AxisInputs;
use super::output::DriveOutput;
use super::sequence::Sequence;
use crate::feedback::Reading;
use crate::homing::{
    Direction, GantryHoming, HardStop, HardStopSettings, Homing, HomingAction, HomingError, HomingInput,
    HomingRun, HomingSettings, HomingStatus,
};
use crate::safety::Power;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize, O: DriveOutput<S>> DriveSystem<'_, S, N, O> {
    /// Starts to home an axis, which loses its present reference. [`DriveSystem::plan_leg`] has to be called
    /// until it has ended. Not part of a tick.
    ///
    /// # Errors
    /// [`HomingError::NotReady`] unless the drives are on, the axes at rest and no homing runs; [`HomingError::Setting`].
    /// [`HomingError::Gantry`] for a motor of one. Nothing is changed then.
    pub fn home(&mut self, axis: usize, settings: &HomingSettings) -> Result<(), HomingError> {
        let tick_hz = self.ready_to_home_alone(axis)?;
        let homing = Homing::new(settings, tick_hz, self.machine().uses_scale(axis))?;
        self.start_homing(axis, &HomingRun::ToMark(homing));
        Ok(())
    }

    /// Starts to home an axis to a hard stop, as [`DriveSystem::home`]. Its force is limited until the homing has ended.
    ///
    /// # Errors
    /// As [`DriveSystem::home`]; [`HomingError::Weight`].
    pub fn home_to_stop(&mut self, axis: usize, settings: &HardStopSettings) -> Result<(), HomingError> {
        let tick_hz = self.ready_to_home_alone(axis)?;
        if self.machine().carries_weight(axis) {
            return Err(HomingError::Weight);
        }
        let homing = HardStop::new(settings, tick_hz, self.machine().uses_scale(axis))?;
        self.start_homing(axis, &HomingRun::ToStop(homing));
        Ok(())
    }

    /// Starts to home both motors of a gantry, of which `first` is the first motor, as [`DriveSystem::home`] with settings for each. The
    /// reference of the second has an offset, m.
    ///
    /// # Errors
    /// As [`DriveSystem::home`]; [`HomingError::Gantry`] if the axis is not a first motor.
    pub fn home_gantry(
        &mut self,
        first: usize,
        settings: [&HomingSettings; 2],
        offset_m: f64,
    ) -> Result<(), HomingError> {
        let tick_hz = self.ready_for_sequence(first).ok_or(HomingError::NotReady)?;
        let second = self.machine().second_motor(first).ok_or(HomingError::Gantry)?;
        let need_scales = [first, second].map(|axis| self.machine().uses_scale(axis));
        let homing = GantryHoming::new(settings, offset_m, tick_hz, need_scales)?;
        self.start_homing(first, &HomingRun::OfGantry(homing));
        Ok(())
    }

    /// The tick rate, Hz, if an axis that is no motor of a gantry may be homed.
    fn ready_to_home_alone(&self, axis: usize) -> Result<f64, HomingError> {
        let tick_hz = self.ready_for_sequence(axis).ok_or(HomingError::NotReady)?;
        self.machine().other_motor(axis).map_or(Ok(tick_hz), |_| Err(HomingError::Gantry))
    }

    fn start_homing(&mut self, axis: usize, homing: &HomingRun) {
        self.machine_mut().lose_reference(axis);
        let limit = homing.force_limit_n().map(S::signal);
        self.machine_mut().limit_force(axis, limit);
        self.sequence = Some((axis, Sequence::Homing(*homing)));
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
        let Some(moved) = self.homing_axis() else { return };
        let Some((_, Sequence::Homing(homing))) = &self.sequence else { return };
        let at_second = homing.is_at_second_motor();
        let axis = if at_second { self.machine().second_motor(moved).unwrap_or(moved) } else { moved };
        let Some(input) = self.homing_input(axis, from_power_up) else { return };
        let is_square = at_second && self.machine().is_square(axis);
        let Some((_, Sequence::Homing(homing))) = &mut self.sequence else { return };
        let mut action = homing.tick(&input);
        if is_square && action.is_none() {
            action = homing.squared();
        }
        let status = homing.status();
        if status != HomingStatus::Running {
            self.machine_mut().limit_force(moved, None);
        }
        if matches!(status, HomingStatus::Failed(_)) {
            // Also a gantry that was not square yet stays as it is.
            self.machine_mut().lose_reference(moved);
        }
        if let Some(action) = action {
            self.do_homing_action(axis, action);
        }
    }

    /// What a homing sees of an axis in a tick.
    fn homing_input(&self, axis: usize, from_power_up: &[Reading; N]) -> Option<HomingInput> {
        let machine = self.machine();
        let axis_inputs = &self.inputs().axes;
        let edge = self.before(self.debounce.ticks_since_home(axis)).readings;
        let (input, reading, edge) = (axis_inputs.get(axis)?, from_power_up.get(axis)?, edge.get(axis)?);
        let origin = self.origins.get(axis)?;
        let at_force_limit = match machine.is_at_force_limit(axis, *self.forces.get(axis)?) {
            [true, _] => Some(Direction::Positive),
            [_, true] => Some(Direction::Negative),
            _ => None,
        };
        let mut limits = input.limits;
        let other = machine.other_motor(axis).and_then(|other| axis_inputs.get(other));
        if let Some(AxisInputs { limits: [below, above], .. }) = other {
            limits = [limits[0] | below, limits[1] | above];
        }
        Some(HomingInput {
            home: input.home,
            home_reading: edge.shifted(*origin),
            limits,
            reading: reading.shifted(*origin),
            command: *machine.command().get(axis)?,
            at_force_limit,
            motor_index: input.motor_index.map(|index| index + origin.motor),
            scale_index: input.scale_index.map(|index| index + origin.table),
            at_rest: machine.is_at_rest(),
            is_on: machine.power() == Power::On,
        })
    }

    /// Carries out an action of the homing of an axis.
    fn do_homing_action(&mut self, axis: usize, action: HomingAction) {
        let before = self.machine().command();
        match action {
            HomingAction::Halt => self.machine_mut().halt(),
            HomingAction::SetOrigin(shift) | HomingAction::Square(shift) => {
                if self.machine_mut().set_origin(axis, shift).is_ok() {
                    self.shift_origin(axis, before, shift);
                }
                if matches!(action, HomingAction::Square(_)) {
                    self.machine_mut().square(axis);
                }
            }
            HomingAction::GantryHomed => self.machine_mut().gantry_homed(axis),
        }
    }
}
