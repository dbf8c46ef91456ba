//! What makes any correction bounded and bumpless: it goes to its target no faster than a declared rate, and
//! no further than a declared bound.

use crate::scalar::Scalar;

/// Bound and rate.
#[derive(Clone, Copy, Debug)]
pub struct Slew<S: Scalar> {
    /// Greatest value either way.
    pub bound: S,
    /// Greatest change in a tick.
    pub per_tick: S,
}

impl<S: Scalar> Slew<S> {
    /// One tick towards a target. A target that is no number stops where it is.
    pub fn step(&self, value: &mut S, target: S) -> S {
        let step = target.within(self.bound).minus(*value).within(self.per_tick);
        if !step.exceeds(self.per_tick) {
            *value = value.plus(step);
        }
        *value
    }
}
