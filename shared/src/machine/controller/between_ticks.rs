//! Operations of a server that runs between ticks: feed hold, and the adoption of what was planned or converted outside of them.

use super::Machine;
use crate::compensate::{AxisCompensation, Dependence};
use crate::interpolate::feed_hold::FeedState;
use crate::interpolate::{Path, PathError};
use crate::machine::MachineError;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> Machine<S, N> {
    /// Copies the queue of blocks: [`Path::push_holding`] on the copy and [`Machine::adopt_queue`] append a block without
    /// planning it within the time of a tick. Returns the axes that must not move before they are homed.
    ///
    /// # Errors
    /// [`PathError`] if the machine accepts no blocks.
    pub fn copy_queue(&self, copy: &mut Path<N>) -> Result<[bool; N], PathError> {
        self.accepts_blocks()?;
        copy.copy_queue(&self.state.path);
        self.not_homed()
    }

    /// Adopts a copy of the queue with one more block. False, with nothing changed, if the queue has changed since.
    ///
    /// # Errors
    /// [`PathError`] if the machine accepts no blocks.
    pub fn adopt_queue(&mut self, planned: &Path<N>) -> Result<bool, PathError> {
        self.accepts_blocks()?;
        Ok(self.state.path.adopt_queue(planned))
    }

    /// Feed hold: decelerates along the path with the declared deceleration of a stop. The drives remain on.
    pub fn hold(&mut self) {
        if let Some(config) = &self.config {
            self.state.path.hold(config.stop_deceleration());
        }
    }

    /// Continues after [`Machine::hold`].
    pub fn resume(&mut self) {
        if let Some(config) = &self.config {
            self.state.path.resume(config.stop_deceleration());
        }
    }

    /// Sets the feed override: the path runs at 0 to [`MOST_PERCENT`](crate::interpolate::feed_hold::MOST_PERCENT) of its planned speed,
    /// and reaches it with the declared deceleration of a stop. [`Machine::configure`] sets 100 %.
    pub fn set_override(&mut self, percent: u8) {
        if let Some(config) = &self.config {
            self.state.path.set_override(percent, config.stop_deceleration());
        }
    }

    /// The present rate of the time of the path, % of the planned one.
    #[must_use]
    pub const fn rate_percent(&self) -> u8 {
        self.state.path.rate_percent()
    }

    /// Decelerates as [`Machine::hold`], then discards the rest of the path. The drives remain on.
    pub fn discard_path(&mut self) {
        if let Some(config) = &self.config {
            self.state.path.discard(config.stop_deceleration());
        }
    }

    /// Sets the force that is added behind the velocity controller of an axis, before the force limit, from the next tick on: its frequency
    /// response is measured with it. [`Machine::configure`] sets none.
    pub fn set_excitation(&mut self, axis: usize, force: S) {
        if let Some(excitation) = self.state.excitation.get_mut(axis) {
            *excitation = force;
        }
    }

    /// What the feed hold does.
    #[must_use]
    pub const fn feed_state(&self) -> FeedState {
        self.state.path.feed_state()
    }

    /// Replaces the compensation of an axis by one that was converted before, in the time of a copy: the conversion of tables
    /// takes longer than a tick.
    ///
    /// # Errors
    /// [`MachineError::NoSuchAxis`].
    pub fn set_compensation(
        &mut self,
        axis: usize,
        compensation: &AxisCompensation<S>,
        dependence: Dependence,
    ) -> Result<(), MachineError> {
        if axis >= N || self.config.is_none() {
            return Err(MachineError::NoSuchAxis);
        }
        self.references.set_dependence(axis, dependence);
        self.apply_switches();
        self.state.compensation.replace(axis, compensation);
        Ok(())
    }
}
