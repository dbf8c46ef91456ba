//! Slow terms: tables over the travel or the time. One of the machine is evaluated with each command, in turn.

use super::motion::CommandMotion;
use crate::scalar::Scalar;

/// What round-robin terms depend on.
#[derive(Clone, Debug)]
pub(super) struct Inputs<S: Scalar, const N: usize> {
    pub motions: [CommandMotion<S>; N],
    /// Ticks of the machine.
    pub clock: u64,
}

/// Number of round-robin terms of an axis.
const ROUND_ROBIN_TERMS: usize = 7;

/// A term that changes slowly with position or time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RoundRobinTerm {
    Pitch,
    Straightness,
    Intalk,
    Crosstalk,
    Drift,
    Load,
    AdditionalFriction,
}

/// The round-robin terms of an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoundRobinList {
    count: u8,
    /// Terms from the count on are not used.
    terms: [RoundRobinTerm; ROUND_ROBIN_TERMS],
}

impl RoundRobinList {
    pub const EMPTY: Self = Self { count: 0, terms: [RoundRobinTerm::Pitch; ROUND_ROBIN_TERMS] };

    /// Adds a term; each of them once.
    pub fn push(&mut self, term: RoundRobinTerm) {
        if let Some(slot) = self.terms.get_mut(usize::from(self.count)) {
            *slot = term;
            self.count += 1;
        }
    }

    pub fn iter(self) -> impl Iterator<Item = RoundRobinTerm> {
        self.terms.into_iter().take(usize::from(self.count))
    }
}

/// The round-robin terms of all axes, in the order of their evaluation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Schedule<const N: usize> {
    next: u8,
    count: u8,
    /// Axis and term. Those from the count on are not used.
    terms: [[(u8, RoundRobinTerm); N]; ROUND_ROBIN_TERMS],
}

impl<const N: usize> Schedule<N> {
    pub const EMPTY: Self =
        Self { next: 0, count: 0, terms: [[(0, RoundRobinTerm::Pitch); N]; ROUND_ROBIN_TERMS] };

    /// Adds the terms of an axis.
    pub fn add(&mut self, axis: u8, terms: RoundRobinList) {
        for term in terms.iter() {
            if let Some(slot) = self.terms.as_flattened_mut().get_mut(usize::from(self.count)) {
                *slot = (axis, term);
                self.count += 1;
            }
        }
    }

    /// The axis and the term whose turn it is.
    pub fn advance(&mut self) -> Option<(usize, RoundRobinTerm)> {
        let (axis, term) =
            *self.terms.as_flattened().get(usize::from(self.next)).filter(|_| self.next < self.count)?;
        let next = self.next.wrapping_add(1);
        self.next = if next < self.count { next } else { 0 };
        Some((usize::from(axis), term))
    }
}
