//! What is watched on one axis, tick by tick. What comes of it is in [`crate::safety`].

use crate::safety::Hazard;
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
}

impl State {
    /// Nothing so far.
    pub const NEW: Self = Self { saturated_quarters: 0 };
}

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
    pub fn position(&self, seen: &Seen<S>) -> Option<Hazard> {
        if seen.following_error.exceeds(self.following_error) {
            return Some(Hazard::FollowingError);
        }
        match (seen.table, self.disagreement) {
            (Some(table), Some(limit)) if table.beyond(seen.motor).unsigned_abs() > limit => {
                return Some(Hazard::Disagreement);
            }
            (None, _) if seen.needs_table => return Some(Hazard::ScaleLost),
            _ => {}
        }
        let [least, greatest] = self.travel;
        (seen.command < least || seen.command > greatest).then_some(Hazard::SoftLimit)
    }

    /// With every velocity loop: what the motor has moved since the tick before, and whether the force is
    /// at its limit.
    #[must_use]
    pub fn velocity(&self, state: &mut State, increment: S, saturated: bool) -> Option<Hazard> {
        if self.encoder_step.is_some_and(|most| increment.exceeds(most)) {
            return Some(Hazard::EncoderStep);
        }
        if saturated {
            state.saturated_quarters = state.saturated_quarters.saturating_add(4);
            return (state.saturated_quarters / 4 > self.saturated_ticks).then_some(Hazard::ForceSaturated);
        }
        // An unstable loop throws the force from limit to limit: a tick in between must not begin the count anew.
        state.saturated_quarters = state.saturated_quarters.saturating_sub(1);
        None
    }
}
