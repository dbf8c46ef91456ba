//! The course of a probing.

use serde::{Deserialize, Serialize};

use super::{ProbeError, ProbeSettings};
use crate::homing::LegMotion;
use crate::interpolate::PathError;
use crate::units::{PER_M, Position};

/// What a probing sees in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeInput {
    /// Whether the probe is touched, by two of the last three samples.
    pub touched: bool,
    /// The positions of the first of these samples, if it has just been touched.
    pub touch: Touch,
    /// Present command: that of the last position tick.
    pub command: Position,
    /// Whether the path is done and the command is at rest.
    pub at_rest: bool,
    /// Whether the drives are on and no fault stops the path.
    pub is_on: bool,
}

/// The positions of the tick of the first sample with the probe touched, of the two of three by which it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Touch {
    /// Command.
    pub command: Position,
    /// Motor reading.
    pub motor: Position,
    /// Reading of the linear scale.
    pub table: Option<Position>,
}

/// State of a probing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProbeStatus {
    /// In progress.
    Running,
    /// The probe was touched, and the axis is at rest, retracted if that was asked for.
    Touched(Touch),
    /// Failed; the axis has stopped or is stopping.
    Failed(ProbeError),
}

/// Ticks of a motion in which a touch is one of an axis that has not moved: the first one, and two more until two of three samples have
/// seen what touched in it. At 10 m/s² the axis moves by 0.1 µm in them.
const START_TICKS: u8 = 3;

/// What a probing waits for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    /// The approach is to be planned.
    Planning,
    /// The approach was planned, and this many ticks have seen it.
    Starting(u8),
    Approaching,
    /// Decelerating behind the touch.
    Stopping(Touch),
    /// The way back to the latched command is to be planned; the command is ahead of it by this distance, m.
    PlanningBack(Touch, f64),
    Retracting(Touch),
    Ended(Result<Touch, ProbeError>),
}

/// A probing of one axis.
#[derive(Clone, Copy, Debug)]
pub struct Probing {
    settings: ProbeSettings,
    phase: Phase,
}

impl Probing {
    /// A probing that starts with the next tick.
    ///
    /// # Errors
    /// [`ProbeError::Setting`].
    pub fn new(settings: &ProbeSettings) -> Result<Self, ProbeError> {
        settings.check()?;
        Ok(Self { settings: *settings, phase: Phase::Planning })
    }

    /// The state.
    #[must_use]
    pub const fn status(&self) -> ProbeStatus {
        match self.phase {
            Phase::Ended(Ok(touch)) => ProbeStatus::Touched(touch),
            Phase::Ended(Err(error)) => ProbeStatus::Failed(error),
            _ => ProbeStatus::Running,
        }
    }

    /// The motion to plan now, if the probing waits for one. [`Probing::leg_planned`] has to follow.
    #[must_use]
    pub const fn leg_to_plan(&self) -> Option<LegMotion> {
        let ProbeSettings { distance_m, speed_m_per_s, acceleration_m_per_s2, .. } = self.settings;
        let distance_m = match self.phase {
            Phase::Planning => distance_m,
            Phase::PlanningBack(_, ahead_m) => -ahead_m,
            _ => return None,
        };
        Some(LegMotion { distance_m, speed_m_per_s, acceleration_m_per_s2 })
    }

    /// The motion of [`Probing::leg_to_plan`] was planned, or rejected by the path.
    pub const fn leg_planned(&mut self, planned: Result<(), PathError>) {
        self.phase = match (self.phase, planned) {
            (Phase::Planning, Ok(())) => Phase::Starting(0),
            (Phase::PlanningBack(touch, _), Ok(())) => Phase::Retracting(touch),
            (Phase::Planning | Phase::PlanningBack(..), Err(error)) => {
                Phase::Ended(Err(ProbeError::Path(error)))
            }
            (phase, _) => phase,
        };
    }

    /// Stops the probing. The machine has to halt.
    pub const fn stop(&mut self) {
        self.fail(ProbeError::Stopped);
    }

    /// Ends the probing, unless it has ended; returns whether the machine has to halt.
    const fn fail(&mut self, error: ProbeError) -> bool {
        if matches!(self.phase, Phase::Ended(_)) {
            return false;
        }
        self.phase = Phase::Ended(Err(error));
        true
    }

    /// One tick; returns whether the machine has to decelerate to rest and discard the rest of the leg.
    #[must_use]
    pub fn tick(&mut self, input: &ProbeInput) -> bool {
        if !input.is_on {
            return self.fail(ProbeError::DrivesOff);
        }
        match self.phase {
            Phase::Planning | Phase::PlanningBack(..) | Phase::Ended(_) => false,
            // The axis has not moved, so that it has not touched anything.
            Phase::Starting(_) if input.touched => self.fail(ProbeError::Active),
            Phase::Starting(seen) => {
                self.phase =
                    if seen + 1 < START_TICKS { Phase::Starting(seen + 1) } else { Phase::Approaching };
                false
            }
            Phase::Approaching if input.touched => {
                self.phase = Phase::Stopping(input.touch);
                true
            }
            Phase::Approaching => input.at_rest && self.fail(ProbeError::NotTouched),
            Phase::Stopping(touch) => {
                if input.at_rest {
                    self.stopped(touch, input.command);
                }
                false
            }
            Phase::Retracting(touch) => {
                if input.at_rest {
                    self.phase = Phase::Ended(Ok(touch));
                }
                false
            }
        }
    }

    /// The axis is at rest behind the touch.
    fn stopped(&mut self, touch: Touch, command: Position) {
        #[expect(clippy::cast_precision_loss, reason = "the way of a deceleration")]
        let ahead_m = (command - touch.command) as f64 / PER_M;
        self.phase = if self.settings.retracts && ahead_m != 0.0 {
            Phase::PlanningBack(touch, ahead_m)
        } else {
            Phase::Ended(Ok(touch))
        };
    }
}

#[cfg(test)]
mod tests;
