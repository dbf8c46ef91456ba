//! The direction check of a drive system: the force of [`DirectionCheck`] instead of the machine's.

use super::board::Board;
use super::direction_check::{DirectionCheck, DirectionCheckError, DirectionCheckSettings, DirectionResult};
use super::drive_system::{DirectionCheckRun, DriveSystem};
use super::enable_switch::SwitchEvent;
use super::output::DriveOutput;
use crate::feedback::Reading;
use crate::machine::Output;
use crate::safety::Power;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize, O: DriveOutput<S>> DriveSystem<'_, S, N, O> {
    /// Prepares a direction check of an axis. It starts when the enable switch is next closed (after it was open), which does
    /// not close the loops then; opening the switch ends it. Not part of a tick.
    ///
    /// # Errors
    /// [`DirectionCheckError::NotReady`] unless the drives are off without a fault and no check, homing or probing runs,
    /// [`DirectionCheckError::StepDrive`], [`DirectionCheckError::Brake`], [`DirectionCheckError::Gantry`], [`DirectionCheckError::Setting`].
    /// Nothing is changed then.
    pub fn check_direction(
        &mut self,
        axis: usize,
        settings: &DirectionCheckSettings,
    ) -> Result<(), DirectionCheckError> {
        let rates = self.machine().rates().filter(|_| axis < N).ok_or(DirectionCheckError::NotReady)?;
        if self.machine().power() != Power::Off || self.runs_sequence() || self.is_checking() {
            return Err(DirectionCheckError::NotReady);
        }
        if !self.follows_force(axis) {
            return Err(DirectionCheckError::StepDrive);
        }
        if self.machine().has_brake(axis) {
            return Err(DirectionCheckError::Brake);
        }
        if self.machine().other_motor(axis).is_some() {
            return Err(DirectionCheckError::Gantry);
        }
        let limit_n = self.machine().force_limit_n(axis).unwrap_or(0.0);
        if !(settings.force_n > 0.0 && settings.force_n <= limit_n) {
            return Err(DirectionCheckError::Setting("force_n"));
        }
        let check = DirectionCheck::new(axis, settings, rates.velocity_loop_hz)?;
        // After the check a host needs a new edge of the switch.
        self.disarm();
        self.direction_check_run = Some(DirectionCheckRun { check, force: S::signal(settings.force_n) });
        Ok(())
    }

    /// The axis of the direction check that runs or that ran last, and its result once it has ended.
    #[must_use]
    pub fn direction_check(&self) -> Option<(usize, Option<DirectionResult>)> {
        self.direction_check_run.as_ref().map(|run| (run.check.axis(), run.check.result()))
    }

    /// Whether a direction check waits for the enable switch or pushes. The loops stay open.
    #[must_use]
    pub fn is_checking(&self) -> bool {
        self.direction_check_run.as_ref().is_some_and(|run| run.check.result().is_none())
    }

    /// Ends a direction check. No effect if none runs.
    pub fn stop_direction_check(&mut self) {
        if let Some(run) = &mut self.direction_check_run {
            run.check.abort();
        }
    }

    /// Ends a direction check whose host is gone. No effect if none runs.
    pub fn expire_direction_check(&mut self) {
        if let Some(run) = &mut self.direction_check_run {
            run.check.expire();
        }
    }

    /// A tick of a direction check instead of one of the machine, which stays off and follows the axes.
    pub(super) fn check_tick(
        &mut self,
        board: &mut impl Board<N, O::Signal>,
        event: Option<SwitchEvent>,
        readings: &[Reading; N],
    ) -> Output<S, N> {
        // Withdraws an enable by a host, too.
        self.machine_mut().disable();
        let output = self.machine_mut().tick(readings);
        let hardware_stop = board.hardware_stop_active();
        let has_fault = self.has_input_fault() || hardware_stop || self.tick_watch.is_exceeded();
        let Some(DirectionCheckRun { check, force }) = &mut self.direction_check_run else { return output };
        match event {
            Some(SwitchEvent::Enable) => check.start(readings),
            Some(SwitchEvent::Disable) if check.is_pushing() => check.abort(),
            Some(SwitchEvent::Disable) | None => {}
        }
        if has_fault && check.is_pushing() {
            check.abort();
        }
        check.tick(readings);
        let mut forces = [S::ZERO; N];
        if let Some(axis) = forces.get_mut(check.axis()) {
            *axis = *force;
        }
        let pushing = check.is_pushing();
        self.pass_on(board, pushing.then_some(&forces));
        // One that waits has no force that could be late.
        if pushing {
            self.tick_watch.ended(board.next_tick_due());
            if self.tick_watch.is_exceeded() {
                self.stop_direction_check();
                self.pass_on(board, None);
            }
        }
        output
    }

    /// Whether an input forbids to push the axis of the check.
    fn has_input_fault(&self) -> bool {
        let inputs = self.inputs();
        // Without any wait: its force has no loop, and with dead sensors the switch alone ends it.
        let limits =
            self.direction_check_run.as_ref().and_then(|run| self.limit_samples.get(run.check.axis()));
        let at_limit = limits.is_some_and(|limits| *limits != [false; 2]);
        let on_axis = inputs.axes.iter().any(|axis| axis.drive_fault || axis.bad_encoder_signal);
        inputs.emergency_stop || on_axis || at_limit || self.supply_fault().is_some()
    }
}
