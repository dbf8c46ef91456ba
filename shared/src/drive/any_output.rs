//! A drive output that is chosen by a table of the board.

use super::amplifier::{Amplifier, DriveError, Duty};
use super::analog::{AnalogOutput, AnalogSettings};
use super::output::{Demand, DriveOutput};
use super::step::{StepOutput, Steps};
use crate::scalar::Scalar;

/// The drive of an axis, as a table declares it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveSettings {
    /// A torque drive with PWM and direction: force at full duty, N, negative for reversed wiring.
    Pwm {
        /// Force at full duty, N.
        full_duty_n: f64,
    },
    /// A torque drive with a ±10 V input.
    Analog(AnalogSettings),
    /// A drive with step and direction inputs, which closes its own loops.
    Steps {
        /// Travel per step, m; negative for the other direction.
        step_m: f64,
    },
}

/// The input of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveSignal {
    /// PWM and direction.
    Pwm(Duty),
    /// Counts of a converter.
    Analog(u16),
    /// Steps and direction.
    Steps(Steps),
}

/// An output of any kind.
#[derive(Clone, Copy, Debug)]
pub enum AnyOutput<S: Scalar> {
    /// PWM and direction.
    Pwm(Amplifier<S>),
    /// ±10 V.
    Analog(AnalogOutput<S>),
    /// Step and direction.
    Steps(StepOutput),
}

impl<S: Scalar> AnyOutput<S> {
    /// The output for a drive, on a board with `full_counts` PWM counts and at most `max_steps` steps per tick.
    ///
    /// # Errors
    /// [`DriveError`] for the value that is rejected.
    pub fn new(settings: &DriveSettings, full_counts: u16, max_steps: u8) -> Result<Self, DriveError> {
        match settings {
            DriveSettings::Pwm { full_duty_n } => Amplifier::new(*full_duty_n, full_counts).map(Self::Pwm),
            DriveSettings::Analog(settings) => AnalogOutput::new(settings).map(Self::Analog),
            DriveSettings::Steps { step_m } => StepOutput::new(*step_m, max_steps).map(Self::Steps),
        }
    }
}

impl<S: Scalar> DriveOutput<S> for AnyOutput<S> {
    type Signal = DriveSignal;

    fn follows_force(&self) -> bool {
        !matches!(self, Self::Steps(_))
    }

    fn signal(&mut self, demand: &Demand<S>) -> DriveSignal {
        match self {
            Self::Pwm(output) => DriveSignal::Pwm(output.signal(demand)),
            Self::Analog(output) => DriveSignal::Analog(output.signal(demand)),
            Self::Steps(output) => DriveSignal::Steps(output.signal(demand)),
        }
    }

    fn off(&mut self) -> DriveSignal {
        match self {
            Self::Pwm(output) => DriveSignal::Pwm(DriveOutput::<S>::off(output)),
            Self::Analog(output) => DriveSignal::Analog(output.off()),
            Self::Steps(output) => DriveSignal::Steps(DriveOutput::<S>::off(output)),
        }
    }
}
