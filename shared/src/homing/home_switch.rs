//! Homing of one axis: search for the home switch, back off, approach slowly, take the index pulse as the mark, and set motor
//! and scale to the position of the mark together.
//!
//! ```text
//!                limit switch: turn round
//!        ┌────────────────────────────────────► SearchBack ── switch passed ──┐
//!        │                                                                    ▼
//!     Search ── home switch ──► BackOff ── switch open ─────────────────► Approach ── edge ──► ToIndex ── pulse ──► homed
//!        (on the switch at the start: BackOff first)                          └── mark is the edge ──────────────► homed
//! ```
//!
//! Between two legs the axis decelerates to rest. [`Homing::tick`] runs in the tick and reacts to switches and pulses at once;
//! [`Homing::leg_to_plan`] says which motion is to be planned outside of the tick. Every leg has a bounded distance, and the
//! whole a time limit.

use super::interface::{HomingAction, HomingInput, HomingStatus, LegMotion, at_limit};
use super::progress::{Phase, Progress, shift_to};
use super::{AtLimit, HomingError, HomingSettings, Mark};
use crate::feedback::{OriginShift, Reading};
use crate::interpolate::PathError;
use crate::units::{PER_M, Position};

#[cfg(test)]
mod tests;

/// A motion between two standstills.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Leg {
    Search,
    /// In the other direction, over the switch to its far side.
    SearchBack {
        on_switch: bool,
    },
    /// After the search has found the switch, in the other direction, over the switch to its far side: the axis is on it, or beyond it by its braking distance.
    BackOff {
        on_switch: bool,
    },
    Approach,
    /// The end of the approach, from the edge of the switch to the index pulse.
    ToIndex {
        edge: Position,
    },
}

/// What follows when the axis has stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Then {
    Plan(Leg),
    /// The mark is behind the axis.
    SetOrigin(OriginShift),
}

/// Part of the spacing on both sides of the switch in which an index pulse is ambiguous.
const MARGIN_DIVISOR: u64 = 16;

/// A homing of one axis.
#[derive(Clone, Copy, Debug)]
pub struct Homing {
    settings: HomingSettings,
    progress: Progress<Leg, Then>,
    /// Greatest distance from the edge to the index, position units.
    index_distance: u64,
    mark: Position,
    needs_scale: bool,
    /// The first tick has decided which leg is the first. A leg is planned for longer than a tick, in which it must not change.
    has_started: bool,
}

impl Homing {
    /// A homing that starts with the next tick, of an axis in ticks at `tick_hz`. `needs_scale`: a loop of the axis uses the
    /// scale, so that it must have a reading at the mark.
    ///
    /// # Errors
    /// [`HomingError::Setting`].
    pub fn new(settings: &HomingSettings, tick_hz: f64, needs_scale: bool) -> Result<Self, HomingError> {
        settings.check()?;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive; saturates")]
        let [index_distance, ticks_left] =
            [settings.mark.index_distance_m() * PER_M, settings.timeout_s * tick_hz].map(|n| n as u64);
        let mark =
            Position::from_m(settings.mark_position_m).ok_or(HomingError::Setting("mark_position_m"))?;
        let progress = Progress::new(Leg::Search, ticks_left);
        Ok(Self { settings: *settings, progress, index_distance, mark, needs_scale, has_started: false })
    }

    /// The state.
    #[must_use]
    pub const fn status(&self) -> HomingStatus {
        self.progress.status()
    }

    /// The motion to plan now, if the homing waits for one: none before the first tick. [`Homing::leg_planned`] has to follow.
    #[must_use]
    pub const fn leg_to_plan(&self) -> Option<LegMotion> {
        let Phase::Planning(leg) = self.progress.phase else { return None };
        if !self.has_started {
            return None;
        }
        let HomingSettings { direction, search_speed_m_per_s, approach_speed_m_per_s, .. } = self.settings;
        let forwards = direction.sign();
        let (distance_m, speed_m_per_s) = match leg {
            Leg::Search => (forwards * self.settings.search_distance_m, search_speed_m_per_s),
            Leg::SearchBack { .. } => (-forwards * self.settings.search_distance_m, search_speed_m_per_s),
            Leg::BackOff { .. } => (-forwards * self.settings.back_off_distance_m, search_speed_m_per_s),
            Leg::Approach | Leg::ToIndex { .. } => {
                let distance_m =
                    2.0 * self.settings.back_off_distance_m + self.settings.mark.index_distance_m();
                (forwards * distance_m, approach_speed_m_per_s)
            }
        };
        let acceleration_m_per_s2 = self.settings.acceleration_m_per_s2;
        Some(LegMotion { distance_m, speed_m_per_s, acceleration_m_per_s2 })
    }

