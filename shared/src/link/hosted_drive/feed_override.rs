//! The feed override: the host, or somebody beside it, lets the path run slower or faster than planned.

use super::HostedDrive;
use crate::interpolate::feed_hold::MOST_PERCENT;
use crate::link::feed_override::FeedOverride;
use crate::link::refusal::Refusal;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> HostedDrive<'_, S, N> {
    /// Sets the override of what runs. A motion that permits less than it asks for runs at what it permits; a path that is held continues
    /// at it.
    ///
    /// # Errors
    /// [`Refusal::Override`] above 200 %, [`Refusal::NothingMoves`].
    pub fn set_override(&mut self, percent: u8) -> Result<(), Refusal> {
        if percent > MOST_PERCENT {
            return Err(Refusal::Override { max: MOST_PERCENT });
        }
        let has_path = !self.is_exciting() && !self.machine().follows();
        if self.is_at_rest().is_ok() || !has_path || !self.machine().power().is_on() {
            return Err(Refusal::NothingMoves);
        }
        self.change_override(FeedOverride { percent, ..self.feed_override });
        Ok(())
    }

    /// The feed override.
    #[must_use]
    pub const fn feed_override(&self) -> FeedOverride {
        self.feed_override
    }

    /// A motion starts, which permits an override up to a value.
    pub(super) fn permit_override(&mut self, most_percent: u8) {
        self.change_override(FeedOverride { most_percent, ..self.feed_override });
    }

    /// Back to 100 %.
    pub(super) fn end_override(&mut self) {
        if self.feed_override != FeedOverride::NONE {
            self.change_override(FeedOverride::NONE);
        }
    }

    fn change_override(&mut self, feed_override: FeedOverride) {
        self.feed_override = feed_override;
        self.machine_mut().set_override(feed_override.applied_percent());
    }
}
