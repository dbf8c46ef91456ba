//! Probing with an axis of the drive system: the course of [`crate::probing`] with the machine and its input.

use super::drive_system::DriveSystem;
use super::output::DriveOutput;
use super::sequence::Sequence;
use crate::feedback::Reading;
use crate::probing::{ProbeError, ProbeInput, ProbeSettings, ProbeStatus, Probing, Touch};
use crate::safety::Power;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize, O: DriveOutput<S>> DriveSystem<'_, S, N, O> {
    /// Starts to probe along an axis. [`DriveSystem::plan_leg`] has to be called until it has ended. Not part of a tick.
    ///
    /// # Errors
    /// [`ProbeError::NotReady`] unless the drives are on, the axes at rest and no homing or probing runs; [`ProbeError::Setting`];
    /// [`ProbeError::Active`] if the probe was touched in the last tick. Nothing is changed then.
    pub fn probe(&mut self, axis: usize, settings: &ProbeSettings) -> Result<(), ProbeError> {
        self.ready_for_sequence(axis).ok_or(ProbeError::NotReady)?;
        let probing = Probing::new(settings)?;
        if self.inputs().probe_touched {
            return Err(ProbeError::Active);
        }
        self.sequence = Some((axis, Sequence::Probing(probing)));
        Ok(())
    }

    /// Axis and state of the probing that runs or that ran last; `None` if a homing has run since.
    #[must_use]
    pub fn probe_status(&self) -> Option<(usize, ProbeStatus)> {
        match &self.sequence {
            Some((axis, Sequence::Probing(probing))) => Some((*axis, probing.status())),
            _ => None,
        }
    }

    /// The part of a probing in a tick, before the machine's.
    pub(super) fn probe_tick(&mut self) {
        if !matches!(self.probe_status(), Some((_, ProbeStatus::Running))) {
            return;
        }
        let (at_rest, is_on) = (self.machine().is_at_rest(), self.machine().power() == Power::On);
        let (touched, commands) = (self.inputs().probe_touched, self.machine().command());
        let edge = *self.before(self.debounce.ticks_since_touch(N));
        let Some((axis, Sequence::Probing(probing))) = &mut self.sequence else { return };
        let (Some(reading), Some(at_edge), Some(command), Some(origin)) = (
            edge.readings.get(*axis),
            edge.commands.get(*axis),
            commands.get(*axis),
            self.origins.get(*axis),
        ) else {
            return;
        };
        let Reading { motor, table } = reading.shifted(*origin);
        let touch = Touch { command: *at_edge, motor, table };
        if probing.tick(&ProbeInput { touched, touch, command: *command, at_rest, is_on }) {
            self.machine_mut().halt();
        }
    }
}
