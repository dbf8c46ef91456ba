//! A homing of either kind.

use super::interface::{HomingAction, HomingInput, HomingStatus, LegMotion};
use super::{HardStop, Homing};
use crate::interpolate::PathError;

/// A homing to the mark of a home switch, or to a hard stop.
#[derive(Clone, Copy, Debug)]
pub enum HomingRun {
    /// To a mark.
    ToMark(Homing),
    /// To a hard stop.
    ToStop(HardStop),
}

impl HomingRun {
    /// The state.
    #[must_use]
    pub const fn status(&self) -> HomingStatus {
        match self {
            Self::ToMark(homing) => homing.status(),
            Self::ToStop(homing) => homing.status(),
        }
    }

    /// Whether it is in progress. The limit switches of its axis are then a part of it, and no fault.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.status() == HomingStatus::Running
    }

    /// The force limit of its axis now, N; `None`: that of its settings.
    #[must_use]
    pub fn force_limit_n(&self) -> Option<f64> {
        match self {
            Self::ToMark(_) => None,
            Self::ToStop(homing) => homing.force_limit_n(),
        }
    }

    /// The motion to plan now, if the homing waits for one. [`HomingRun::leg_planned`] has to follow.
    #[must_use]
    pub fn leg_to_plan(&self) -> Option<LegMotion> {
        match self {
            Self::ToMark(homing) => homing.leg_to_plan(),
            Self::ToStop(homing) => homing.leg_to_plan(),
        }
    }

    /// The motion of [`HomingRun::leg_to_plan`] was planned, or rejected by the path.
    pub fn leg_planned(&mut self, planned: Result<(), PathError>) {
        match self {
            Self::ToMark(homing) => homing.leg_planned(planned),
            Self::ToStop(homing) => homing.leg_planned(planned),
        }
    }

    /// Stops the homing. The machine has to halt.
    pub fn stop(&mut self) {
        match self {
            Self::ToMark(homing) => homing.stop(),
            Self::ToStop(homing) => homing.stop(),
        }
    }

    /// One tick.
    pub fn tick(&mut self, input: &HomingInput) -> Option<HomingAction> {
        match self {
            Self::ToMark(homing) => homing.tick(input),
            Self::ToStop(homing) => homing.tick(input),
        }
    }
}
