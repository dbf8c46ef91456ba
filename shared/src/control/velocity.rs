//! The velocity loop: force = Kv·(ev + ∫ev dt/Ti), with ev = velocity command − velocity of the motor. That is the difference of its
//! readings, or an [`observer`] of it.
//!
//! The integral is the sum of ev·T up to and including the present tick (backward Euler), not rounded.
//!
//! Anti-windup by conditional integration: [`VelocityControl::pi_output`] computes the new integral, and
//! [`VelocityControl::limit`], which gets the force after filters and compensation, stores it. If the force is at its
//! limit and ev has the sign of the force, the previous integral is kept instead.
//!
//! # Example
//!
//! A command of 10 mm/s to a motor at standstill, Kv = 50,000 N·s/m, Ti = 20 ms: the proportional part is 500 N, and each
//! tick of 50 µs adds 500 N·50 µs/20 ms = 1.25 N.
//!
//! ```
//! use shared::config::{AxisConfig, AxisSettings, Rates};
//! use shared::control::velocity::State;
//! use shared::units::{Position, VELOCITY_M_PER_S};
//!
//! let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
//! let settings = AxisSettings {
//!     velocity_gain_n_s_per_m: 50_000.0,
//!     velocity_integral_time_s: Some(0.02),
//!     ..AxisSettings::default()
//! };
//! let axis = AxisConfig::<f64>::new(&settings, rates).unwrap();
//! let mut state = State::at(Position(0));
//! for tick in 1..=10 {
//!     let force_n = axis.velocity.force(&mut state, 10e-3 / VELOCITY_M_PER_S, Position(0));
//!     assert!((force_n - (500.0 + 1.25 * f64::from(tick))).abs() < 1e-9);
//! }
//! ```

use super::observer::{self, Observer};
use crate::scalar::Scalar;
use crate::units::Position;

/// Constants of the velocity loop.
#[derive(Clone, Copy, Debug)]
pub struct VelocityControl<S: Scalar> {
    /// Factor of the present increment, velocity units per increment unit: tick rate − `previous_rate`.
    pub rate: S::Gain,
    /// Factor of the previous increment: 0 for a plain difference, half the tick rate for the difference of
    /// two-sample means.
    pub previous_rate: S::Gain,
    /// Kv, force units per velocity unit.
    pub proportional: S::Gain,
    /// Kv·T/Ti, force units per velocity unit; zero without an integral part.
    pub integral: S::Gain,
    /// Whether there is an integral part.
    pub has_integral: bool,
    /// Limit of the force in both directions.
    pub force_limit: S,
    /// Observer of the velocity; `None`: the velocity is the difference.
    pub observer: Option<Observer<S>>,
}

/// State of the velocity loop.
#[derive(Clone, Copy, Debug)]
pub struct State<S: Scalar> {
    last: Position,
    last_increment: S,
    integral: S::Sum,
    /// Not used without an observer.
    observer: observer::State<S>,
}

/// Output of the PI law, before filters and force limit.
#[derive(Clone, Copy, Debug)]
pub struct PiOutput<S: Scalar> {
    /// Force, N.
    pub force: S,
    error: S,
    integral: S::Sum,
}

impl<S: Scalar> State<S> {
    /// At rest at a motor reading.
    #[must_use]
    pub const fn at(motor: Position) -> Self {
        Self {
            last: motor,
            last_increment: S::ZERO,
            integral: S::ZERO_SUM,
            observer: observer::State::AT_REST,
        }
    }

    /// The loop with an observer settled at a velocity, velocity units.
    #[must_use]
    pub fn observing(self, velocity: S) -> Self {
        Self { observer: observer::State::at(velocity), ..self }
    }

    /// The loop after the motor reading has been shifted by a distance, position units.
    #[must_use]
    pub fn shifted(self, motor: i64) -> Self {
        Self { last: self.last + motor, ..self }
    }

    /// Motion of the motor in the last tick, increment units.
    #[must_use]
    pub const fn increment(&self) -> S {
        self.last_increment
    }

    /// Sets the integral to a force, N. Without an integral part it stays as a constant.
    pub fn preload(&mut self, force: S) {
        self.integral = force.widen();
    }

    /// Sets the integral to zero, for a loop without an integral part.
    pub fn reset_integral(&mut self) {
        self.integral = S::Sum::default();
    }
}

impl<S: Scalar> VelocityControl<S> {
    /// The PI law for a velocity command (velocity units) and a motor reading.
    pub fn pi_output(&self, state: &mut State<S>, command: S, motor: Position) -> PiOutput<S> {
        let Some(observer) = &self.observer else { return self.pi_by_difference(state, command, motor) };
        let distance = motor - state.last;
        let difference = self.difference(state, motor);
        // What the increment leaves of the distance is part of the next one.
        state.last = motor - S::increment_rounding(distance);
        let velocity = observer.step(&mut state.observer, difference);
        self.pi(state, command - velocity)
    }

    /// [`VelocityControl::pi_output`] of a loop without an observer: a tick that knows this does not test for one.
    pub fn pi_by_difference(&self, state: &mut State<S>, command: S, motor: Position) -> PiOutput<S> {
        let velocity = S::round(self.difference(state, motor));
        self.pi(state, command - velocity)
    }

    /// The velocity by the difference of the readings, not rounded.
    fn difference(&self, state: &mut State<S>, motor: Position) -> S::Sum {
        let increment = S::from_increment(motor - state.last);
        let difference = increment * self.rate + state.last_increment * self.previous_rate;
        state.last = motor;
        state.last_increment = increment;
        difference
    }

    fn pi(&self, state: &State<S>, error: S) -> PiOutput<S> {
        let integral = state.integral + error * self.integral;
        PiOutput { force: S::round(error * self.proportional + integral), error, integral }
    }

    /// The velocity of the last difference, velocity units.
    #[must_use]
    pub fn last_difference(&self, state: &State<S>) -> S {
        let increment = state.last_increment;
        S::round(increment * self.rate + increment * self.previous_rate)
    }

    /// Limits the force after filters and compensation; also returns whether the limit is active. Stores the new integral,
    /// except if the limit is active and the velocity error has the sign of the force (anti-windup).
    pub fn limit(&self, state: &mut State<S>, pi: &PiOutput<S>, unlimited: S) -> (S, bool) {
        // The usual case.
        if !unlimited.exceeds(self.force_limit) {
            state.integral = pi.integral;
            return (unlimited, false);
        }
        let force = unlimited.clamp_magnitude(self.force_limit);
        let zero = S::default();
        let limited = force != unlimited;
        if !(limited && (pi.error > zero) == (unlimited > zero)) {
            state.integral = pi.integral;
        }
        (force, limited)
    }

    /// Both steps, for a loop without filters and compensation.
    pub fn force(&self, state: &mut State<S>, command: S, motor: Position) -> S {
        let pi = self.pi_output(state, command, motor);
        self.limit(state, &pi, pi.force).0
    }
}
