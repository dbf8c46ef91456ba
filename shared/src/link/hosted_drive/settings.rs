//! Changes of settings with the drives off.

use super::HostedDrive;
use crate::link::refusal::Refusal;
use crate::machine::{Machine, MachineConfig, Reference};
use crate::safety::{Fault, Power};
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> HostedDrive<'_, S, N> {
    /// Replaces the settings, at the present positions of the motors. For the server alone, which has admitted them
    /// ([`Envelope`](crate::link::Envelope)).
    ///
    /// # Errors
    /// [`Refusal::DrivesOn`], [`Refusal::Faulted`].
    pub(in crate::link) fn configure(&mut self, config: MachineConfig<S, N>) -> Result<(), Refusal> {
        self.is_off()?;
        let start = self.readings.map(|reading| reading.motor);
        // Those of the motors of a gantry are lost: they depend on the settings.
        let is_homed = |machine: &Machine<S, N>, axis| {
            machine.reference(axis) == Some(Reference::Homed) && machine.other_motor(axis).is_none()
        };
        let were_homed: [_; N] = core::array::from_fn(|axis| is_homed(self.machine(), axis));
        self.machine_mut().configure(config, &start);
        for (axis, was_homed) in were_homed.into_iter().enumerate() {
            if !was_homed || !is_homed(self.machine(), axis) {
                self.machine_mut().lose_reference(axis);
            }
        }
        self.machine_mut().set_skew_zero();
        Ok(())
    }

    /// Whether the drives are off without a fault.
    ///
    /// # Errors
    /// [`Refusal::DrivesOn`], [`Refusal::Faulted`].
    pub const fn is_off(&self) -> Result<(), Refusal> {
        match self.machine().power() {
            Power::Off => Ok(()),
            Power::Faulted(fault) => Err(Refusal::Faulted(fault)),
            Power::On | Power::Stopping(_) | Power::Enabling | Power::Disabling(_) => Err(Refusal::DrivesOn),
        }
    }

    /// Before an access to the flash that holds the program, which may stop the program: the power stages have to be off. What follows
    /// holds off no tick; on a chip that can execute its program meanwhile the ticks continue.
    ///
    /// # Errors
    /// Refusals of [`HostedDrive::is_off`]; [`Refusal::DrivesOn`] until a tick has switched the power stages off;
    /// [`Refusal::Moving`] while a direction check waits for the enable switch or pushes an axis.
    pub fn begin_flash_access(&mut self) -> Result<(), Refusal> {
        self.is_off()?;
        if self.system.is_checking() {
            return Err(Refusal::Moving);
        }
        if self.system.are_stages_enabled() {
            return Err(Refusal::DrivesOn);
        }
        // One that waits for the next tick: the drives stay off.
        self.machine_mut().disable();
        Ok(())
    }

    /// After the access. Positions of counters that wrap may be lost meanwhile: every axis loses its reference.
    pub fn end_flash_access(&mut self) {
        (0..N).for_each(|axis| self.machine_mut().lose_reference(axis));
    }

    /// Reports a fault that was found at the start, drives off: it has to be acknowledged before an enable. A second one is only
    /// recorded.
    pub fn inhibit_enable(&mut self, fault: Fault) {
        if let Power::Faulted(_) = self.machine().power() {
            self.history.fault(self.tick, fault);
        }
        self.machine_mut().inhibit_enable(fault);
    }
}
