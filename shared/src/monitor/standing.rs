//! A loop that uses a linear scale: one of motor and scale moves while the other stands.
//!
//! A loop on a scale that stands never reaches its command, and moves its motor without end. One of both that has moved by the limit
//! while the other has not is a fault of the other: of the scale, whose plug or coupling is loose, or of the encoder. A motor that crosses
//! the backlash moves alone, too, so that the limit has to be more.
//!
//! # Steps
//!
//! 1. In every tick: if the difference of the readings has changed by less than a part of the limit since they were last kept, neither
//!    has moved alone by more than that. This takes few instructions.
//! 2. Otherwise, if both have moved since then, they are kept anew. If one stands, the way of the other is compared.
//!
//! A sensor that freezes is noticed at step 2 when the other has moved by two parts (the difference may have been at the other end of its
//! range), and a fault when that has moved by [`Apart::most`] more. The sum, with the standstill of both, is the limit.
//!
//! Distances are in steps of 16 nm, of which 32 bits hold 68 m.

use crate::safety::FaultKind;
use crate::units::Position;

/// A motor reading counts as standing while it has moved by less than 1/64 of the limit of a frozen encoder: an encoder with one
/// of its two wires broken toggles between adjacent counts.
pub(super) const STANDSTILL_DIVISOR: u64 = 64;

/// Bits of a position below a step: 2²⁴ position units are 16 nm.
const STEP_BITS: u32 = 24;

/// The part of the limit by which the difference may change.
const PART: u64 = 8;

/// Limits of the motion of one sensor alone, steps.
#[derive(Clone, Copy, Debug)]
pub struct Apart {
    /// A reading that has moved by no more counts as standing.
    standstill: u32,
    /// Change of the difference of the readings up to which they are not looked at.
    part: u32,
    /// Change of their difference, in both directions, up to which the readings are not looked at.
    parts: u32,
    /// Distance that one may move while the other stands.
    most: u32,
}

/// The readings that were kept when both had last moved, steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct KeptReadings {
    /// Scale − motor; [`UNKNOWN_DIFFERENCE`]: the scale has had no reading since.
    difference: i32,
    scale: i32,
}

/// Far from every difference: step 2 follows.
const UNKNOWN_DIFFERENCE: i32 = i32::MIN;

impl KeptReadings {
    /// None.
    pub(super) const UNKNOWN: Self = Self { difference: UNKNOWN_DIFFERENCE, scale: 0 };
}

impl Apart {
    /// Of a loop without a scale: not monitored.
    pub const NOT_MONITORED: Self = Self { standstill: 0, part: 0, parts: u32::MAX, most: u32::MAX };

    /// For a limit, position units.
    #[must_use]
    pub fn new(limit: u64) -> Self {
        let (part, standstill) = (limit / PART, limit / STANDSTILL_DIVISOR);
        let steps = |units: u64| u32::try_from(units >> STEP_BITS).unwrap_or(u32::MAX / 2);
        let most = limit - 2 * part - 2 * standstill;
        Self { standstill: steps(standstill), part: steps(part), parts: 2 * steps(part), most: steps(most) }
    }

    /// Whether readings with this difference, position units, have to be looked at.
    #[inline]
    pub(super) const fn has_changed(&self, kept: KeptReadings, difference: i64) -> bool {
        let change = steps(difference).wrapping_sub(kept.difference);
        change.cast_unsigned().wrapping_add(self.part) > self.parts
    }

    /// The fault of the sensor that stands while the other one moves. For every tick in which [`Apart::has_changed`], or the scale has no
    /// reading.
    // Not inlined, and without the input of the monitoring, which would have to be in memory for it in every tick.
    #[cold]
    #[inline(never)]
    pub(super) fn standing_sensor(
        &self,
        kept: &mut KeptReadings,
        motor: Position,
        table: Option<Position>,
    ) -> Option<FaultKind> {
        let Some(table) = table else {
            *kept = KeptReadings::UNKNOWN;
            return None;
        };
        let now = KeptReadings { difference: steps(table - motor), scale: steps(table.0) };
        if !self.has_changed(*kept, table - motor) {
            return None;
        }
        let is_known = kept.difference != UNKNOWN_DIFFERENCE;
        let scale_way = now.scale.wrapping_sub(kept.scale);
        let motor_way = scale_way.wrapping_sub(now.difference.wrapping_sub(kept.difference));
        let [motor_alone, scale_alone] = [motor_way, scale_way].map(i32::unsigned_abs);
        match (motor_alone > self.standstill, scale_alone > self.standstill) {
            (true, false) if is_known => (motor_alone > self.most).then_some(FaultKind::ScaleFrozen),
            (false, true) if is_known => (scale_alone > self.most).then_some(FaultKind::EncoderFrozen),
            _ => {
                *kept = now;
                None
            }
        }
    }
}

/// Position units in steps.
#[expect(clippy::cast_possible_truncation, reason = "differences are taken modulo 68 m")]
const fn steps(units: i64) -> i32 {
    (units >> STEP_BITS) as i32
}
