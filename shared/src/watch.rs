//! What is watched on one axis, tick by tick. What comes of it is in [`crate::safety`].

use crate::safety::{Hazard, Hazards};
use crate::scalar::Scalar;
use crate::units::Position;

/// Limits of an axis.
#[derive(Clone, Copy, Debug)]
pub struct Watch<S: Scalar> {
    /// Command less feedback, error units.
    pub following_error: S,
    /// Scale less motor, position units; `None`: not watched.
    pub disagreement: Option<u64>,
    /// Motor reading, per tick, increment units; `None`: not watched.
    pub encoder_step: Option<S>,
    /// Command, while the motor reading stands, position units; `None`: not watched.
    pub frozen: Option<u64>,
    /// Ticks that the force may stand at its limit, a quarter of those since then that it did not taken off.
    pub saturated_ticks: u32,
    /// Least and greatest command.
    pub travel: [Position; 2],
}

/// What has been seen of an axis.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Quarters of a tick.
    saturated_quarters: u32,
    /// The last command that broke no soft limit.
    allowed: Position,
    /// Command and motor reading when that moved last.
    moved: [Position; 2],
}

impl State {
    /// Of an axis that comes on at a command with a motor reading.
    #[must_use]
    pub const fn at(command: Position, motor: Position) -> Self {
        Self { saturated_quarters: 0, allowed: command, moved: [command, motor] }
    }
}

/// A motor reading that has moved by less than this part of [`Watch::frozen`] stands: with one of its two wires broken
/// an encoder toggles between neighbouring counts.
const STANDS: u64 = 64;

/// What is seen of an axis in a position tick.
#[derive(Clone, Copy, Debug)]
pub struct Seen<S> {
    /// Command less feedback, error units.
    pub following_error: S,
    /// Where the axis is to be, corrections left out.
    pub command: Position,
    /// Motor reading.
    pub motor: Position,
    /// Reading of the linear scale.
    pub table: Option<Position>,
    /// Whether the loop needs that.
    pub needs_table: bool,
}

impl<S: Scalar> Watch<S> {
    /// With every position loop.
    #[must_use]
    pub fn position(&self, state: &mut State, seen: &Seen<S>) -> Hazards {
        let disagree = match (seen.table, self.disagreement) {
            (Some(table), Some(limit)) => table.beyond(seen.motor).unsigned_abs() > limit,
            _ => false,
        };
        Hazards::NONE
            .with(Hazard::FollowingError, seen.following_error.exceeds(self.following_error))
            .with(Hazard::Disagreement, disagree)
            .with(Hazard::EncoderFrozen, self.is_frozen(state, seen))
            .with(Hazard::SoftLimit, self.leaves_the_travel(state, seen.command))
            .with(Hazard::ScaleLost, seen.needs_table && seen.table.is_none())
    }

    /// Whether the command goes on outwards from what was allowed so far. An axis that came on outside its travel may
    /// stand there and go back, and what it has come back by is closed behind it.
    fn leaves_the_travel(&self, state: &mut State, command: Position) -> bool {
        let [least, greatest] = self.travel;
        let leaves = command < least.min(state.allowed) || command > greatest.max(state.allowed);
        if !leaves {
            state.allowed = command;
        }
        leaves
    }

    /// Whether the command has moved by the limit since the motor reading moved last.
    fn is_frozen(&self, state: &mut State, seen: &Seen<S>) -> bool {
        let Some(limit) = self.frozen else { return false };
        let [command, motor] = state.moved;
        if seen.motor.beyond(motor).unsigned_abs() > limit / STANDS {
            state.moved = [seen.command, seen.motor];
            return false;
        }
        seen.command.beyond(command).unsigned_abs() > limit
    }

    /// With every velocity loop: what the motor has moved since the tick before, and whether the force is
    /// at its limit.
    #[must_use]
    pub fn velocity(&self, state: &mut State, increment: S, saturated: bool) -> Hazards {
        // An unstable loop throws the force from limit to limit: a tick in between must not begin the count anew.
        state.saturated_quarters = if saturated {
            state.saturated_quarters.saturating_add(4)
        } else {
            state.saturated_quarters.saturating_sub(1)
        };
        let too_long = saturated && state.saturated_quarters / 4 > self.saturated_ticks;
        Hazards::NONE
            .with(Hazard::EncoderStep, self.encoder_step.is_some_and(|most| increment.exceeds(most)))
            .with(Hazard::ForceSaturated, too_long)
    }
}
