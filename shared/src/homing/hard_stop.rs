//! Homing of one axis to a hard stop, with a force limit and without a home switch.
//!
//! ```text
//!     Release ── back-off distance ──► Press ── force at its limit, axis stands ──► BackOff ──► homed
//! ```
//!
//! Release moves the axis away from a stop at which it may stand, so that Press always begins with a motion. The stop is found when the force
//! is at its limit and the motor reading stays within [`STANDSTILL_UNITS`] for the declared time. The reading in that tick is the mark: it
//! contains the deflection of the drive train under the force limit, which is the same each time.

use serde::{Deserialize, Serialize};

use super::interface::{HomingAction, HomingInput, HomingStatus, LegMotion, at_limit};
use super::progress::{Phase, Progress, shift_to};
use super::{Direction, HomingError};
use crate::feedback::OriginShift;
use crate::interpolate::PathError;
use crate::units::{PER_M, PER_NM, Position, TRAVEL_LIMIT_M};

/// How an axis is homed to a hard stop, in SI.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HardStopSettings {
    /// Force limit during the whole homing, N, signed as the force of the controller: its sign is the direction of the stop.
    pub force_n: f64,
    /// Speed of all motions, m/s, above 0.
    pub speed_m_per_s: f64,
    /// Acceleration of all motions, m/s², above 0.
    pub acceleration_m_per_s2: f64,
    /// Time for which the axis has to stand at the force limit, s, above 0.
    pub standstill_s: f64,
    /// Greatest distance from the start to the stop, m, above 0.
    pub search_distance_m: f64,
    /// Distance by which the axis backs off from the stop, m, above 0.
    pub back_off_distance_m: f64,
    /// Position of the axis at the stop, m.
    pub stop_position_m: f64,
}

impl HardStopSettings {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`HomingError::Setting`] with the name of the setting.
    pub fn check(&self) -> Result<(), HomingError> {
        let values = [
            ("force_n", libm::fabs(self.force_n), f64::INFINITY),
            ("speed_m_per_s", self.speed_m_per_s, f64::INFINITY),
            ("acceleration_m_per_s2", self.acceleration_m_per_s2, f64::INFINITY),
            ("standstill_s", self.standstill_s, f64::INFINITY),
            ("search_distance_m", self.search_distance_m, TRAVEL_LIMIT_M),
            ("back_off_distance_m", self.back_off_distance_m, TRAVEL_LIMIT_M),
        ];
        for (name, value, most) in values {
            // A NaN is not above 0.
            if !(value > 0.0 && value <= most && value.is_finite()) {
                return Err(HomingError::Setting(name));
            }
        }
        if Position::from_m(self.stop_position_m).is_none() {
            return Err(HomingError::Setting("stop_position_m"));
        }
        Ok(())
    }

    /// The direction of the stop.
    #[must_use]
    pub fn direction(&self) -> Direction {
        if self.force_n < 0.0 { Direction::Negative } else { Direction::Positive }
    }
}

/// Distance of the motor reading within which the axis stands, position units: 10 µm.
const STANDSTILL_UNITS: u64 = 10_000 * PER_NM.unsigned_abs();

/// Distance at the force limit beyond which the axis is not at a stop, position units: 0.1 mm.
const YIELD_UNITS: u64 = 10 * STANDSTILL_UNITS;

/// Time beside that of the motions, s.
const SPARE_TIME_S: f64 = 10.0;

/// A motion between two standstills.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Leg {
    Release,
    Press,
    BackOff(Stop),
}

/// A stop that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stop {
    shift: OriginShift,
    /// Distance of the command beyond the stop, m.
    ahead_m: f64,
}

/// The command decelerates beyond the stop.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Found {
    shift: OriginShift,
    /// Motor reading at the stop.
    at: Position,
}

/// A push with the force at its limit.
#[derive(Clone, Copy, Debug)]
struct Push {
    /// Motor reading at its beginning.
    from: Position,
    /// Motor reading since which the axis stands, and for how many ticks.
    at: Position,
    ticks: u64,
}

/// A homing of one axis to a hard stop.
#[derive(Clone, Copy, Debug)]
pub struct HardStop {
    settings: HardStopSettings,
    progress: Progress<Leg, Found>,
    push: Option<Push>,
    standstill_ticks: u64,
    stop: Position,
    needs_scale: bool,
}

