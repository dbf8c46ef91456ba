//! A force of a few tones, by which the host measures the frequency response of an axis at rest.

use super::HostedDrive;
use crate::excitation::{Excitation, ExcitationProblem};
use crate::link::refusal::Refusal;
use crate::link::report::Activity;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> HostedDrive<'_, S, N> {
    /// Starts a force, which the server has checked against the envelope; `force_n` is the sum of its amplitudes, N. It replaces one that acts.
    ///
    /// # Errors
    /// As [`HostedDrive::can_start`]; [`Refusal::NoSuchAxis`], [`Refusal::Excitation`] for a force above the limit of the axis and for a step drive.
    pub(in crate::link) fn start_excitation(
        &mut self,
        excitation: Excitation<S>,
        force_n: f64,
    ) -> Result<(), Refusal> {
        let axis = excitation.axis();
        let limit_n = self.machine().force_limit_n(axis).ok_or(Refusal::NoSuchAxis)?;
        if force_n > limit_n {
            return Err(Refusal::Excitation(ExcitationProblem::Force));
        }
        if !self.system.follows_force(axis) {
            return Err(Refusal::Excitation(ExcitationProblem::StepDrive));
        }
        if !self.is_exciting() {
            self.can_start()?;
        }
        self.end_excitation();
        (self.excitation, self.activity) = (Some(excitation), Activity::Response);
        Ok(())
    }

    /// Whether such a force acts.
    #[must_use]
    pub const fn is_exciting(&self) -> bool {
        self.excitation.is_some()
    }

    /// Ends the force. No effect if none acts.
    pub(super) fn end_excitation(&mut self) {
        if let Some(excitation) = self.excitation.take() {
            self.machine_mut().set_excitation(excitation.axis(), S::ZERO);
            self.activity = Activity::Idle;
        }
    }

    /// Sets the force of the next tick.
    pub(super) fn excite(&mut self) {
        if let Some(excitation) = &self.excitation {
            let (axis, force) = (excitation.axis(), excitation.force(self.tick));
            self.machine_mut().set_excitation(axis, force);
        }
    }
}
