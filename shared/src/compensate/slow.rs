//! Slow terms: tables over the travel or the time. One of the machine is evaluated with each command, in turn.

use super::motion::CommandMotion;
use crate::scalar::Scalar;

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
