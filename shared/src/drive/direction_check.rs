//! The direction check of a first power-up: a small force for a short time, and whether the axis moves the right way.
//!
//! With a wrong sign of force, encoder or scale, a closed loop runs away as soon as it is enabled. Before the first enable, this
//! check pushes one axis with a small open force, the others without force, until the reading has moved by a small
//! distance or the time is over:
//!
//! | result | meaning |
//! |---|---|
//! | ok | a positive force moves the motor reading, and that of the scale if there is one, in the positive direction |
//! | reversed | it moves the motor reading in the negative direction: change the sign of force *or* encoder |
//! | scale reversed | motor and scale move in opposite directions: change the sign of the scale |
//! | scale without motion | the motor has moved, the scale has not: its plug, or the coupling |
//! | wrong axis | another axis moves: two plugs are exchanged |
//! | no motion | force too small, brake closed, drive not ready, or encoder not connected |
//! | aborted | a fault, or the enable switch was opened |
//!
//! The distance is bounded: the force ends when motor and scale have moved by `detect_m`, or the motor by four times that while
//! the scale stands; the axis then coasts until friction stops it. A vertical axis must not be checked in this way: its brake stays open.

use serde::{Deserialize, Serialize};

use crate::feedback::Reading;
use crate::units::{PER_M, Position};

/// How an axis is checked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DirectionCheckSettings {
    /// Force, N; positive.
    pub force_n: f64,
    /// Longest time of the force, s.
    pub time_s: f64,
    /// Distance that counts as motion, m; more than the noise of the readings and the backlash.
    pub detect_m: f64,
}

/// The result of a direction check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DirectionResult {
    /// Force, motor reading and scale have the same direction.
    Ok,
    /// Force and motor reading have opposite directions.
    Reversed,
    /// Motor reading and scale have opposite directions.
    ScaleReversed,
    /// The motor has moved, the scale has not.
    ScaleWithoutMotion,
    /// This axis has moved instead.
    WrongAxis(u8),
    /// Nothing has moved.
    NoMotion,
    /// A fault, or the enable switch, has ended the check.
    Aborted,
}

/// Why a check was not started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectionCheckError {
    /// The drives are on or a fault is not acknowledged, a homing or another check runs, or there is no such axis.
    NotReady,
    /// A drive with step and direction inputs has no force to check.
    StepDrive,
    /// The setting with this name is out of its range.
    Setting(&'static str),
}

/// A direction check of one of N axes.
#[derive(Clone, Copy, Debug)]
pub struct DirectionCheck<const N: usize> {
    axis: usize,
    detect: u64,
    ticks_left: u32,
    /// Readings at the start; `None` before it.
    start: Option<[Reading; N]>,
    result: Option<DirectionResult>,
}

/// Longest time of the force, s.
const MAX_TIME_S: f64 = 1.0;

/// Motion of the motor by which the scale must have moved, too, in units of the distance that counts as motion.
const FAR: u64 = 4;

/// Greatest distance that counts as motion, m.
const MAX_DETECT_M: f64 = 5e-3;

impl<const N: usize> DirectionCheck<N> {
    /// A check of an axis, in ticks at `tick_hz`. The force is checked against its limit by the caller.
    ///
    /// # Errors
    /// [`DirectionCheckError::Setting`] for a time above 1 s or one that is not positive, and for a distance above 5 mm or below a
    /// position unit, which an axis at rest would have moved by.
    pub fn new(
        axis: usize,
        settings: &DirectionCheckSettings,
        tick_hz: f64,
    ) -> Result<Self, DirectionCheckError> {
        let DirectionCheckSettings { time_s, detect_m, .. } = *settings;
        if !(time_s > 0.0 && time_s <= MAX_TIME_S) {
            return Err(DirectionCheckError::Setting("time_s"));
        }
        if !(detect_m * PER_M >= 1.0 && detect_m <= MAX_DETECT_M) {
            return Err(DirectionCheckError::Setting("detect_m"));
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
        let (detect, ticks_left) = ((detect_m * PER_M) as u64, (time_s * tick_hz) as u32);
        Ok(Self { axis, detect, ticks_left, start: None, result: None })
    }

    /// The axis.
    #[must_use]
    pub const fn axis(&self) -> usize {
        self.axis
    }

    /// The result, once the check has ended.
    #[must_use]
    pub const fn result(&self) -> Option<DirectionResult> {
        self.result
    }

    /// Whether the force acts.
    #[must_use]
    pub const fn is_pushing(&self) -> bool {
        self.start.is_some() && self.result.is_none()
    }

    /// Starts to push.
    pub fn start(&mut self, readings: &[Reading; N]) {
        if self.result.is_none() {
            self.start = Some(*readings);
        }
    }

    /// Ends the check without a result.
    pub fn abort(&mut self) {
        self.result = self.result.or(Some(DirectionResult::Aborted));
    }

    /// One tick while the force acts.
    pub fn tick(&mut self, readings: &[Reading; N]) {
        let Some(start) = self.start.filter(|_| self.result.is_none()) else { return };
        self.result = self.judge(&start, readings);
        match self.ticks_left.checked_sub(1) {
            Some(left) => self.ticks_left = left,
            None => self.result = self.result.or_else(|| Some(self.judge_at_end(&start, readings))),
        }
    }

    /// The result as soon as motor and scale have moved.
    fn judge(&self, start: &[Reading; N], now: &[Reading; N]) -> Option<DirectionResult> {
        for (number, (axis, (start, now))) in (0..).zip(start.iter().zip(now).enumerate()) {
            if axis != self.axis && self.direction(start.motor, now.motor).is_some() {
                return Some(DirectionResult::WrongAxis(number));
            }
        }
        let (start, now) = (start.get(self.axis)?, now.get(self.axis)?);
        let forwards = self.direction(start.motor, now.motor)?;
        if !forwards {
            return Some(DirectionResult::Reversed);
        }
        let far = (now.motor - start.motor).unsigned_abs() >= FAR * self.detect;
        match (start.table, now.table) {
            (Some(start), Some(now)) => match self.direction(start, now) {
                Some(true) => Some(DirectionResult::Ok),
                Some(false) => Some(DirectionResult::ScaleReversed),
                None => far.then_some(DirectionResult::ScaleWithoutMotion),
            },
            (Some(_), None) => Some(DirectionResult::ScaleWithoutMotion),
            (None, _) => Some(DirectionResult::Ok),
        }
    }

    fn judge_at_end(&self, start: &[Reading; N], now: &[Reading; N]) -> DirectionResult {
        let moved = |(start, now): (&Reading, &Reading)| self.direction(start.motor, now.motor).is_some();
        let motor_moved = start.get(self.axis).zip(now.get(self.axis)).is_some_and(moved);
        if motor_moved { DirectionResult::ScaleWithoutMotion } else { DirectionResult::NoMotion }
    }

    /// Whether a reading has moved forwards; `None`: by less than counts as motion.
    fn direction(&self, start: Position, now: Position) -> Option<bool> {
        let distance = now - start;
        (distance.unsigned_abs() >= self.detect).then_some(distance > 0)
    }
}
