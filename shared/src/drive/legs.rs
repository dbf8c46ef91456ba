//! The motions of a homing or a probing: they are planned when the one before has ended.

use super::drive_system::DriveSystem;
use super::output::DriveOutput;
use crate::interpolate::{Block, PathError};
use crate::safety::Power;
use crate::scalar::Scalar;
use crate::units::Position;

impl<S: Scalar, const N: usize, O: DriveOutput<S>> DriveSystem<'_, S, N, O> {
    /// The tick rate, Hz, if a homing or a probing of an axis may start: the drives are on, the axes at rest, and neither runs.
    pub(super) fn ready_for_sequence(&self, axis: usize) -> Option<f64> {
        let rates = self.machine().rates().filter(|_| axis < N)?;
        let is_ready = !self.runs_sequence()
            && !self.is_checking()
            && self.machine().power() == Power::On
            && self.machine().is_at_rest();
        is_ready.then_some(rates.velocity_loop_hz)
    }

    /// Whether a homing or a probing runs.
    #[must_use]
    pub fn runs_sequence(&self) -> bool {
        self.sequence.as_ref().is_some_and(|(_, sequence)| sequence.is_running())
    }

    /// Stops a homing or a probing; the axis decelerates to rest. No effect if none runs.
    pub fn stop_sequence(&mut self) {
        if let Some(axis) = self.homing_axis() {
            // Also a gantry that was not square yet stays as it is.
            self.machine_mut().lose_reference(axis);
        }
        if let Some((axis, sequence)) = self.sequence.as_mut().filter(|(_, sequence)| sequence.is_running()) {
            sequence.stop();
            let axis = *axis;
            self.machine_mut().limit_force(axis, None);
            self.machine_mut().halt();
        }
    }

    /// Plans the motion that a homing or a probing waits for. To be called regularly, not in a tick: planning takes longer than one.
    pub fn plan_leg(&mut self) {
        if let Some(leg) = self.leg() {
            let planned = self.machine_mut().jog(&leg);
            self.leg_planned(planned);
        }
    }

    /// The motion that a homing or a probing waits for, to be planned elsewhere; [`DriveSystem::leg_planned`] has to follow.
    #[must_use]
    pub fn leg(&self) -> Option<Block<N>> {
        let (axis, sequence) = self.sequence.as_ref()?;
        let leg = sequence.leg_to_plan()?;
        let mut to_m = self.machine().command().map(Position::to_m);
        if let Some(to_m) = to_m.get_mut(*axis) {
            *to_m += leg.distance_m;
        }
        Some(Block::line(to_m, leg.speed_m_per_s, leg.acceleration_m_per_s2))
    }

    /// The motion of [`DriveSystem::leg`] was appended to the path, or rejected by it.
    pub fn leg_planned(&mut self, planned: Result<(), PathError>) {
        if let Some((axis, sequence)) = &mut self.sequence {
            sequence.leg_planned(planned);
            let axis = *axis;
            if !self.runs_sequence() {
                self.machine_mut().limit_force(axis, None);
            }
        }
    }
}
