//! The position loop: error in, velocity command out.

use super::hpc::{self, Hpc};
use crate::scalar::Scalar;

/// P, or P behind the filter of [`Hpc`].
#[derive(Clone, Copy, Debug)]
pub struct PositionControl<S: Scalar> {
    /// Kp, in velocity units per error unit.
    pub gain: S::Gain,
    /// The filter of high-order position control.
    pub hpc: Option<Hpc<S>>,
}

/// What the position loop remembers.
pub type State<S> = hpc::State<S>;

impl<S: Scalar> PositionControl<S> {
    /// Velocity command for an error.
    pub fn velocity(&self, state: &mut State<S>, error: S) -> S {
        let filtered = match &self.hpc {
            Some(hpc) => hpc.filter(state, error),
            None => error,
        };
        S::round(filtered.times(self.gain))
    }
}
