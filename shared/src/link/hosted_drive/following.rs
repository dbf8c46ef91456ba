//! Axes that follow counters.

use super::HostedDrive;
use crate::interpolate::following::{FollowError, FollowSettings};
use crate::link::refusal::Refusal;
use crate::link::report::Activity;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> HostedDrive<'_, S, N> {
    /// Lets an axis follow a counter, with settings that the server has checked against those of the axis. Other axes may follow already.
    ///
    /// # Errors
    /// As [`HostedDrive::can_start`] unless axes follow already; [`Refusal::SecondMotor`], [`Refusal::Follow`].
    pub(in crate::link) fn follow(&mut self, axis: usize, settings: &FollowSettings) -> Result<(), Refusal> {
        self.has_own_command(axis)?;
        if !self.machine().follows() {
            self.can_start()?;
        }
        let input = self.system.inputs().axes.get(usize::from(settings.input));
        let count = input.and_then(|input| input.counter).ok_or(Refusal::Follow(FollowError::NoCounter))?;
        self.machine_mut().follow(axis, count, settings).map_err(Refusal::Follow)?;
        self.activity = Activity::Following;
        Ok(())
    }
}
