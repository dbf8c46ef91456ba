//! Feed-forward: command + (Kf/Kp)·d(command)/dt.
//!
//! With Kf = 100 % the position loop has nothing to do at constant speed; Kf below that leaves a
//! following error of (1 − Kf)·v/Kp. The derivative is the backward difference of the command,
//! exact in position units.
//!
//! # Example
//!
//! At 100 mm/s, Kf = 50 % and Kp = 33 /s the loop aims 0.5·(100 mm/s)/(33 /s) = 1.515 mm further.
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

/// Kf/Kp for a difference per tick.
#[derive(Clone, Copy, Debug)]
pub struct Feedforward<S: Scalar> {
    /// Error units per increment unit.
    pub gain: S::Gain,
}

/// The command of the tick before.
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

    /// At rest at a command that a correction (position units) stands on already.
    #[must_use]
    pub const fn corrected(self, correction: i64) -> Self {
        Self { last: Position(self.last.0.wrapping_add(correction)) }
    }
}

impl<S: Scalar> Feedforward<S> {
    /// How much further than the command the loop aims, in error units.
    pub fn lead(&self, state: &mut State, command: Position) -> S {
        let increment = S::from_increment(command - state.last);
        state.last = command;
        S::round(increment * self.gain)
    }
}
