//! What a homing sees in a tick, and what it wants of the machine.

use super::{Direction, HomingError};
use crate::feedback::{OriginShift, Reading};
use crate::units::Position;

/// What the homing of an axis sees in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HomingInput {
    /// Home switch, of two of the last three samples.
    pub home: bool,
    /// Readings of the first of these samples, if the switch has just become active.
    pub home_reading: Reading,
    /// Limit switches at the negative and the positive end.
    pub limits: [bool; 2],
    /// Present readings.
    pub reading: Reading,
    /// Present command.
    pub command: Position,
    /// In which direction the force of the last tick was at its limit, if it was.
    pub at_force_limit: Option<Direction>,
    /// Motor reading at an index pulse since the last tick.
    pub motor_index: Option<Position>,
    /// Scale reading at an index pulse since the last tick.
    pub scale_index: Option<Position>,
    /// Whether the path is done and the command is at rest.
    pub at_rest: bool,
    /// Whether the drives are on and no fault stops the path.
    pub is_on: bool,
}

/// What the machine has to do after a tick of the homing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomingAction {
    /// Decelerate to rest and discard the rest of the leg.
    Halt,
    /// The axis is at rest: shift its origin.
    SetOrigin(OriginShift),
    /// The second motor of a gantry is at rest: shift its origin, and move it to a square beam.
    Square(OriginShift),
    /// The beam is square: both motors are homed.
    GantryHomed,
}

/// The motion of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegMotion {
    /// Signed distance, m.
    pub distance_m: f64,
    /// Speed, m/s.
    pub speed_m_per_s: f64,
    /// Acceleration, m/s².
    pub acceleration_m_per_s2: f64,
}

/// State of a homing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomingStatus {
    /// In progress.
    Running,
    /// The origin is set.
    Homed,
    /// Failed; the axis has stopped or is stopping.
    Failed(HomingError),
}

/// Whether the limit switch at the end of a direction is active.
pub const fn at_limit(direction: Direction, input: &HomingInput) -> bool {
    let [negative, positive] = input.limits;
    match direction {
        Direction::Negative => negative,
        Direction::Positive => positive,
    }
}
