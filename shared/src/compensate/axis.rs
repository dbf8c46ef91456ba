//! The compensations of one axis, and their state.

use super::backlash::Backlash;
use super::geometry::{Squareness, Straightness};
use super::kind::CompensationKind;
use super::motion::CommandMotion;
use super::pitch::Pitch;
use super::reversal::Reversal;
use super::settings::{self, CompensationSettings};
use super::slew::Slew;
use super::table::{PeriodicTable, ValueRange};
use super::talk::Talk;
use crate::config::check::{positive, ranged};
use crate::config::{ConfigError, Rates};
use crate::scalar::Scalar;
use crate::units::{LENGTH_M, Position};

/// The compensations of one axis.
#[derive(Clone, Copy, Debug)]
pub struct AxisCompensation<S: Scalar> {
    pitch: Option<Pitch<S>>,
    backlash: Option<Backlash<S>>,
    dividing: Option<PeriodicTable<S>>,
    reversal: Option<Reversal<S>>,
    intalk: Option<Talk<S>>,
    crosstalk: Option<(u8, Talk<S>)>,
    squareness: Option<(u8, Squareness<S>)>,
    straightness: Option<(u8, Straightness<S>)>,
    ripple: Option<PeriodicTable<S>>,
    /// Of the command, per position tick.
    command: Slew<S>,
    /// Of the motor reading, per tick.
    reading: Slew<S>,
    /// Of the force, per tick.
    force: Slew<S>,
}

/// State of the compensations of an axis.
#[derive(Clone, Copy, Debug)]
pub struct State<S: Scalar> {
    /// Present correction of the command, error units.
    command: S,
    /// Present correction of the motor reading, error units.
    reading: S,
    /// Present added force, N.
    force: S,
    /// Pulse of the last reversal without its velocity factor, and its force.
    pulse: S,
    pulse_force: S,
    slow: SlowTerms<S>,
    /// One bit per kind that is switched off.
    off: u16,
}

/// Terms that change slowly: one of them is evaluated with each command, in turn.
#[derive(Clone, Copy, Debug)]
struct SlowTerms<S: Scalar> {
    /// The term that was evaluated last, 0 to 3.
    last: u8,
    pitch: S,
    straightness: S,
    intalk: S,
    crosstalk: S,
}

impl<S: Scalar> State<S> {
    /// No correction so far, every compensation switched on.
    pub const NEW: Self = Self {
        command: S::ZERO,
        reading: S::ZERO,
        force: S::ZERO,
        pulse: S::ZERO,
        pulse_force: S::ZERO,
        slow: SlowTerms {
            last: 0,
            pitch: S::ZERO,
            straightness: S::ZERO,
            intalk: S::ZERO,
            crosstalk: S::ZERO,
        },
        off: 0,
    };

    /// Switches one compensation on or off. Initially all are on.
    pub const fn switch(&mut self, item: CompensationKind, on: bool) {
        let bit = 1 << item as u16;
        self.off = if on { self.off & !bit } else { self.off | bit };
    }

    const fn is_on(&self, item: CompensationKind) -> bool {
        self.off & (1 << item as u16) == 0
    }
}

impl<S: Scalar> AxisCompensation<S> {
    /// Checks and converts the settings of an axis of a machine with `axes` axes.
    ///
    /// # Errors
    /// [`ConfigError`] for the first setting that is not finite, exceeds its bound or the range of the number format `S`.
    pub fn new(settings: &CompensationSettings, rates: Rates, axes: usize) -> Result<Self, ConfigError> {
        let (tick_hz, rate_hz) = (rates.velocity_loop_hz, rates.position_loop_hz());
        let bound_m = positive("position_bound_m", settings.position_bound_m)?;
        let bound_m = ranged("position_bound_m", bound_m, 0.0, 0.01)?;
        let bound_n = positive("force_bound_n", settings.force_bound_n)?;
        let bound_n = ranged("force_bound_n", bound_n, 0.0, S::SIGNAL_LIMIT)?;
        let speed = positive("position_rate_m_per_s", settings.position_rate_m_per_s)?;
        let rise = positive("force_rate_n_per_s", settings.force_rate_n_per_s)?;
        let position = |per_s: f64| {
            let per_tick = Slew::per_tick("position_rate_m_per_s", speed, per_s * LENGTH_M)?;
            Ok(Slew { bound: S::signal(bound_m / LENGTH_M), per_tick })
        };
        let source = |name, axis: u8| {
            if usize::from(axis) < axes {
                Ok(axis)
            } else {
                Err(ConfigError::OutOfRange { name, min: 0.0, max: axes as f64 - 1.0 })
            }
        };
        let cycle = |name, cycles: &[settings::Cycle], unit, bound| {
            let range = ValueRange { unit, bound };
            cycles.first().map(|cycle| PeriodicTable::new(name, cycle, range)).transpose()
        };
        let pitch = settings.pitch.as_ref().map(|pitch| Pitch::new(pitch, bound_m)).transpose()?;
        let intalk = settings.intalk.as_ref().map(|talk| Talk::new("intalk", talk, rate_hz)).transpose()?;
        Ok(Self {
            pitch,
            backlash: settings.backlash_width_m.map(|width| Backlash::new(width, bound_m)).transpose()?,
            dividing: cycle("dividing", &settings.dividing, LENGTH_M, bound_m)?,
            reversal: settings.reversal.as_ref().map(|r| Reversal::new(r, rate_hz, bound_n)).transpose()?,
            intalk,
            crosstalk: match &settings.crosstalk {
                Some((axis, talk)) => {
                    Some((source("crosstalk", *axis)?, Talk::new("crosstalk", talk, rate_hz)?))
                }
                None => None,
            },
            squareness: match settings.squareness {
                Some((axis, k)) => Some((source("squareness", axis)?, Squareness::new(k)?)),
                None => None,
            },
            straightness: match &settings.straightness {
                Some((axis, shape)) => {
                    Some((source("straightness", *axis)?, Straightness::new(shape, bound_m)?))
                }
                None => None,
            },
            ripple: cycle("ripple", &settings.ripple, 1.0, bound_n)?,
            command: position(rate_hz)?,
            reading: position(tick_hz)?,
            force: Slew {
                bound: S::signal(bound_n),
                per_tick: Slew::per_tick("force_rate_n_per_s", rise, tick_hz)?,
            },
        })
    }

