//! The commanded motion of an axis, which corrections depend on.

use crate::scalar::Scalar;
use crate::units::{PER_NM, Position};

/// The commanded motion of one axis at a position tick.
#[derive(Clone, Copy, Debug)]
pub struct CommandMotion<S: Scalar> {
    /// Command.
    pub position: Position,
    /// Change of the command per tick, increment units.
    pub increment: S,
    /// Change of the increment per tick, increment units.
    pub acceleration: S,
    /// Whether the last direction of travel was positive. A command at rest, or one that moves back by less than
    /// [`REVERSAL_NM`], has not reversed.
    pub forward: bool,
    /// Whether the direction reversed in this tick.
    pub reversed: bool,
    /// The extreme command in the present direction.
    extreme: Position,
}

/// Distance that a command has to move back to count as reversed, nm.
pub const REVERSAL_NM: i64 = 10;

impl<S: Scalar> CommandMotion<S> {
    /// At rest.
    #[must_use]
    pub const fn at(position: Position) -> Self {
        Self {
            position,
            increment: S::ZERO,
            acceleration: S::ZERO,
            forward: true,
            reversed: false,
            extreme: position,
        }
    }

    /// This motion from a shifted origin.
    #[must_use]
    pub(super) fn shifted(self, command: i64) -> Self {
        Self { position: self.position + command, extreme: self.extreme + command, ..self }
    }

    /// Updates the motion with the next command.
    pub fn step(&mut self, position: Position) {
        let increment = S::from_increment(position - self.position);
        self.acceleration = increment - self.increment;
        (self.position, self.increment) = (position, increment);
        let from_extreme = position - self.extreme;
        self.reversed = false;
        if (from_extreme >= 0) == self.forward {
            self.extreme = position;
        } else if from_extreme.unsigned_abs() > (REVERSAL_NM * PER_NM).unsigned_abs() {
            (self.forward, self.reversed, self.extreme) = (!self.forward, true, position);
        }
    }
}
