//! Probing along an axis.

use super::HostedDrive;
use crate::link::refusal::Refusal;
use crate::link::report::Activity;
use crate::probing::ProbeSettings;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> HostedDrive<'_, S, N> {
    /// Starts to probe along an axis, with settings that the server has checked against those of the axis.
    ///
    /// # Errors
    /// As [`HostedDrive::can_start`]; [`Refusal::SecondMotor`], [`Refusal::Probe`].
    pub(in crate::link) fn probe(&mut self, axis: usize, settings: &ProbeSettings) -> Result<(), Refusal> {
        self.has_own_command(axis)?;
        self.can_start()?;
        self.system.probe(axis, settings).map_err(Refusal::Probe)?;
        self.activity = Activity::Probing;
        // Its speed is that of the declared uncertainty.
        self.permit_override(100);
        Ok(())
    }
}
