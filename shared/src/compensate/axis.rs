//! The compensations of one axis, and what they remember.

use super::backlash::Backlash;
use super::geometry::{Squareness, Straightness};
use super::kind::Item;
use super::motion::Motion;
use super::pitch::Pitch;
use super::reversal::Reversal;
use super::settings::{self, CompensationSettings};
use super::slew::Slew;
use super::table::Cycle;
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
    dividing: Option<Cycle<S>>,
    reversal: Option<Reversal<S>>,
    intalk: Option<Talk<S>>,
    crosstalk: Option<(u8, Talk<S>)>,
    squareness: Option<(u8, Squareness<S>)>,
    straightness: Option<(u8, Straightness<S>)>,
    ripple: Option<Cycle<S>>,
    /// For corrections of the command, a position tick; of the motor reading, a tick; of the force, a tick.
    command: Slew<S>,
    reading: Slew<S>,
    force: Slew<S>,
}

/// What the compensations of an axis remember.
#[derive(Clone, Copy, Debug)]
pub struct State<S: Scalar> {
    command: S,
    reading: S,
    force: S,
    /// What is left of the pulse of a reversal, and the force that it gives.
    pulse: S,
    pulse_force: S,
    looked_up: LookedUp<S>,
    off: u16,
}

/// What changes slowly: one of them is looked up with each command, in turn.
#[derive(Clone, Copy, Debug)]
struct LookedUp<S: Scalar> {
    turn: u8,
    pitch: S,
    straightness: S,
    intalk: S,
    crosstalk: S,
}

impl<S: Scalar> State<S> {
    /// Nothing corrected so far, every compensation on.
    pub const NEW: Self = Self {
        command: S::ZERO,
        reading: S::ZERO,
        force: S::ZERO,
        pulse: S::ZERO,
        pulse_force: S::ZERO,
        looked_up: LookedUp {
            turn: 0,
            pitch: S::ZERO,
            straightness: S::ZERO,
            intalk: S::ZERO,
            crosstalk: S::ZERO,
        },
        off: 0,
    };

    /// Switches one compensation on or off. They are on to begin with.
    pub const fn switch(&mut self, item: Item, on: bool) {
        let bit = 1 << item as u16;
        self.off = if on { self.off & !bit } else { self.off | bit };
    }

    const fn is_on(&self, item: Item) -> bool {
        self.off & (1 << item as u16) == 0
    }
}

impl<S: Scalar> AxisCompensation<S> {
    /// For an axis of a machine with `axes` of them.
    ///
    /// # Errors
    /// The [`ConfigError`] that names the first setting which is not finite, beyond its bound, or beyond what the
    /// number format `S` holds.
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
        let cycle = |name, cycle: &Option<settings::Cycle>, unit, bound| {
            let made =
                cycle.as_ref().map(|cycle| Cycle::new(name, &cycle.values, cycle.period_m, unit, bound));
            made.transpose()
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

    /// What is added to the command now, position units.
    pub fn standing(state: &State<S>) -> i64 {
        state.command.distance()
    }

    /// With every command: what to add to it, position units.
    pub fn command<const N: usize>(
        &self,
        state: &mut State<S>,
        axis: usize,
        motions: &[Motion<S>; N],
    ) -> i64 {
        let Some(own) = motions.get(axis) else { return 0 };
        let other = |axis: u8| motions.get(usize::from(axis)).unwrap_or(own);
        self.look_up(state, own, other);
        let looked_up = &state.looked_up;
        let mut sum = looked_up.pitch.widen() + looked_up.straightness.widen();
        sum += looked_up.intalk * own.acceleration;
        if let Some((source, _)) = &self.crosstalk {
            sum += looked_up.crosstalk * other(*source).acceleration;
        }
        if let Some(backlash) = self.backlash.as_ref().filter(|_| state.is_on(Item::Backlash)) {
            sum += backlash.correction(own).widen();
        }
        if let Some((source, square)) = self.squareness.as_ref().filter(|_| state.is_on(Item::Squareness)) {
            sum += square.correction(other(*source));
        }
        let force = self.reversal.as_ref().map(|reversal| reversal.force(&mut state.pulse, own));
        state.pulse_force = force.filter(|_| state.is_on(Item::Reversal)).unwrap_or_default();
        self.command.step(&mut state.command, S::round(sum)).distance()
    }

    /// Looks one value up: at 1 m/s and 4 kHz, each of them once a millimetre.
    fn look_up<'a>(&self, state: &mut State<S>, own: &'a Motion<S>, other: impl Fn(u8) -> &'a Motion<S>) {
        let none = S::default();
        state.looked_up.turn = (state.looked_up.turn + 1) & 3;
        match state.looked_up.turn {
            0 => {
                let pitch = self.pitch.as_ref().filter(|_| state.is_on(Item::Pitch));
                state.looked_up.pitch = pitch.map_or(none, |pitch| pitch.correction(own));
            }
            1 => {
                let shape = self.straightness.as_ref().filter(|_| state.is_on(Item::Straightness));
                state.looked_up.straightness =
                    shape.map_or(none, |(source, shape)| shape.correction(other(*source)));
            }
            2 => {
                let talk = self.intalk.as_ref().filter(|_| state.is_on(Item::Intalk));
                state.looked_up.intalk = talk.map_or(none, |talk| talk.correction(own.place));
            }
            _ => {
                let talk = self.crosstalk.as_ref().filter(|_| state.is_on(Item::Crosstalk));
                state.looked_up.crosstalk = talk.map_or(none, |(_, talk)| talk.correction(own.place));
            }
        }
    }

    /// With every tick: the motor reading without the resolver's error.
    pub fn reading(&self, state: &mut State<S>, motor: Position) -> Position {
        let none = S::default();
        let error = match &self.dividing {
            Some(dividing) if state.is_on(Item::Dividing) => dividing.at(motor),
            // What was there before fades, too.
            None if state.reading == none => return motor,
            _ => none,
        };
        motor - self.reading.step(&mut state.reading, error).distance()
    }

    /// With every tick: the force to add.
    pub fn force(&self, state: &mut State<S>, motor: Position) -> S {
        let mut target = state.pulse_force;
        if let Some(ripple) = self.ripple.as_ref().filter(|_| state.is_on(Item::Ripple)) {
            target = target - ripple.at(motor);
        }
        self.force.step(&mut state.force, target)
    }
}
