//! The velocity loop: force = Kv·(ev + ∫ev dt/Ti), on the differenced motor reading.
//!
//! The integral is the sum of ev·T up to and including this tick (backward rule), held unrounded. What is made
//! of the force behind the loop (filters, compensation, the limit) decides whether the tick's integral is
//! kept: it is not while the force is at its limit and ev would drive it further (anti-windup).
//!
//! # Example
//!
//! 10 mm/s asked of a motor that stands, Kv = 50,000 N·s/m, Ti = 20 ms: 500 N, and each tick of 50 µs adds
//! 500 N·50 µs/20 ms = 1.25 N.
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

use crate::scalar::Scalar;
use crate::units::Position;

/// Constants of the loop.
#[derive(Clone, Copy, Debug)]
pub struct VelocityControl<S: Scalar> {
    /// Velocity units per increment unit: the tick rate, less what goes to the increment before.
    pub rate: S::Gain,
    /// The same of the increment before this one: 0 for a plain difference, half of the rate for the
    /// difference of two-sample means.
    pub rate_before: S::Gain,
    /// Kv, force units per velocity unit.
    pub proportional: S::Gain,
    /// Kv·T/Ti, force units per velocity unit; zero without an integral part.
    pub integral: S::Gain,
    /// Whether it has one.
    pub integrates: bool,
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

/// What the loop wants, before filters and limit.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<S: Scalar> {
    /// The force.
    pub force: S,
    error: S,
    integral: S::Sum,
}

impl<S: Scalar> State<S> {
    /// At rest at a motor reading.
    #[must_use]
    pub const fn at(motor: Position) -> Self {
        Self { last: motor, last_increment: S::ZERO, integral: S::ZERO_SUM }
    }

    /// What the motor has moved in the last tick, increment units.
    #[must_use]
    pub const fn increment(&self) -> S {
        self.last_increment
    }

    /// Forgets the integral: the loop goes on without one.
    pub fn forget_integral(&mut self) {
        self.integral = S::Sum::default();
    }
}

impl<S: Scalar> VelocityControl<S> {
    /// The force for a velocity command and a motor reading.
    pub fn wanted(&self, state: &mut State<S>, command: S, motor: Position) -> Wanted<S> {
        let increment = S::from_increment(motor - state.last);
        let velocity = S::round(increment * self.rate + state.last_increment * self.rate_before);
        state.last = motor;
        state.last_increment = increment;
        let error = command - velocity;
        let integral = state.integral + error * self.integral;
        Wanted { force: S::round(error * self.proportional + integral), error, integral }
    }

    /// The force within its limit, and whether it is at it. Keeps the integral unless that would wind up.
    pub fn limited(&self, state: &mut State<S>, wanted: &Wanted<S>, shaped: S) -> (S, bool) {
        let force = shaped.clamp_magnitude(self.force_limit);
        let zero = S::default();
        let limited = force != shaped;
        if !(limited && (wanted.error > zero) == (shaped > zero)) {
            state.integral = wanted.integral;
        }
        (force, limited)
    }

    /// Whether the loop has no integral part.
    #[must_use]
    pub const fn has_no_integral(&self) -> bool {
        !self.integrates
    }

    /// Both at once: a loop with nothing behind it.
    pub fn force(&self, state: &mut State<S>, command: S, motor: Position) -> S {
        let wanted = self.wanted(state, command, motor);
        self.limited(state, &wanted, wanted.force).0
    }
}
