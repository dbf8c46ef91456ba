//! Slow terms: tables over the travel or the time. One of the machine is evaluated with each command, in turn.

use super::axis::AxisCompensation;
use super::geometry::Straightness;
use super::kind::CompensationKind;
use super::motion::CommandMotion;
use super::pitch::Pitch;
use super::settings::PitchSource;
use super::state::State;
use crate::scalar::{Fixed, Scalar};

/// What slow terms depend on.
#[derive(Clone, Debug)]
pub(super) struct Inputs<S: Scalar, const N: usize> {
    pub motions: [CommandMotion<S>; N],
    /// Ticks of the machine.
    pub clock: u64,
}

/// Number of slow terms of an axis.
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

/// The slow terms of an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlowList {
    count: u8,
    /// Those from the count on are not used.
    terms: [SlowTerm; SLOW_TERMS],
}

impl SlowList {
    pub const EMPTY: Self = Self { count: 0, terms: [SlowTerm::Pitch; SLOW_TERMS] };

    /// Adds a term; each of them once.
    pub fn push(&mut self, term: SlowTerm) {
        if let Some(slot) = self.terms.get_mut(usize::from(self.count)) {
            *slot = term;
            self.count += 1;
        }
    }

    pub fn iter(self) -> impl Iterator<Item = SlowTerm> {
        self.terms.into_iter().take(usize::from(self.count))
    }
}

/// The slow terms of all axes, in the order of their evaluation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Schedule<const N: usize> {
    next: u8,
    count: u8,
    /// Axis and term. Those from the count on are not used.
    terms: [[(u8, SlowTerm); N]; SLOW_TERMS],
}

impl<const N: usize> Schedule<N> {
    pub const EMPTY: Self = Self { next: 0, count: 0, terms: [[(0, SlowTerm::Pitch); N]; SLOW_TERMS] };

    /// Adds the terms of an axis.
    pub fn add(&mut self, axis: u8, terms: SlowList) {
        for term in terms.iter() {
            if let Some(slot) = self.terms.as_flattened_mut().get_mut(usize::from(self.count)) {
                *slot = (axis, term);
                self.count += 1;
            }
        }
    }

    /// The axis and the term whose turn it is.
    pub fn advance(&mut self) -> Option<(usize, SlowTerm)> {
        let (axis, term) =
            *self.terms.as_flattened().get(usize::from(self.next)).filter(|_| self.next < self.count)?;
        let next = self.next.wrapping_add(1);
        self.next = if next < self.count { next } else { 0 };
        Some((usize::from(axis), term))
    }
}

impl<S: Scalar> AxisCompensation<S> {
    /// Evaluates a slow term: at 1 m/s and 4 kHz with all seven on two axes, each of them is evaluated every 3.5 mm.
    #[inline(never)]
    pub(super) fn evaluate<const N: usize>(
        &self,
        term: SlowTerm,
        state: &mut State<S>,
        axis: usize,
        Inputs { motions, clock }: &Inputs<S, N>,
    ) {
        let Some(own) = motions.get(axis) else { return };
        let active = &state.active;
        match term {
            SlowTerm::Pitch => {
                let pitch = self.pitch.as_ref().filter(|_| active.has(CompensationKind::Pitch));
                let correction = pitch.map_or(S::ZERO, |pitch| pitch.correction(own));
                match self.pitch.as_ref().map(Pitch::source) {
                    Some(PitchSource::Scale) => state.slow.scale_pitch = correction,
                    _ => state.slow.screw_pitch = correction,
                }
                state.slow.add_up();
            }
            SlowTerm::Straightness => {
                let shape = self.straightness.as_ref().filter(|_| active.has(CompensationKind::Straightness));
                let correction = |(source, shape): &(u8, Straightness<S>)| {
                    shape.correction(motions.get(usize::from(*source)).unwrap_or(own))
                };
                state.slow.straightness = shape.map_or(S::ZERO, correction);
                state.slow.add_up();
            }
            SlowTerm::Intalk => {
                let talk = self.intalk.as_ref().filter(|_| active.has(CompensationKind::Intalk));
                state.slow.intalk = talk.map_or(S::ZERO, |talk| talk.correction(own.position)).to_gain();
            }
            SlowTerm::Crosstalk => {
                let talk = self.crosstalk.as_ref().filter(|_| active.has(CompensationKind::Crosstalk));
                state.slow.crosstalk = talk.map_or(S::ZERO, |talk| talk.correction(own.position)).to_gain();
            }
            SlowTerm::Drift => {
                let drift = self.drift.as_ref().filter(|_| active.has(CompensationKind::Drift));
                state.slow.drift =
                    drift.map_or(S::ZERO, |drift| drift.correction(clock.wrapping_sub(state.set_at)));
                state.slow.add_up();
            }
            SlowTerm::Load => {
                state.slow.load = self.load.as_ref().map_or(Fixed::ZERO, |load| load.at(own.position));
            }
            SlowTerm::AdditionalFriction => {
                let map = self.friction_map.as_ref().map_or(Fixed::ZERO, |map| map.at(own.position));
                let cold = self
                    .model
                    .as_ref()
                    .map_or(Fixed::ZERO, |model| model.cold_friction(clock.wrapping_sub(state.set_at)));
                state.slow.friction = map + cold;
            }
        }
    }
}
