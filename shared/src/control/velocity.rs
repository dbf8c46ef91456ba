//! The velocity loop: force = Kv·(ev + ∫ev dt/Ti), on the differenced motor reading.
//!
//! The integral is the sum of ev·T up to and including this tick (backward rule), held unrounded. It
//! stands still while the force is at its limit and ev would drive it further (anti-windup).

use crate::scalar::Scalar;
use crate::units::Position;

/// Constants of the loop.
#[derive(Clone, Copy, Debug)]
pub struct VelocityControl<S: Scalar> {
    /// Velocity units per increment unit: the tick rate.
    pub rate: S::Gain,
    /// Weight of the increment before this one: 0 for a plain difference, ½ for the difference of
    /// two-sample means.
    pub lag: S::Gain,
    /// Kv, force units per velocity unit.
    pub proportional: S::Gain,
    /// Kv·T/Ti, force units per velocity unit; zero without an integral part.
    pub integral: S::Gain,
    /// Greatest force either way.
    pub force_limit: S,
}

/// What the loop remembers.
#[derive(Clone, Copy, Debug)]
pub struct State<S: Scalar> {
    last: Position,
    last_increment: S,
    integral: S::Sum,
}

impl<S: Scalar> State<S> {
    /// At rest at a motor reading.
    #[must_use]
    pub fn at(motor: Position) -> Self {
        Self { last: motor, last_increment: S::default(), integral: S::Sum::default() }
    }

    /// What the motor has moved in the last tick, increment units.
    #[must_use]
    pub const fn increment(&self) -> S {
        self.last_increment
    }
}

impl<S: Scalar> VelocityControl<S> {
    /// Force for a velocity command and a motor reading.
    pub fn force(&self, state: &mut State<S>, command: S, motor: Position) -> S {
        let increment = S::from_increment(motor.beyond(state.last));
        let late = S::round(state.last_increment.minus(increment).times(self.lag));
        state.last = motor;
        state.last_increment = increment;
        let velocity = S::round(increment.plus(late).times(self.rate));

        let error = command.minus(velocity);
        let integral = state.integral + error.times(self.integral);
        let wanted = S::round(error.times(self.proportional) + integral);
        let force = wanted.within(self.force_limit);
        let zero = S::default();
        let winds_up = force != wanted && (error > zero) == (wanted > zero);
        if !winds_up {
            state.integral = integral;
        }
        force
    }
}
