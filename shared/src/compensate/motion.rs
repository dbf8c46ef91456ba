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

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of 16 nm are increments of 1. A way of 10 nm back from the furthest point is no reversal, and a unit more is one, in either
    /// direction; the next is counted from there.
    #[test]
    fn a_reversal_is_a_way_back_of_more_than_ten_nanometres() {
        let step = 16 * PER_NM;
        let mut motion = CommandMotion::<f64>::at(Position(100));
        let way = 10 * PER_NM;
        for (to, forward, reversed) in [
            (step, true, false),
            (step - way, true, false),
            (step - way - 1, false, true),
            (-step, false, false),
            (way - step, false, false),
            (way - step + 1, true, true),
            (step, true, false),
        ] {
            let (from, increment) = (motion.position, motion.increment);
            motion.step(Position(100 + to));
            assert_eq!((motion.forward, motion.reversed), (forward, reversed), "{to}");
            let moved = (Position(100 + to) - from) as f64 / step as f64;
            assert!((motion.increment - moved).abs() < 1e-12);
            assert!((motion.acceleration - (moved - increment)).abs() < 1e-12);
        }
    }

    /// With a shifted origin a motion goes on as before.
    #[test]
    fn a_shifted_origin_is_no_motion() {
        let mut motion = CommandMotion::<f64>::at(Position(0));
        motion.step(Position(16 * PER_NM));
        let mut shifted = motion.shifted(1000);
        assert_eq!(shifted.position, Position(16 * PER_NM + 1000));
        shifted.step(Position(6 * PER_NM + 1000));
        assert!(!shifted.reversed);
        shifted.step(Position(6 * PER_NM + 999));
        assert!(shifted.reversed);
    }
}
