//! Feed-forward: command + (Kf/Kp)·d(command)/dt.
//!
//! With Kf = 100 % the position loop has nothing to do at constant speed; Kf below that leaves a
//! following error of (1 − Kf)·v/Kp. The derivative is the backward difference of the command,
//! exact in position units.

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
        Self { last: self.last.moved(correction) }
    }
}

impl<S: Scalar> Feedforward<S> {
    /// How much further than the command the loop aims, in error units.
    pub fn lead(&self, state: &mut State, command: Position) -> S {
        let increment = S::from_increment(command.beyond(state.last));
        state.last = command;
        S::round(increment.times(self.gain))
    }
}
