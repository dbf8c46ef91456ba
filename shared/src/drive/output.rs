//! What a drive gets: one trait for power stages with PWM and direction, analogue torque drives, and step drives.
//!
//! | output | the drive | signal |
//! |---|---|---|
//! | [`Amplifier`] | controls its current in proportion to the duty | [`Duty`] |
//! | [`AnalogOutput`](super::analog::AnalogOutput) | controls its torque in proportion to ±10 V | counts of a converter |
//! | [`StepOutput`](super::step::StepOutput) | closes all loops itself and moves by steps | [`Steps`](super::step::Steps) |
//!
//! The first two need a **torque drive**: the controller computes a force, and the drive has to produce a force in proportion to its
//! input. Commutation and current control (FOC) are the drive's. With a step drive the loops of the controller have no effect on
//! the axis; interpolation, compensation of the command, limits and stops have.

use super::amplifier::{Amplifier, Duty};
use crate::scalar::Scalar;
use crate::units::Position;

/// What an axis demands of its drive until the next tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand<S> {
    /// Force, N.
    pub force: S,
    /// Position command with its corrections, from the position at power-up.
    pub command: Position,
}

/// The conversion of a demand to the input of a drive.
pub trait DriveOutput<S: Scalar> {
    /// The input of the drive.
    type Signal: Copy;

    /// Whether the drive produces the force of a demand. A step drive follows the command instead.
    fn follows_force(&self) -> bool {
        true
    }

    /// The input for a demand, once per tick while the drives are on.
    fn signal(&mut self, demand: &Demand<S>) -> Self::Signal;

    /// The input without force or motion, once per tick while the drives are off.
    fn off(&mut self) -> Self::Signal;
}

impl<S: Scalar> DriveOutput<S> for Amplifier<S> {
    type Signal = Duty;

    fn signal(&mut self, demand: &Demand<S>) -> Duty {
        self.duty(demand.force)
    }

    fn off(&mut self) -> Duty {
        Duty::default()
    }
}
