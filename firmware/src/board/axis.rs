//! One axis on its timers: a quadrature counter in, a PWM and a direction pin out.

use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;
use shared::drive::Duty;
use shared::feedback::encoder::Encoder;
use shared::units::Position;
use stm32f4xx_hal::hal_02::Qei;

/// An axis.
pub struct Axis<Counter, Pwm, Direction> {
    /// Makes a position of the counter.
    pub encoder: Encoder,
    /// Timer in encoder mode.
    pub counter: Counter,
    /// Magnitude of the force.
    pub pwm: Pwm,
    /// High for a negative force.
    pub direction: Direction,
}

impl<Counter, Pwm, Direction> Axis<Counter, Pwm, Direction>
where
    Counter: Qei<Count = u16>,
    Pwm: SetDutyCycle,
    Direction: OutputPin,
{
    /// Where the motor is.
    pub fn position(&mut self) -> Position {
        self.encoder.read(self.counter.count())
    }

    /// Sets pin and PWM. They cannot fail on this chip: the error type is `Infallible`.
    ///
    /// The pin changes at once and the PWM with its next period, 50 µs later at most; a force that
    /// changes its sign passes through small duties.
    pub fn set(&mut self, duty: Duty) {
        let _ = self.direction.set_state(duty.reverse.into());
        let _ = self.pwm.set_duty_cycle(duty.counts);
    }
}
