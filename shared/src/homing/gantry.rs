//! Homing of the two motors of a gantry, which move together all the time.
//!
//! ```text
//! reference of the first motor ──► reference of the second motor ──► the second motor moves to a square beam ──► both are homed
//! ```
//!
//! Each reference is found as that of one axis ([`Homing`]), with the switch and the index pulse of that motor; the limit switches of both
//! count. The position of the second reference has the declared offset, so that equal positions are a square beam. Skew beyond its limit is
//! a fault meanwhile, which ends it.

use super::interface::{HomingAction, HomingInput, HomingStatus, LegMotion};
use super::{Homing, HomingError, HomingSettings};
use crate::interpolate::PathError;

/// What is done at present.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// The reference of the first motor; then that of the second.
    First(Homing),
    Second,
    Squaring,
    Ended(Result<(), HomingError>),
}

/// A homing of a gantry.
#[derive(Clone, Copy, Debug)]
pub struct GantryHoming {
    stage: Stage,
    /// Of the second motor.
    second: Homing,
}

impl GantryHoming {
    /// A homing that starts with the next tick, of motors in ticks at `tick_hz`, first and second. `need_scales`: as in [`Homing::new`].
    /// The second reference is at its position without skew plus `offset_m`.
    ///
    /// # Errors
    /// [`HomingError::Setting`].
    pub fn new(
        settings: [&HomingSettings; 2],
        offset_m: f64,
        tick_hz: f64,
        need_scales: [bool; 2],
    ) -> Result<Self, HomingError> {
        let [first, second] = settings;
        let second = HomingSettings { mark_position_m: second.mark_position_m + offset_m, ..*second };
        Ok(Self {
            stage: Stage::First(Homing::new(first, tick_hz, need_scales[0])?),
            second: Homing::new(&second, tick_hz, need_scales[1])?,
        })
    }

    /// The state.
    #[must_use]
    pub const fn status(&self) -> HomingStatus {
        match &self.stage {
            Stage::First(homing) => homing.status(),
            Stage::Second => self.second.status(),
            Stage::Squaring => HomingStatus::Running,
            Stage::Ended(Ok(())) => HomingStatus::Homed,
            Stage::Ended(Err(error)) => HomingStatus::Failed(*error),
        }
    }

    /// Whether the inputs of a tick are those of the second motor, with the limit switches of both.
    #[must_use]
    pub const fn is_at_second(&self) -> bool {
        !matches!(self.stage, Stage::First(_))
    }

    /// The motion of both motors to plan now, if the homing waits for one. [`GantryHoming::leg_planned`] has to follow.
    #[must_use]
    pub const fn leg_to_plan(&self) -> Option<LegMotion> {
        match &self.stage {
            Stage::First(homing) => homing.leg_to_plan(),
            Stage::Second => self.second.leg_to_plan(),
            Stage::Squaring | Stage::Ended(_) => None,
        }
    }

    /// The motion of [`GantryHoming::leg_to_plan`] was planned, or rejected by the path.
    pub fn leg_planned(&mut self, planned: Result<(), PathError>) {
        match &mut self.stage {
            Stage::First(homing) => homing.leg_planned(planned),
            Stage::Second => self.second.leg_planned(planned),
            Stage::Squaring | Stage::Ended(_) => {}
        }
    }

    /// Stops the homing. The machine has to halt.
    pub fn stop(&mut self) {
        match &mut self.stage {
            Stage::First(homing) => homing.stop(),
            Stage::Second => self.second.stop(),
            Stage::Squaring => self.stage = Stage::Ended(Err(HomingError::Stopped)),
            Stage::Ended(_) => {}
        }
    }

    /// One tick. [`HomingAction::SetOrigin`] is of the motor whose inputs these were; after that of the second the beam is to be made square.
    pub fn tick(&mut self, input: &HomingInput) -> Option<HomingAction> {
        match &mut self.stage {
            Stage::First(homing) => {
                let action = homing.tick(input);
                if matches!(action, Some(HomingAction::SetOrigin(_))) {
                    self.stage = Stage::Second;
                }
                action
            }
            Stage::Second => match self.second.tick(input) {
                Some(HomingAction::SetOrigin(shift)) => {
                    self.stage = Stage::Squaring;
                    Some(HomingAction::Square(shift))
                }
                action => action,
            },
            Stage::Squaring if !input.is_on => {
                self.stage = Stage::Ended(Err(HomingError::DrivesOff));
                Some(HomingAction::Halt)
            }
            Stage::Squaring | Stage::Ended(_) => None,
        }
    }

    /// The second motor has the command of a square beam: the homing has ended, if that was its last part.
    pub const fn squared(&mut self) -> Option<HomingAction> {
        if !matches!(self.stage, Stage::Squaring) {
            return None;
        }
        self.stage = Stage::Ended(Ok(()));
        Some(HomingAction::GantryHomed)
    }
}