    /// The motion of [`Homing::leg_to_plan`] was planned, or rejected by the path.
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
            Phase::Planning(_) if !self.has_started => self.start(input),
            Phase::Planning(_) | Phase::Ended(_) => None,
            Phase::Moving(leg) => self.moving(leg, input),
            Phase::Stopping(_) if !input.at_rest => None,
            Phase::Stopping(Then::Plan(leg)) => self.stopped_before(leg, input),
            Phase::Stopping(Then::SetOrigin(shift)) => Some(self.progress.homed(shift)),
        }
    }

    /// At the start the axis can be on a switch.
    fn start(&mut self, input: &HomingInput) -> Option<HomingAction> {
        self.has_started = true;
        if input.home {
            self.progress.phase = Phase::Planning(Leg::BackOff { on_switch: true });
        } else if at_limit(self.settings.direction, input) {
            if self.settings.at_limit == AtLimit::Fail {
                return self.fail(HomingError::LimitSwitch);
            }
            self.progress.phase = Phase::Planning(Leg::SearchBack { on_switch: false });
        }
        None
    }

    /// At rest before a leg. The approach starts beside the switch.
    fn stopped_before(&mut self, leg: Leg, input: &HomingInput) -> Option<HomingAction> {
        if leg == Leg::Approach && input.home {
            return self.fail(HomingError::SwitchStuck);
        }
        self.progress.phase = Phase::Planning(leg);
        None
    }

    fn stop_before(&mut self, leg: Leg) -> HomingAction {
        self.progress.stop_then(Then::Plan(leg))
    }

    fn moving(&mut self, leg: Leg, input: &HomingInput) -> Option<HomingAction> {
        let ahead = at_limit(self.settings.direction, input);
        let behind = at_limit(self.settings.direction.reversed(), input);
        match leg {
            Leg::Search if input.home => Some(self.stop_before(Leg::BackOff { on_switch: false })),
            Leg::Search if ahead && self.settings.at_limit == AtLimit::TurnRound => {
                Some(self.stop_before(Leg::SearchBack { on_switch: false }))
            }
            Leg::SearchBack { on_switch: true } | Leg::BackOff { on_switch: true } if !input.home => {
                Some(self.stop_before(Leg::Approach))
            }
            Leg::Search | Leg::Approach | Leg::ToIndex { .. } if ahead => self.fail(HomingError::LimitSwitch),
            Leg::SearchBack { .. } | Leg::BackOff { .. } if behind => self.fail(HomingError::LimitSwitch),
            Leg::SearchBack { on_switch: false } if input.home => {
                self.progress.phase = Phase::Moving(Leg::SearchBack { on_switch: true });
                None
            }
            Leg::BackOff { on_switch: false } if input.home => {
                self.progress.phase = Phase::Moving(Leg::BackOff { on_switch: true });
                None
            }
            Leg::Approach if input.home => self.edge(input),
            Leg::ToIndex { edge } => self.await_index(edge, input),
            _ if !input.at_rest => None,
            Leg::BackOff { .. } | Leg::SearchBack { on_switch: true } => self.fail(HomingError::SwitchStuck),
            Leg::Search | Leg::SearchBack { .. } | Leg::Approach => self.fail(HomingError::SwitchNotFound),
        }
    }

    /// The edge of the switch in the approach: where its first sample was. A pulse that comes before the switch is seen is missed, and the next
    /// one is too far from the edge.
    fn edge(&mut self, input: &HomingInput) -> Option<HomingAction> {
        let Reading { motor, table } = input.home_reading;
        match self.settings.mark {
            Mark::SwitchEdge => self.mark_at(motor, table),
            Mark::MotorIndex { .. } => {
                self.progress.phase = Phase::Moving(Leg::ToIndex { edge: motor });
                None
            }
            Mark::ScaleIndex { .. } => match table {
                Some(edge) => {
                    self.progress.phase = Phase::Moving(Leg::ToIndex { edge });
                    None
                }
                None => self.fail(HomingError::ScaleMissing),
            },
        }
    }

    /// Between the edge of the switch and the index pulse. The other sensor has moved by the same distance since the pulse.
    fn await_index(&mut self, edge: Position, input: &HomingInput) -> Option<HomingAction> {
        let Reading { motor, table } = input.reading;
        let is_scale = matches!(self.settings.mark, Mark::ScaleIndex { .. });
        let (index, now) =
            if is_scale { (input.scale_index, table) } else { (input.motor_index, Some(motor)) };
        let Some(now) = now else { return self.fail(HomingError::ScaleMissing) };
        let Some(index) = index else {
            let missed = input.at_rest || (now - edge).unsigned_abs() > self.index_distance;
            return if missed { self.fail(HomingError::IndexNotFound) } else { None };
        };
        let (distance, margin) = ((index - edge).unsigned_abs(), self.index_distance / MARGIN_DIVISOR);
        if !is_scale && (distance < margin || distance > self.index_distance - margin) {
            return self.fail(HomingError::IndexTooCloseToSwitch);
        }
        let since = now - index;
        self.mark_at(motor - since, table.map(|table| table - since))
    }

    /// The readings at the mark are known: stop, then set the origin.
    fn mark_at(&mut self, motor: Position, table: Option<Position>) -> Option<HomingAction> {
        match shift_to(self.mark, Reading { motor, table }, self.needs_scale) {
            Ok(shift) => Some(self.progress.stop_then(Then::SetOrigin(shift))),
            Err(error) => self.fail(error),
        }
    }
}
