//! The pins of a drive, over the traits of `embedded-hal`: PWM and direction, step and direction, a converter.
//!
//! A change of direction is written before the pulse that it belongs to.

use embedded_hal::digital::{OutputPin, PinState};
use embedded_hal::pwm::SetDutyCycle;

use super::amplifier::Duty;
use super::step::Steps;

/// Passes a signal to a drive.
pub trait SignalPort<Signal> {
    /// Error of a pin.
    type Error;

    /// Passes on the signal of the next tick.
    ///
    /// # Errors
    /// That of a pin.
    fn set(&mut self, signal: Signal) -> Result<(), Self::Error>;
}

/// A PWM output and a direction pin. The direction is high for a negative force.
#[derive(Debug)]
pub struct PwmDirection<P, D> {
    /// PWM.
    pub pwm: P,
    /// Direction.
    pub direction: D,
}

/// An error of one of two pins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PinError<P, D> {
    /// Of the PWM output.
    Pwm(P),
    /// Of the direction pin.
    Direction(D),
}

impl<P: SetDutyCycle, D: OutputPin> PwmDirection<P, D> {
    fn write(&mut self, reverse: bool, counts: u16) -> Result<(), PinError<P::Error, D::Error>> {
        self.direction.set_state(PinState::from(reverse)).map_err(PinError::Direction)?;
        self.pwm.set_duty_cycle(counts).map_err(PinError::Pwm)
    }
}

impl<P: SetDutyCycle, D: OutputPin> SignalPort<Duty> for PwmDirection<P, D> {
    type Error = PinError<P::Error, D::Error>;

    fn set(&mut self, Duty { reverse, counts }: Duty) -> Result<(), Self::Error> {
        self.write(reverse, counts.min(self.pwm.max_duty_cycle()))
    }
}

/// One step is a pulse of half a PWM period: at most one step per period. More of them are an error of the caller's settings, and
/// are cut to one.
impl<P: SetDutyCycle, D: OutputPin> SignalPort<Steps> for PwmDirection<P, D> {
    type Error = PinError<P::Error, D::Error>;

    fn set(&mut self, Steps { reverse, count }: Steps) -> Result<(), Self::Error> {
        let half = self.pwm.max_duty_cycle() / 2;
        self.write(reverse, if count > 0 { half } else { 0 })
    }
}

/// A digital-to-analogue converter. `embedded-hal` has no trait for one.
pub trait Dac {
    /// Error of the converter.
    type Error;

    /// Sets the output in counts.
    ///
    /// # Errors
    /// That of the converter.
    fn set_counts(&mut self, counts: u16) -> Result<(), Self::Error>;
}

impl<C: Dac> SignalPort<u16> for C {
    type Error = C::Error;

    fn set(&mut self, counts: u16) -> Result<(), Self::Error> {
        self.set_counts(counts)
    }
}
