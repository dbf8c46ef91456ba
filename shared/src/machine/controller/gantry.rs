//! Axes that are the motors of a gantry.

use super::Machine;
use crate::machine::Reference;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> Machine<S, N> {
    /// The first motor of the gantry of which an axis is the second; `None`: it has a command of its own.
    #[must_use]
    pub fn first_motor(&self, axis: usize) -> Option<usize> {
        self.config.as_ref()?.gantries.get(axis)?.map(|gantry| gantry.first)
    }

    /// The second motor of the gantry of which an axis is the first.
    #[must_use]
    pub fn second_motor(&self, axis: usize) -> Option<usize> {
        let gantries = &self.config.as_ref().filter(|_| self.state.has_gantry)?.gantries;
        gantries.iter().position(|gantry| gantry.is_some_and(|gantry| gantry.first == axis))
    }

    /// The other motor of the gantry of an axis.
    #[must_use]
    pub fn other_motor(&self, axis: usize) -> Option<usize> {
        self.first_motor(axis).or_else(|| self.second_motor(axis))
    }

    /// The skew of the gantry of a second motor in the last position tick, or when the drives were off, position units.
    #[must_use]
    pub fn skew(&self, second: usize) -> Option<i64> {
        self.state.gantries.skew(second)
    }

    /// Takes the present difference of the motors of each gantry without references as that of a beam without skew. [`Machine::configure`]
    /// and lost references leave it at that of equal positions.
    pub fn set_skew_zero(&mut self) {
        for second in 0..N {
            if self.references.of(second) == Some(Reference::Relative) {
                self.state.gantries.set_zero(second);
            }
        }
    }

    /// The origins of both motors of a gantry are at their references: the second is moved to a square beam from here on. Skew that exceeds its
    /// limit is a fault in the next position tick.
    pub fn square(&mut self, second: usize) {
        self.state.gantries.set_referenced(second, true);
    }

    /// Whether the second motor of a gantry has the command of a square beam.
    #[must_use]
    pub fn is_square(&self, second: usize) -> bool {
        self.state.gantries.is_square(second)
    }

    /// Both motors of a gantry, which is square, are homed. No effect if it is not square.
    pub fn gantry_homed(&mut self, second: usize) {
        if let Some(first) = self.first_motor(second)
            && self.is_square(second)
        {
            for axis in [first, second] {
                self.set_reference(axis, Reference::Homed);
            }
        }
    }
}
