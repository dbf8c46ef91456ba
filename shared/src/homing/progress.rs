//! How far a homing is.

use super::HomingError;
use super::interface::{HomingAction, HomingStatus};
use crate::feedback::{OriginShift, Reading};
use crate::interpolate::PathError;
use crate::units::Position;

/// What a homing waits for: `Leg` is a motion between two standstills, `Then` what follows when the axis has stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase<Leg, Then> {
    /// The leg is to be planned.
    Planning(Leg),
    Moving(Leg),
    /// Decelerating.
    Stopping(Then),
    Ended(Result<(), HomingError>),
}

/// The phase of a homing, and its time limit.
#[derive(Clone, Copy, Debug)]
pub struct Progress<Leg, Then> {
    pub phase: Phase<Leg, Then>,
    ticks_left: u64,
}

impl<Leg: Copy, Then: Copy> Progress<Leg, Then> {
    /// Before the first leg.
    pub const fn new(first: Leg, ticks_left: u64) -> Self {
        Self { phase: Phase::Planning(first), ticks_left }
    }

    pub const fn status(&self) -> HomingStatus {
        match self.phase {
            Phase::Ended(Ok(())) => HomingStatus::Homed,
            Phase::Ended(Err(error)) => HomingStatus::Failed(error),
            _ => HomingStatus::Running,
        }
    }

    /// The leg that was to be planned has been planned, or rejected by the path.
    pub fn leg_planned(&mut self, planned: Result<(), PathError>) {
        if let Phase::Planning(leg) = self.phase {
            self.phase = match planned {
                Ok(()) => Phase::Moving(leg),
                Err(error) => Phase::Ended(Err(HomingError::Path(error))),
            };
        }
    }

    /// Ends the homing. The machine has to halt.
    pub fn fail(&mut self, error: HomingError) -> Option<HomingAction> {
        if matches!(self.phase, Phase::Ended(_)) {
            return None;
        }
        self.phase = Phase::Ended(Err(error));
        Some(HomingAction::Halt)
    }

    /// Decelerates.
    pub fn stop_then(&mut self, then: Then) -> HomingAction {
        self.phase = Phase::Stopping(then);
        HomingAction::Halt
    }

    /// The axis is at rest at its new origin.
    pub fn homed(&mut self, shift: OriginShift) -> HomingAction {
        self.phase = Phase::Ended(Ok(()));
        HomingAction::SetOrigin(shift)
    }

    /// A tick starts, with the drives on or off; gives the phase.
    ///
    /// # Errors
    /// What the machine has to do, if the homing has ended, in this tick or before.
    pub fn tick(&mut self, is_on: bool) -> Result<Phase<Leg, Then>, Option<HomingAction>> {
        if matches!(self.phase, Phase::Ended(_)) {
            return Err(None);
        }
        if !is_on {
            return Err(self.fail(HomingError::DrivesOff));
        }
        let Some(ticks_left) = self.ticks_left.checked_sub(1) else {
            return Err(self.fail(HomingError::Timeout));
        };
        self.ticks_left = ticks_left;
        Ok(self.phase)
    }
}

/// The shift of motor and scale that gives these readings the position of a mark. A scale without a reading is shifted with the motor, unless a
/// loop needs it.
pub fn shift_to(
    mark: Position,
    Reading { motor, table }: Reading,
    needs_scale: bool,
) -> Result<OriginShift, HomingError> {
    if table.is_none() && needs_scale {
        return Err(HomingError::ScaleMissing);
    }
    let motor = mark - motor;
    Ok(OriginShift { motor, table: table.map_or(motor, |table| mark - table) })
}
