//! The direction check of a first power-up: a small force for a short time, and whether the axis moves the right way.
//!
//! With a wrong sign of force, encoder or scale, a closed loop runs away as soon as it is enabled. Before the first enable, this
//! check pushes one axis with a small open force, the others without force, until any reading has moved by a small
//! distance or the time is over:
//!
//! | result | meaning |
//! |---|---|
//! | ok | a positive force moves the readings of motor and scale in the positive direction |
//! | ok without scale | it moves the motor reading so; there is no reading of a scale |
//! | reversed | it moves the motor reading in the negative direction: change the sign of force *or* encoder |
//! | scale reversed | motor and scale move in opposite directions: change the sign of the scale |
//! | scale without motion | the motor has moved, the scale has not: its plug, or the coupling |
//! | motor without motion | the scale has moved, the motor reading has not: the plug of the encoder |
//! | wrong axis | another axis moves: two plugs are exchanged |
//! | no motion | force too small, brake closed, drive not ready, or encoder not connected |
//! | aborted | a fault, or the enable switch was opened |
//! | expired | the host was silent, or another session was opened, before the switch was closed |
//!
//! The force ends when a reading of any axis has moved by `detect_m`; the axis then coasts until friction stops it. If nothing is read of
//! an axis, its motion is bounded by force and time alone: ½·(force − friction)/mass·`time_s`². A vertical axis must not be checked in
//! this way: its brake stays open.

use serde::{Deserialize, Serialize};

use crate::feedback::Reading;
use crate::units::PER_M;

/// How an axis is checked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DirectionCheckSettings {
    /// Force, N; positive.
    pub force_n: f64,
    /// Longest time of the force, s.
    pub time_s: f64,
    /// Distance that counts as motion, m; more than four times the noise of the readings, and twice the backlash.
    pub detect_m: f64,
}

/// The result of a direction check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DirectionResult {
    /// Force, motor reading and scale have the same direction.
    Ok,
    /// Force and motor reading have the same direction; there is no reading of a scale.
    OkWithoutScale,
    /// Force and motor reading have opposite directions.
    Reversed,
    /// Motor reading and scale have opposite directions.
    ScaleReversed,
    /// The motor has moved, the scale has not.
    ScaleWithoutMotion,
    /// The scale has moved, the motor reading has not.
    MotorWithoutMotion,
    /// This axis has moved instead.
    WrongAxis(u8),
    /// Nothing has moved.
    NoMotion,
    /// A fault, or the enable switch, has ended the check.
    Aborted,
    /// The host was silent, or another session was opened.
    Expired,
}

/// Why a check was not started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectionCheckError {
    /// The drives are on or a fault is not acknowledged, a homing or another check runs, or there is no such axis.
    NotReady,
    /// A drive with step and direction inputs has no force to check.
    StepDrive,
    /// The axis has a brake: with open loops it would fall.
    Brake,
    /// The axis is a motor of a gantry: one motor alone would bend the beam.
    Gantry,
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

/// When one of motor and scale has moved by the distance that counts as motion, the other counts as standing below this part of it:
/// backlash and wind-up take the rest.
const STANDING_PART: u64 = 4;

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
        self.end(DirectionResult::Aborted);
    }

    /// Ends the check, whose host is gone.
    pub fn expire(&mut self) {
        self.end(DirectionResult::Expired);
    }

    fn end(&mut self, result: DirectionResult) {
        self.result = self.result.or(Some(result));
    }

    /// One tick while the force acts.
    pub fn tick(&mut self, readings: &[Reading; N]) {
        let Some(start) = self.start.filter(|_| self.result.is_none()) else { return };
        self.result = self.judge(&start, readings);
        match self.ticks_left.checked_sub(1) {
            Some(left) => self.ticks_left = left,
            None => self.end(DirectionResult::NoMotion),
        }
    }

    /// The result as soon as a reading has moved.
    fn judge(&self, start: &[Reading; N], now: &[Reading; N]) -> Option<DirectionResult> {
        let ways = |(start, now): (&Reading, &Reading)| {
            (now.motor - start.motor, start.table.map(|start| now.table.map_or(0, |now| now - start)))
        };
        let has_moved = |way: i64| way.unsigned_abs() >= self.detect;
        let any_has_moved =
            |(motor, table): (i64, Option<i64>)| has_moved(motor) || table.is_some_and(has_moved);
        for (number, (axis, readings)) in (0..).zip(start.iter().zip(now).enumerate()) {
            if axis != self.axis && any_has_moved(ways(readings)) {
                return Some(DirectionResult::WrongAxis(number));
            }
        }
        let (motor, table) = ways((start.get(self.axis)?, now.get(self.axis)?));
        if !any_has_moved((motor, table)) {
            return None;
        }
        Some(match (self.direction(motor), table.map(|table| self.direction(table))) {
            (None, _) => DirectionResult::MotorWithoutMotion,
            (Some(_), Some(None)) => DirectionResult::ScaleWithoutMotion,
            (Some(false), _) => DirectionResult::Reversed,
            (Some(true), Some(Some(false))) => DirectionResult::ScaleReversed,
            (Some(true), Some(Some(true))) => DirectionResult::Ok,
            (Some(true), None) => DirectionResult::OkWithoutScale,
        })
    }

    /// Whether a reading that has moved this far has moved forwards; `None`: it counts as standing.
    const fn direction(&self, way: i64) -> Option<bool> {
        if way.unsigned_abs().saturating_mul(STANDING_PART) < self.detect { None } else { Some(way > 0) }
    }
}