impl HardStop {
    /// A homing that starts with the next tick, of an axis in ticks at `tick_hz`. `needs_scale`: a loop of the axis uses the
    /// scale, so that it must have a reading at the stop.
    ///
    /// # Errors
    /// [`HomingError::Setting`].
    pub fn new(settings: &HardStopSettings, tick_hz: f64, needs_scale: bool) -> Result<Self, HomingError> {
        settings.check()?;
        let distance_m = settings.search_distance_m + 4.0 * settings.back_off_distance_m;
        let longest_s = SPARE_TIME_S + 2.0 * distance_m / settings.speed_m_per_s;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive; saturates")]
        let [standstill_ticks, ticks_left] =
            [settings.standstill_s, longest_s].map(|time_s| (time_s * tick_hz) as u64);
        let stop =
            Position::from_m(settings.stop_position_m).ok_or(HomingError::Setting("stop_position_m"))?;
        let progress = Progress::new(Leg::Release, ticks_left);
        Ok(Self { settings: *settings, progress, push: None, standstill_ticks, stop, needs_scale })
    }

    /// The state.
    #[must_use]
    pub const fn status(&self) -> HomingStatus {
        self.progress.status()
    }

    /// The magnitude of the force limit while it runs, N.
    #[must_use]
    pub fn force_limit_n(&self) -> Option<f64> {
        (self.status() == HomingStatus::Running).then(|| libm::fabs(self.settings.force_n))
    }

    /// The motion to plan now, if the homing waits for one. [`HardStop::leg_planned`] has to follow.
    #[must_use]
    pub fn leg_to_plan(&self) -> Option<LegMotion> {
        let Phase::Planning(leg) = self.progress.phase else { return None };
        let HardStopSettings { speed_m_per_s, acceleration_m_per_s2, .. } = self.settings;
        let (towards, back_off_m) = (self.settings.direction().sign(), self.settings.back_off_distance_m);
        let distance_m = match leg {
            Leg::Release => -towards * back_off_m,
            Leg::Press => towards * (self.settings.search_distance_m + back_off_m),
            Leg::BackOff(stop) => -towards * back_off_m - stop.ahead_m,
        };
        Some(LegMotion { distance_m, speed_m_per_s, acceleration_m_per_s2 })
    }

    /// The motion of [`HardStop::leg_to_plan`] was planned, or rejected by the path.
    pub fn leg_planned(&mut self, planned: Result<(), PathError>) {
        self.progress.leg_planned(planned);
    }

    /// Stops the homing. The machine has to halt.
    pub fn stop(&mut self) {
        self.fail(HomingError::Stopped);
    }

    fn fail(&mut self, error: HomingError) -> Option<HomingAction> {
        self.progress.fail(error)
    }

    /// One tick.
    pub fn tick(&mut self, input: &HomingInput) -> Option<HomingAction> {
        let phase = match self.progress.tick(input.is_on) {
            Ok(phase) => phase,
            Err(action) => return action,
        };
        match phase {
            Phase::Moving(leg) => self.moving(leg, input),
            Phase::Stopping(Found { shift, at }) if input.at_rest => {
                #[expect(clippy::cast_precision_loss, reason = "within the following error")]
                let ahead_m = (input.command - at) as f64 / PER_M;
                self.progress.phase = Phase::Planning(Leg::BackOff(Stop { shift, ahead_m }));
                None
            }
            Phase::Planning(_) | Phase::Stopping(_) | Phase::Ended(_) => None,
        }
    }

    fn moving(&mut self, leg: Leg, input: &HomingInput) -> Option<HomingAction> {
        let towards = self.settings.direction();
        let moves = if leg == Leg::Press { towards } else { towards.reversed() };
        if at_limit(moves, input) {
            return self.fail(HomingError::LimitSwitch);
        }
        if input.at_force_limit == Some(moves) {
            let push = self.pushed(input.reading.motor);
            if (push.at - push.from).unsigned_abs() > YIELD_UNITS {
                return self.fail(HomingError::StopYields);
            }
            if push.ticks >= self.standstill_ticks {
                return if leg == Leg::Press { self.found(input) } else { self.fail(HomingError::HeldFast) };
            }
            return None;
        }
        self.push = None;
        if !input.at_rest {
            return None;
        }
        match leg {
            Leg::Release => {
                self.progress.phase = Phase::Planning(Leg::Press);
                None
            }
            Leg::Press => self.fail(HomingError::StopNotFound),
            Leg::BackOff(Stop { shift, .. }) => Some(self.progress.homed(shift)),
        }
    }

    /// A tick with the force at its limit.
    fn pushed(&mut self, motor: Position) -> Push {
        let mut push = self.push.unwrap_or(Push { from: motor, at: motor, ticks: 0 });
        if (motor - push.at).unsigned_abs() > STANDSTILL_UNITS {
            (push.at, push.ticks) = (motor, 0);
        }
        push.ticks += 1;
        self.push = Some(push);
        push
    }

    /// The axis stands at the stop.
    fn found(&mut self, input: &HomingInput) -> Option<HomingAction> {
        self.push = None;
        match shift_to(self.stop, input.reading, self.needs_scale) {
            Ok(shift) => Some(self.progress.stop_then(Found { shift, at: input.reading.motor })),
            Err(error) => self.fail(error),
        }
    }
}
