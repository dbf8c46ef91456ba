//! What is watched on one axis, tick by tick. What comes of it is in [`crate::safety`].

use crate::safety::{Hazard, Hazards};
use crate::scalar::Scalar;
use crate::units::{PER_NM, Position};

/// Limits of an axis.
#[derive(Clone, Copy, Debug)]
pub struct Watch<S: Scalar> {
    /// Command less feedback, error units.
    pub following_error: S,
    /// Scale less motor, position units; `None`: not watched.
    pub disagreement: Option<u64>,
    /// Motor reading, per tick, increment units; `None`: not watched.
    pub encoder_step: Option<S>,
    /// A motor reading that stands; `None`: not watched.
    pub frozen: Option<Frozen<S>>,
    /// Ticks that the force may stand at its limit, a quarter of those since then that it did not taken off.
    pub saturated_ticks: u32,
    /// Least and greatest command.
    pub travel: [Position; 2],
}

/// When a motor reading that stands is that of a dead encoder.
#[derive(Clone, Copy, Debug)]
pub struct Frozen<S: Scalar> {
    /// Travel of the command while the reading stands, position units.
    pub limit: u64,
    /// The same travel that the velocity loop is asked for, either way, error units.
    pub asked: [S::Sum; 2],
    /// Error units that a velocity unit is in a position tick.
    pub per_tick: S::Gain,
}

/// What has been seen of an axis.
#[derive(Clone, Copy, Debug)]
pub struct State<S: Scalar> {
    /// Quarters of a tick.
    saturated_quarters: u32,
    /// The last command that broke no soft limit.
    allowed: Position,
    /// Command and motor reading when that moved last.
    moved: [Position; 2],
    /// Travel that the velocity loop has been asked for since then, error units; no further than a tick beyond its limit.
    asked: S::Sum,
}

impl<S: Scalar> State<S> {
    /// Of an axis that comes on at a command with a motor reading.
    #[must_use]
    pub const fn at(command: Position, motor: Position) -> Self {
        Self { saturated_quarters: 0, allowed: command, moved: [command, motor], asked: S::ZERO_SUM }
    }
}

/// A motor reading that has moved by less than this part of [`Frozen::limit`] stands: with one of its two wires broken
/// an encoder toggles between neighbouring counts.
const STANDS: u64 = 64;

/// A command is beyond an end where it is by more than this, position units: 1 pm. The filters behind the path come to
/// rest on its end from a unit or two beyond it.
const BEYOND: i64 = PER_NM / 1000;

/// What is seen of an axis in a position tick.
#[derive(Clone, Copy, Debug)]
pub struct Seen<S> {
    /// Command less feedback, error units.
    pub following_error: S,
    /// Where the axis is to be, corrections left out.
    pub command: Position,
    /// What the velocity loop is asked for, velocity units.
    pub velocity_command: S,
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
    pub fn position(&self, state: &mut State<S>, seen: &Seen<S>) -> Hazards {
        let disagree = match (seen.table, self.disagreement) {
            (Some(table), Some(limit)) => (table - seen.motor).unsigned_abs() > limit,
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
    fn leaves_the_travel(&self, state: &mut State<S>, command: Position) -> bool {
        let [least, greatest] = self.travel;
        let [least, greatest] = [least.min(state.allowed), greatest.max(state.allowed)];
        let leaves = command < least - BEYOND || command > greatest + BEYOND;
        if !leaves {
            state.allowed = command.clamp(least, greatest);
        }
        leaves
    }

    /// Whether command and velocity loop have asked for the limit since the motor reading moved last. Either alone would
    /// not do: where a motor far behind its command turns round, the command is on its way already; and a loop without an
    /// integral part asks for a velocity that never comes while it holds a load.
    fn is_frozen(&self, state: &mut State<S>, seen: &Seen<S>) -> bool {
        let Some(frozen) = &self.frozen else { return false };
        let [command, motor] = state.moved;
        if (seen.motor - motor).unsigned_abs() > frozen.limit / STANDS {
            (state.moved, state.asked) = ([seen.command, seen.motor], S::ZERO_SUM);
            return false;
        }
        let [least, greatest] = frozen.asked;
        if state.asked >= least && state.asked <= greatest {
            state.asked += seen.velocity_command * frozen.per_tick;
            return false;
        }
        (seen.command - command).unsigned_abs() > frozen.limit
    }

    /// With every velocity loop: what the motor has moved since the tick before, and whether the force is
    /// at its limit.
    #[must_use]
    pub fn velocity(&self, state: &mut State<S>, increment: S, saturated: bool) -> Hazards {
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
