//! How an axis is commanded to move: what corrections depend on.

use crate::scalar::Scalar;
use crate::units::Position;

/// Of one axis, at a position tick.
#[derive(Clone, Copy, Debug)]
pub struct Motion<S: Scalar> {
    /// The command.
    pub place: Position,
    /// Per tick, increment units.
    pub increment: S,
    /// Per tick², increment units.
    pub acceleration: S,
    /// +1 or −1: which way it went last. A command that stands, or trembles by less than
    /// [`REVERSAL_NM`], has not reversed.
    pub forward: bool,
    /// Whether it has just reversed.
    pub reversed: bool,
    /// The command furthest on in the present direction.
    furthest: Position,
    increment_units: i64,
}

/// How far a command has to come back to count as reversed, nm.
pub const REVERSAL_NM: i64 = 10;

impl<S: Scalar> Motion<S> {
    /// At rest.
    #[must_use]
    pub const fn at(place: Position) -> Self {
        Self {
            place,
            increment: S::ZERO,
            acceleration: S::ZERO,
            forward: true,
            reversed: false,
            furthest: place,
            increment_units: 0,
        }
    }

    /// The next command.
    pub fn step(&mut self, place: Position) {
        let increment = place - self.place;
        self.acceleration = S::from_increment(increment.wrapping_sub(self.increment_units));
        self.increment = S::from_increment(increment);
        (self.place, self.increment_units) = (place, increment);
        let on = place - self.furthest;
        self.reversed = false;
        if (on > 0) == self.forward {
            self.furthest = place;
        } else if on.unsigned_abs() > (REVERSAL_NM * crate::units::PER_NM).unsigned_abs() {
            (self.forward, self.reversed, self.furthest) = (!self.forward, true, place);
        }
    }
}
