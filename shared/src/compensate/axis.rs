//! The compensations of one axis: what they compute in a tick.

use super::backlash::Backlash;
use super::cycles::Cycles;
use super::drift::Drift;
use super::force::{Force, Surroundings};
use super::geometry::{Squareness, Straightness};
use super::kind::CompensationKind;
use super::motion::CommandMotion;
use super::pitch::Pitch;
use super::reversal::Reversal;
use super::settings::PitchSource;
use super::slew::Slew;
use super::state::{Correction, SlowTerms, State};
use super::table::Table;
use super::talk::Talk;
use crate::scalar::{Fixed, Scalar};
use crate::units::Position;

/// The compensations of one axis.
#[derive(Clone, Debug)]
pub struct AxisCompensation<S: Scalar> {
    pub(super) pitch: Option<Pitch<S>>,
    pub(super) backlash: Option<Backlash<S>>,
    pub(super) screw: Cycles<S>,
    pub(super) dividing: Cycles<S>,
    pub(super) reversal: Option<Reversal<S>>,
    pub(super) intalk: Option<Talk<S>>,
    pub(super) crosstalk: Option<(u8, Talk<S>)>,
    pub(super) squareness: Option<(u8, Squareness<S>)>,
    pub(super) straightness: Option<(u8, Straightness<S>)>,
    pub(super) ripple: Cycles<S>,
    /// Force feed-forward, with its tables over the position.
    pub(super) model: Option<Force>,
    pub(super) load: Option<Table<Fixed>>,
    pub(super) friction_map: Option<Table<Fixed>>,
    /// Error units per N on the table.
    pub(super) stretch: Option<S::Gain>,
    pub(super) drift: Option<Drift<S>>,
    /// The slow terms that there are.
    pub(super) slow: heapless::Vec<SlowTerm, SLOW_TERMS>,
    /// Of the command, per position tick.
    pub(super) command: Slew<S>,
    /// Of the motor reading, per tick.
    pub(super) reading: Slew<S>,
    /// Of the force, per tick.
    pub(super) force: Slew<S>,
}

/// Number of slow terms.
const SLOW_TERMS: usize = 7;

/// A term that changes slowly with position or time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SlowTerm {
    Pitch,
    Straightness,
    Intalk,
    Crosstalk,
    Drift,
    Load,
    AdditionalFriction,
}

impl<S: Scalar> AxisCompensation<S> {
    /// Evaluates all slow terms, and starts the force model with the present motion: for a compensation that has just been
    /// set. Not part of a tick.
    pub(super) fn start<const N: usize>(
        &self,
        state: &mut State<S>,
        axis: usize,
        motions: &[CommandMotion<S>; N],
    ) {
        let Some(own) = motions.get(axis) else { return };
        let other = |axis: u8| motions.get(usize::from(axis)).unwrap_or(own);
        (state.ticks, state.slow) = (0, SlowTerms::NONE);
        for term in &self.slow {
            self.evaluate(*term, state, own, other);
        }
        if let Some(model) = &self.model {
            model.start(&mut state.model, own);
        }
    }

    /// The correction of the command, once per command.
    #[inline(never)]
    pub(super) fn command<const N: usize>(
        &self,
        state: &mut State<S>,
        axis: usize,
        motions: &[CommandMotion<S>; N],
    ) -> Correction {
        let Some(own) = motions.get(axis) else { return Correction::NONE };
        let other = |axis: u8| motions.get(usize::from(axis)).unwrap_or(own);
        if let Some(term) = self.slow.get(usize::from(state.slow.next)) {
            let next = usize::from(state.slow.next) + 1;
            #[expect(clippy::cast_possible_truncation, reason = "at most 7")]
            let next = if next < self.slow.len() { next as u8 } else { 0 };
            state.slow.next = next;
            self.evaluate(*term, state, own, other);
        }
        self.forces_of_motion(state, own);
        let screw = self.screw_correction(state, own);
        let slow = &state.slow;
        let mut sum = own.acceleration * slow.intalk;
        if let Some((source, _)) = &self.crosstalk {
            sum += other(*source).acceleration * slow.crosstalk;
        }
        if let Some((source, squareness)) =
            self.squareness.as_ref().filter(|_| state.is_on(CompensationKind::Squareness))
        {
            sum += squareness.correction(other(*source));
        }
        self.command.step(&mut state.screw, screw);
        let slow_sum = slow.scale_pitch + slow.straightness + slow.drift;
        self.command.step(&mut state.command, screw + slow_sum + S::round(sum));
        state.correction()
    }