    /// The present correction of the command, position units.
    pub fn active_correction(state: &State<S>) -> i64 {
        state.command.distance()
    }

    /// The correction of the command, position units, once per command.
    pub fn command<const N: usize>(
        &self,
        state: &mut State<S>,
        axis: usize,
        motions: &[CommandMotion<S>; N],
    ) -> i64 {
        let Some(own) = motions.get(axis) else { return 0 };
        let other = |axis: u8| motions.get(usize::from(axis)).unwrap_or(own);
        self.update_slow_term(state, own, other);
        let slow = &state.slow;
        let mut sum = slow.pitch.widen() + slow.straightness.widen();
        sum += slow.intalk * own.acceleration;
        if let Some((source, _)) = &self.crosstalk {
            sum += slow.crosstalk * other(*source).acceleration;
        }
        if let Some(backlash) = self.backlash.as_ref().filter(|_| state.is_on(CompensationKind::Backlash)) {
            sum += backlash.correction(own).widen();
        }
        if let Some((source, squareness)) =
            self.squareness.as_ref().filter(|_| state.is_on(CompensationKind::Squareness))
        {
            sum += squareness.correction(other(*source));
        }
        let force = self.reversal.as_ref().map(|reversal| reversal.force(&mut state.pulse, own));
        state.pulse_force = force.filter(|_| state.is_on(CompensationKind::Reversal)).unwrap_or_default();
        self.command.step(&mut state.command, S::round(sum)).distance()
    }

    /// Evaluates the next slow term: at 1 m/s and 4 kHz, each of them once per millimetre.
    fn update_slow_term<'a>(
        &self,
        state: &mut State<S>,
        own: &'a CommandMotion<S>,
        other: impl Fn(u8) -> &'a CommandMotion<S>,
    ) {
        let none = S::default();
        state.slow.last = (state.slow.last + 1) & 3;
        match state.slow.last {
            0 => {
                let pitch = self.pitch.as_ref().filter(|_| state.is_on(CompensationKind::Pitch));
                state.slow.pitch = pitch.map_or(none, |pitch| pitch.correction(own));
            }
            1 => {
                let shape =
                    self.straightness.as_ref().filter(|_| state.is_on(CompensationKind::Straightness));
                state.slow.straightness =
                    shape.map_or(none, |(source, shape)| shape.correction(other(*source)));
            }
            2 => {
                let talk = self.intalk.as_ref().filter(|_| state.is_on(CompensationKind::Intalk));
                state.slow.intalk = talk.map_or(none, |talk| talk.correction(own.position));
            }
            _ => {
                let talk = self.crosstalk.as_ref().filter(|_| state.is_on(CompensationKind::Crosstalk));
                state.slow.crosstalk = talk.map_or(none, |(_, talk)| talk.correction(own.position));
            }
        }
    }

    /// The motor reading with the error of the resolver corrected, once per tick.
    pub fn reading(&self, state: &mut State<S>, motor: Position) -> Position {
        let none = S::default();
        let error = match &self.dividing {
            Some(dividing) if state.is_on(CompensationKind::Dividing) => dividing.at(motor),
            // A previous correction still has to return to zero.
            None if state.reading == none => return motor,
            _ => none,
        };
        motor - self.reading.step(&mut state.reading, error).distance()
    }

    /// The force to add, once per tick.
    pub fn force(&self, state: &mut State<S>, motor: Position) -> S {
        let mut target = state.pulse_force;
        if let Some(ripple) = self.ripple.as_ref().filter(|_| state.is_on(CompensationKind::Ripple)) {
            target = target - ripple.at(motor);
        }
        self.force.step(&mut state.force, target)
    }
}
