//! A homing of any kind.

use super::interface::{HomingAction, HomingInput, HomingStatus, LegMotion};
use super::{GantryHoming, HardStop, Homing};
use crate::interpolate::PathError;

/// A homing to the mark of a home switch, to a hard stop, or of both motors of a gantry.
#[derive(Clone, Copy, Debug)]
pub enum HomingRun {
    /// To a mark.
    ToMark(Homing),
    /// To a hard stop.
    ToStop(HardStop),
    /// Of a gantry.
    OfGantry(GantryHoming),
}

impl HomingRun {
    /// The state.
    #[must_use]
    pub const fn status(&self) -> HomingStatus {
        match self {
            Self::ToMark(homing) => homing.status(),
            Self::ToStop(homing) => homing.status(),
            Self::OfGantry(homing) => homing.status(),
        }
    }

    /// Whether it is in progress. The limit switches of its axis are then a part of it, and no fault.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.status() == HomingStatus::Running
    }

    /// Whether the inputs of a tick are those of the second motor of a gantry.
    #[must_use]
    pub const fn is_at_second_motor(&self) -> bool {
        matches!(self, Self::OfGantry(homing) if homing.is_at_second())
    }

    /// The beam of a gantry has the command to be square.
    pub const fn squared(&mut self) -> Option<HomingAction> {
        match self {
            Self::OfGantry(homing) => homing.squared(),
            Self::ToMark(_) | Self::ToStop(_) => None,
        }
    }

    /// The force limit of its axis now, N; `None`: that of its settings.
    #[must_use]
    pub fn force_limit_n(&self) -> Option<f64> {
        match self {
            Self::ToMark(_) | Self::OfGantry(_) => None,
            Self::ToStop(homing) => homing.force_limit_n(),
        }
    }

    /// The motion to plan now, if the homing waits for one. [`HomingRun::leg_planned`] has to follow.
    #[must_use]
    pub fn leg_to_plan(&self) -> Option<LegMotion> {
        match self {
            Self::ToMark(homing) => homing.leg_to_plan(),
            Self::ToStop(homing) => homing.leg_to_plan(),
            Self::OfGantry(homing) => homing.leg_to_plan(),
        }
    }

    /// The motion of [`HomingRun::leg_to_plan`] was planned, or rejected by the path.
    pub fn leg_planned(&mut self, planned: Result<(), PathError>) {
        match self {
            Self::ToMark(homing) => homing.leg_planned(planned),
            Self::ToStop(homing) => homing.leg_planned(planned),
            Self::OfGantry(homing) => homing.leg_planned(planned),
        }
    }

    /// Stops the homing. The machine has to halt.
    pub fn stop(&mut self) {
        match self {
            Self::ToMark(homing) => homing.stop(),
            Self::ToStop(homing) => homing.stop(),
            Self::OfGantry(homing) => homing.stop(),
        }
    }

    /// One tick.
    pub fn tick(&mut self, input: &HomingInput) -> Option<HomingAction> {
        match self {
            Self::ToMark(homing) => homing.tick(input),
            Self::ToStop(homing) => homing.tick(input),
            Self::OfGantry(homing) => homing.tick(input),
        }
    }
}
