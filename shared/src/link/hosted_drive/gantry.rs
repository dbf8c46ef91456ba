//! The motors of a gantry: the second one has no command of its own, and both are homed together.

use super::HostedDrive;
use crate::homing::HomingSettings;
use crate::link::refusal::Refusal;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> HostedDrive<'_, S, N> {
    /// Whether an axis has a command of its own.
    ///
    /// # Errors
    /// [`Refusal::SecondMotor`].
    pub fn has_own_command(&self, axis: usize) -> Result<(), Refusal> {
        let number = |axis| u8::try_from(axis).unwrap_or(u8::MAX);
        match self.machine().first_motor(axis) {
            Some(first) => Err(Refusal::SecondMotor { axis: number(axis), first: number(first) }),
            None => Ok(()),
        }
    }

    /// Starts to home both motors of a gantry, with the offset of the reference of the second, m.
    ///
    /// # Errors
    /// As [`HostedDrive::home`].
    pub(in crate::link) fn home_gantry(
        &mut self,
        first: usize,
        settings: [&HomingSettings; 2],
        offset_m: f64,
    ) -> Result<(), Refusal> {
        self.can_start()?;
        let started = self.system.home_gantry(first, settings, offset_m);
        self.homing_started(started)
    }
}