    /// The correction for errors between motor and scale, error units, before bound and rate.
    fn screw_correction(&self, state: &State<S>, own: &CommandMotion<S>) -> S {
        let mut screw = state.slow.screw_pitch;
        if !self.screw.is_empty() && state.is_on(CompensationKind::Screw) {
            screw = screw - self.screw.at(own.position);
        }
        if let Some(backlash) = self.backlash.as_ref().filter(|_| state.is_on(CompensationKind::Backlash)) {
            screw = screw + backlash.correction(own);
        }
        if let Some(stretch) = self.stretch.filter(|_| state.is_on(CompensationKind::Stretch)) {
            screw = screw + S::round(S::from_fixed(state.model.on_table) * stretch);
        }
        screw
    }

    /// The forces that depend on the commanded motion: the pulse at a reversal, and the feed-forward.
    fn forces_of_motion(&self, state: &mut State<S>, own: &CommandMotion<S>) {
        let pulse = self.reversal.as_ref().map(|reversal| reversal.force(&mut state.pulse, own));
        state.pulse_force = pulse.filter(|_| state.is_on(CompensationKind::Reversal)).unwrap_or_default();
        if let Some(model) = &self.model {
            let (load, friction) = (state.slow.load, state.slow.friction);
            model.update(&mut state.model, own.position, Surroundings { load, friction });
        }
    }

    /// Evaluates a slow term: at 1 m/s and 4 kHz with all seven, each of them is evaluated every 1.75 mm.
    #[inline(never)]
    fn evaluate<'a>(
        &self,
        term: SlowTerm,
        state: &mut State<S>,
        own: &'a CommandMotion<S>,
        other: impl Fn(u8) -> &'a CommandMotion<S>,
    ) {
        let none = S::default();
        let is_on = |kind| state.is_on(kind);
        match term {
            SlowTerm::Pitch => {
                let pitch = self.pitch.as_ref().filter(|_| is_on(CompensationKind::Pitch));
                let correction = pitch.map_or(none, |pitch| pitch.correction(own));
                let of = self.pitch.as_ref().map(Pitch::source);
                match of {
                    Some(PitchSource::Scale) => state.slow.scale_pitch = correction,
                    _ => state.slow.screw_pitch = correction,
                }
            }
            SlowTerm::Straightness => {
                let shape = self.straightness.as_ref().filter(|_| is_on(CompensationKind::Straightness));
                state.slow.straightness =
                    shape.map_or(none, |(source, shape)| shape.correction(other(*source)));
            }
            SlowTerm::Intalk => {
                let talk = self.intalk.as_ref().filter(|_| is_on(CompensationKind::Intalk));
                state.slow.intalk = talk.map_or(none, |talk| talk.correction(own.position)).to_gain();
            }
            SlowTerm::Crosstalk => {
                let talk = self.crosstalk.as_ref().filter(|_| is_on(CompensationKind::Crosstalk));
                state.slow.crosstalk = talk.map_or(none, |(_, talk)| talk.correction(own.position)).to_gain();
            }
            SlowTerm::Drift => {
                let drift = self.drift.as_ref().filter(|_| is_on(CompensationKind::Drift));
                state.slow.drift = drift.map_or(none, |drift| drift.correction(state.ticks));
            }
            SlowTerm::Load => {
                state.slow.load = self.load.as_ref().map_or(Fixed::ZERO, |load| load.at(own.position));
            }
            SlowTerm::AdditionalFriction => {
                let map = self.friction_map.as_ref().map_or(Fixed::ZERO, |map| map.at(own.position));
                let cold = self.model.as_ref().map_or(Fixed::ZERO, |model| model.cold_friction(state.ticks));
                state.slow.friction = map + cold;
            }
        }
    }

    /// The motor reading with the error of the resolver corrected, once per tick.
    pub(super) fn reading(&self, state: &mut State<S>, motor: Position) -> Position {
        state.ticks = state.ticks.wrapping_add(1);
        let none = S::default();
        let is_empty = self.dividing.is_empty();
        // A previous correction still has to return to zero.
        if is_empty && state.reading == none {
            return motor;
        }
        let is_on = !is_empty && state.is_on(CompensationKind::Dividing);
        let error = if is_on { self.dividing.at(motor) } else { none };
        motor - self.reading.step(&mut state.reading, error).distance()
    }

    /// The force to add, once per tick.
    #[inline(never)]
    pub(super) fn force(&self, state: &mut State<S>, motor: Position) -> S {
        let mut target = state.pulse_force;
        if self.model.is_some() && state.is_on(CompensationKind::Force) {
            target = target + S::from_fixed(state.model.applied);
        }
        if !self.ripple.is_empty() && state.is_on(CompensationKind::Ripple) {
            target = target - self.ripple.at(motor);
        }
        self.force.step(&mut state.force, target)
    }
}
