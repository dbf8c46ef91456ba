//! Axes that follow counters.

use super::Machine;
use crate::interpolate::PathError;
use crate::interpolate::following::{FollowError, FollowSettings};
use crate::machine::MachineConfig;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> Machine<S, N> {
    /// Lets an axis at rest follow a counter that is at a count, from its present command on: see [`following`](crate::interpolate::following). The drives have
    /// to be on. Not part of a tick.
    ///
    /// # Errors
    /// [`FollowError`]; [`PathError::NotHomed`] in it for an axis with soft limits that is not homed. Nothing is changed then.
    pub fn follow(&mut self, axis: usize, count: u32, settings: &FollowSettings) -> Result<(), FollowError> {
        match self.accepts_blocks() {
            Ok(()) | Err(PathError::Following) => {}
            Err(error) => return Err(error.into()),
        }
        if !self.state.power.is_on() {
            return Err(PathError::Interrupted.into());
        }
        if self.not_homed()?.get(axis) == Some(&true) {
            let axis = u8::try_from(axis).unwrap_or(u8::MAX);
            return Err(PathError::NotHomed { axis }.into());
        }
        let deceleration = self.config.as_ref().map_or(1, MachineConfig::stop_deceleration);
        self.state.path.engage(axis, count, settings, deceleration)
    }

    /// Sets the counters of the inputs, which axes that follow read from the next position tick on.
    pub fn set_counters(&mut self, counts: [Option<u32>; N]) {
        self.state.path.set_counters(counts);
    }

    /// Whether axes follow counters, or decelerate from that.
    #[inline]
    #[must_use]
    pub const fn follows(&self) -> bool {
        self.state.path.follows()
    }

    /// How far an axis that follows a counter is from its setpoint, position units; `None`: it does not follow.
    #[must_use]
    pub fn following_lag(&self, axis: usize) -> Option<i64> {
        self.state.path.following_lag(axis)
    }
}
