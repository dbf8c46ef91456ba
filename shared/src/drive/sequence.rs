//! What moves an axis in several motions, of which each depends on the one before.

use crate::homing::{HomingRun, LegMotion};
use crate::interpolate::PathError;
use crate::probing::{ProbeStatus, Probing};

/// A homing or a probing: at most one of them runs.
#[derive(Clone, Copy, Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "one at a time, and nothing to allocate it from; on the chip the difference is smaller"
)]
pub(super) enum Sequence {
    Homing(HomingRun),
    Probing(Probing),
}

impl Sequence {
    pub fn is_running(&self) -> bool {
        match self {
            Self::Homing(homing) => homing.is_running(),
            Self::Probing(probing) => probing.status() == ProbeStatus::Running,
        }
    }

    /// The motion to plan now, if it waits for one. [`Sequence::leg_planned`] has to follow.
    pub fn leg_to_plan(&self) -> Option<LegMotion> {
        match self {
            Self::Homing(homing) => homing.leg_to_plan(),
            Self::Probing(probing) => probing.leg_to_plan(),
        }
    }

    /// The motion of [`Sequence::leg_to_plan`] was planned, or rejected by the path.
    pub fn leg_planned(&mut self, planned: Result<(), PathError>) {
        match self {
            Self::Homing(homing) => homing.leg_planned(planned),
            Self::Probing(probing) => probing.leg_planned(planned),
        }
    }

    /// Ends it. The machine has to halt.
    pub fn stop(&mut self) {
        match self {
            Self::Homing(homing) => homing.stop(),
            Self::Probing(probing) => probing.stop(),
        }
    }
}
