//! What is told of the feed override.

use serde::{Deserialize, Serialize};

use crate::interpolate::feed_hold::MOST_PERCENT;

/// The feed override. It ends, at 100 %, with a stop, with the drives and with the session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FeedOverride {
    /// What was asked for, 0 to 200 %.
    pub percent: u8,
    /// What the motion that runs permits, 100 to 200 %.
    pub most_percent: u8,
}

impl FeedOverride {
    /// As planned.
    pub const NONE: Self = Self { percent: 100, most_percent: MOST_PERCENT };

    /// What the path runs at, once it has changed to it, %.
    #[must_use]
    pub const fn applied_percent(&self) -> u8 {
        if self.percent < self.most_percent { self.percent } else { self.most_percent }
    }
}
