//! The state of the compensations of an axis.

use super::active::Active;
use super::force;
use super::kind::CompensationKind;
use super::motion::CommandMotion;
use crate::scalar::{Fixed, Scalar};

/// The correction of a command, error units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Correction<S> {
    /// The whole correction, which is added to the command.
    pub total: S,
    /// The part of it that makes up for errors between motor and scale, which is also added to the scale's reading.
    pub screw: S,
}

impl<S: Scalar> Correction<S> {
    /// No correction.
    pub const NONE: Self = Self { total: S::ZERO, screw: S::ZERO };
}

/// State of the compensations of an axis.
#[derive(Clone, Copy, Debug)]
pub struct State<S: Scalar> {
    /// Present correction of the command, error units.
    pub(super) command: S,
    /// Part of it for errors between motor and scale.
    pub(super) screw: S,
    /// Present correction of the motor reading, error units.
    pub(super) reading: S,
    /// Present added force, N.
    pub(super) force: S,
    /// Pulse of the last reversal without its velocity factor, and its force.
    pub(super) pulse: S,
    pub(super) pulse_force: S,
    /// Force feed-forward.
    pub(super) model: force::State,
    pub(super) round_robin: RoundRobinTerms<S>,
    /// Ticks of the machine when the compensation was set.
    pub(super) set_at: u64,
    pub(super) active: Active<S>,
    /// One bit per kind that is switched off.
    off: u16,
}

/// Terms that change slowly: one of them is evaluated with each command, in turn.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoundRobinTerms<S: Scalar> {
    pub screw_pitch: S,
    pub scale_pitch: S,
    pub straightness: S,
    /// Sum of the corrections for errors beyond the scale.
    pub tool: S,
    pub intalk: S::Gain,
    pub crosstalk: S::Gain,
    pub drift: S,
    pub load: Fixed,
    pub friction: Fixed,
}

impl<S: Scalar> RoundRobinTerms<S> {
    /// All zero.
    pub const NONE: Self = Self {
        screw_pitch: S::ZERO,
        scale_pitch: S::ZERO,
        straightness: S::ZERO,
        tool: S::ZERO,
        intalk: S::ZERO_GAIN,
        crosstalk: S::ZERO_GAIN,
        drift: S::ZERO,
        load: Fixed::ZERO,
        friction: Fixed::ZERO,
    };
}

impl<S: Scalar> RoundRobinTerms<S> {
    /// To be called when one of the terms of the sum has changed.
    pub fn add_up(&mut self) {
        self.tool = self.scale_pitch + self.straightness + self.drift;
    }
}

impl<S: Scalar> State<S> {
    /// No correction so far, every compensation switched on.
    pub const NEW: Self = Self {
        command: S::ZERO,
        screw: S::ZERO,
        reading: S::ZERO,
        force: S::ZERO,
        pulse: S::ZERO,
        pulse_force: S::ZERO,
        model: force::State::NEW,
        round_robin: RoundRobinTerms::NONE,
        set_at: 0,
        active: Active::NONE,
        off: 0,
    };

    /// Switches one compensation on or off. Initially all are on. [`Active`] has to be listed again afterwards.
    pub const fn switch(&mut self, item: CompensationKind, on: bool) {
        let bit = 1 << item as u16;
        self.off = if on { self.off & !bit } else { self.off | bit };
    }

    /// Which of some kinds are switched on, one bit for each.
    pub(super) const fn switched_on(&self, kinds: u32) -> u32 {
        kinds & !(self.off as u32)
    }

    /// The present correction of the command.
    pub(super) const fn correction(&self) -> Correction<S> {
        Correction { total: self.command, screw: self.screw }
    }

    /// The axis is at rest with the drives off: there is no force, and when they come on it starts from zero.
    pub(super) fn rest_at(&mut self, motion: &CommandMotion<S>) {
        self.model.rest_at(motion.position);
        (self.force, self.pulse, self.pulse_force) = (S::ZERO, S::ZERO, S::ZERO);
    }
}
