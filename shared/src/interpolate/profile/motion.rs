//! Progress along a curve: distance, speed and acceleration with 64 fraction bits.

use crate::integer::wide_mul_q32;
use crate::interpolate::fraction::{speed, whole};

/// Progress along a curve.
///
/// The end of a segment is computed in the tick before it, so that the work is spread over two ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    pub(super) place: ProfilePosition,
    pub(super) has_segment_end: bool,
    /// Whether the last tick computed or crossed the end of a segment.
    pub(super) was_at_segment_end: bool,
    /// Written where it is: a copy would take as long as its computation.
    pub(super) segment_end: SegmentEnd,
}

/// The end of the last segment that ends within the next tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SegmentEnd {
    pub(super) motion: Motion,
    pub(super) segment: u8,
    /// Time until then, up to a tick, 32 fraction bits.
    pub(super) time: u64,
}

/// A place on a curve.
///
/// Within a segment the distance after n ticks is a cubic in n, so its third difference is constant: three additions
/// advance it by a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ProfilePosition {
    /// Distance from the start, position units with 64 fraction bits, and its differences over the next tick.
    pub(super) distance: i128,
    first_difference: i128,
    second_difference: i128,
    /// The jerk.
    third_difference: i128,
    /// Time to the end of the segment, ticks with 32 fraction bits.
    pub(super) remaining: u64,
    pub(super) segment: u8,
}

impl Progress {
    /// At rest at zero, not started.
    pub const NONE: Self = Self {
        place: ProfilePosition {
            distance: 0,
            first_difference: 0,
            second_difference: 0,
            third_difference: 0,
            remaining: 0,
            segment: 0,
        },
        has_segment_end: false,
        was_at_segment_end: false,
        segment_end: SegmentEnd {
            motion: Motion { distance: 0, velocity: 0, acceleration: 0 },
            segment: 0,
            time: 0,
        },
    };

    /// Distance from the start, whole position units.
    #[must_use]
    pub const fn distance(&self) -> i64 {
        whole(self.place.distance)
    }

    /// Whether a tick since the last call computed or crossed the end of a segment, which takes longer than others.
    pub const fn take_segment_end(&mut self) -> bool {
        core::mem::replace(&mut self.was_at_segment_end, false)
    }

    /// Distance over the next tick, position units with 16 fraction bits.
    #[must_use]
    pub const fn speed(&self) -> u64 {
        speed(self.place.first_difference)
    }
}

impl ProfilePosition {
    /// Advances by a whole tick within a segment.
    #[inline]
    pub(super) fn whole_tick(&mut self, cruise: bool) {
        self.distance += self.first_difference;
        if !cruise {
            self.first_difference += self.second_difference;
            self.second_difference += self.third_difference;
        }
    }

    /// d(t + 1) − d(t) = v + a/2 + j/6; the difference of that, a + j; the difference of that, j.
    pub(super) fn set(&mut self, motion: &Motion, jerk_sixth: i128) {
        self.distance = motion.distance;
        self.first_difference = motion.velocity + (motion.acceleration >> 1) + jerk_sixth;
        self.third_difference = 6 * jerk_sixth;
        self.second_difference = motion.acceleration + self.third_difference;
    }

    /// The inverse of [`ProfilePosition::set`].
    pub(super) fn motion(&self, jerk_sixth: i128) -> Motion {
        let acceleration = self.second_difference - self.third_difference;
        Motion {
            distance: self.distance,
            velocity: self.first_difference - (acceleration >> 1) - jerk_sixth,
            acceleration,
        }
    }
}

/// Distance, speed and acceleration at one time, per tick with 64 fraction bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Motion {
    pub(super) distance: i128,
    pub(super) velocity: i128,
    pub(super) acceleration: i128,
}

impl Motion {
    /// Advances by a time up to a tick, 32 fraction bits.
    pub(super) fn advance(&mut self, jerk_sixth: i128, time: u64) {
        match u32::try_from(time) {
            Ok(0) => {}
            Ok(time) => self.advance_by(jerk_sixth, time),
            // A whole tick.
            Err(_) => {
                self.distance += self.velocity + (self.acceleration >> 1) + jerk_sixth;
                self.velocity += self.acceleration + 3 * jerk_sixth;
                self.acceleration += 6 * jerk_sixth;
            }
        }
    }

    /// d += t·(v + t·(a/2 + t·j/6)), v += t·(a + t·j/2), a += t·j.
    // Not inlined: the compiler would not see that the time is one word.
    #[inline(never)]
    pub(super) fn advance_by(&mut self, jerk_sixth: i128, time_q32: u32) {
        if self.acceleration == 0 && jerk_sixth == 0 {
            self.distance += wide_mul_q32(self.velocity, time_q32);
            return;
        }
        let sixth = wide_mul_q32(jerk_sixth, time_q32);
        let velocity_change = wide_mul_q32(self.acceleration + 3 * sixth, time_q32);
        self.distance +=
            wide_mul_q32(self.velocity + wide_mul_q32((self.acceleration >> 1) + sixth, time_q32), time_q32);
        self.velocity += velocity_change;
        self.acceleration += 6 * sixth;
    }
}
