//! Velocity feed-forward: the position loop follows command + (Kf/Kp)·d(command)/dt.
//!
//! At constant speed v the following error is (1 − Kf)·v/Kp: zero with Kf = 100 %. The derivative is the backward
//! difference of the command, exact in position units.
//!
//! # Example
//!
//! At 100 mm/s, Kf = 50 % and Kp = 33 /s the lead is 0.5·(100 mm/s)/(33 /s) = 1.515 mm.
//!
//! ```
//! use shared::config::{AxisConfig, AxisSettings, Rates};
//! use shared::control::feedforward::State;
//! use shared::units::{LENGTH_M, Position};
//!
//! let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
//! let settings =
//!     AxisSettings { position_gain_per_s: 33.0, feedforward_percent: 50.0, ..AxisSettings::default() };
//! let axis = AxisConfig::<f64>::new(&settings, rates).unwrap();
//! let mut state = State::at(Position(0));
//! let next = Position::from_m(0.1 / 20_000.0).unwrap();
//! let lead_m = axis.feedforward.lead(&mut state, next) * LENGTH_M;
//! assert!((lead_m - 0.5 * 0.1 / 33.0).abs() < 1e-12);
//! ```

use crate::scalar::Scalar;
use crate::units::Position;

/// Constants of the feed-forward.
#[derive(Clone, Copy, Debug)]
pub struct Feedforward<S: Scalar> {
    /// (Kf/Kp)/tick, error units per increment unit.
    pub gain: S::Gain,
}

/// The previous command.
#[derive(Clone, Copy, Debug)]
pub struct State {
    last: Position,
}

impl State {
    /// At rest at a command.
    #[must_use]
    pub const fn at(command: Position) -> Self {
        Self { last: command }
    }

    /// The same when a correction (position units) is already added to the command.
    #[must_use]
    pub const fn corrected(self, correction: i64) -> Self {
        Self { last: Position(self.last.0.wrapping_add(correction)) }
    }
}

impl<S: Scalar> Feedforward<S> {
    /// The lead (Kf/Kp)·d(command)/dt to add to the following error, error units.
    pub fn lead(&self, state: &mut State, command: Position) -> S {
        let increment = S::from_increment(command - state.last);
        state.last = command;
        S::round(increment * self.gain)
    }
}
