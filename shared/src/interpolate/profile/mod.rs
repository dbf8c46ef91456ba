//! Path length over time: seven segments of constant jerk, sampled every tick.
//!
//! The curve is continuous in time: segments end between ticks, to 2⁻³² of a tick, and a block that is left at speed
//! passes the remainder of the tick to the next one. So the sampled curve keeps its limits everywhere, and no speed is lost
//! at joints. The durations are chosen first; the cruise speed then follows from the length,
//!
//! ```text
//! v = (2L − entry·r₁ − exit·r₂) / (r₁ + r₂ + 2c),
//! ```
//!
//! with the durations r₁ and r₂ of the ramps and c of the cruise, and the jerks follow from v: the segments end on the
//! length by construction. Distance, speed and acceleration are integrated with 64 fraction bits.

mod motion;
#[cfg(test)]
mod tests;

pub use motion::Progress;

use motion::{Motion, ProfilePosition, SegmentEnd};

use super::error::PathError;
use super::fraction::whole;
use super::limits::Limits;
use super::ramp::{MAX_TICKS, Ramp, TICK, peak};

/// Number of segments: three of speeding up, the cruise, three of slowing down.
const SEGMENTS: u8 = 7;

/// The segment at constant speed.
const CRUISE: u8 = 3;

/// A planned curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Profile {
    /// Position units.
    length: i64,
    /// Durations of the segments, ticks with 32 fraction bits.
    durations: [u64; SEGMENTS as usize],
    /// Entry and cruise speed, position units per tick, 64 fraction bits.
    entry: i128,
    cruise_speed: i128,
    up: RampRates,
    down: RampRates,
}

/// The rates of a ramp, 64 fraction bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct RampRates {
    /// Acceleration of the middle segment, position units per tick².
    acceleration: i128,
    /// A sixth of the jerk of the first segment, position units per tick³.
    jerk_sixth: i128,
}

/// Where a tick has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Within the block, at a distance from its start, position units.
    Within(i64),
    /// Beyond the end of the block, which leaves this much of the tick, 32 fraction bits.
    Beyond(u64),
}

/// The durations of a curve.
struct Durations {
    up: Ramp,
    /// Ticks with 32 fraction bits.
    cruise: u128,
    down: Ramp,
}

impl Profile {
    /// Plans the fastest curve within the limits for a length with given entry and exit speeds.
    ///
    /// Speeds are per tick with 16 fraction bits and must be within reach of each other
    /// ([`reachable`](super::ramp::reachable)). The cost is bounded: two divisions per segment, and that of [`peak`].
    ///
    /// # Errors
    /// [`PathError::TooLong`] if a ramp takes 2²⁹ ticks or more, or the cruise 2³¹.
    pub fn plan(length: i64, entry: u64, exit: u64, limits: &Limits) -> Result<Self, PathError> {
        let top = peak(length, entry, exit, limits);
        let (up, down) = (Ramp::between(entry, top, limits), Ramp::between(top, exit, limits));
        let [first, last] = [(up, entry), (down, exit)]
            .map(|(ramp, speed)| (u128::from(ramp.duration()) * (u128::from(top) + u128::from(speed))) >> 17);
        // Position units with 32 fraction bits.
        let remaining = (u128::from(length.unsigned_abs()) << 32).saturating_sub(first + last);
        let cruise = if top == 0 { 0 } else { (remaining << 16).div_ceil(u128::from(top)) };
        Self::with_durations(length, entry, exit, &Durations { up, cruise, down })
    }

    /// A length at constant speed, for filters behind the interpolation to smooth.
    ///
    /// # Errors
    /// [`PathError::TooLong`] if it takes 2³¹ ticks or more.
    pub fn steady(length: i64, feed: u64) -> Result<Self, PathError> {
        let cruise = (u128::from(length.unsigned_abs()) << 48).div_ceil(u128::from(feed.max(1)));
        Self::with_durations(length, 0, 0, &Durations { up: Ramp::default(), cruise, down: Ramp::default() })
    }

    /// The cruise speed and the jerks with which segments of these durations end on the length.
    fn with_durations(
        length: i64,
        entry: u64,
        exit: u64,
        &Durations { up, cruise, down }: &Durations,
    ) -> Result<Self, PathError> {
        if cruise >= u128::from(MAX_TICKS) << 32 || !up.is_short() || !down.is_short() {
            return Err(PathError::TooLong);
        }
        // 28 fraction bits. A ramp covers no more than the length, so entry·r₁ and exit·r₂ are at most 2L.
        let [entry, exit] = [entry, exit].map(|speed| i128::from(speed) << 12);
        let [r1, r2] = [up, down].map(|ramp| i128::from(ramp.duration()));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_possible_wrap,
            reason = "below 2⁶³, see above"
        )]
        let (cruise, divisor) = (cruise as u64, (cruise as i128) * 2 + r1 + r2);
        let top = ((i128::from(length) << 61) - entry * r1 - exit * r2) / divisor.max(1);
        Ok(Self {
            length,
            durations: [up.rise, up.hold, up.rise, cruise, down.rise, down.hold, down.rise],
            entry: entry << 36,
            cruise_speed: top << 36,
            up: ramp_rates(top - entry, up),
            down: ramp_rates(exit - top, down),
        })
    }

    /// Standstill for a number of ticks.
    #[must_use]
    pub const fn dwell(ticks: u64) -> Self {
        const NONE: RampRates = RampRates { acceleration: 0, jerk_sixth: 0 };
        Self {
            length: 0,
            durations: [0, 0, 0, ticks << 32, 0, 0, 0],
            entry: 0,
            cruise_speed: 0,
            up: NONE,
            down: NONE,
        }
    }

    /// Sets a progress to the start of the curve.
    pub fn start(&self, progress: &mut Progress) {
        let place = &mut progress.place;
        let mut motion = Motion { distance: 0, velocity: self.entry, acceleration: 0 };
        // The first segment that takes time, or the last.
        let mut segment = 0;
        for duration in &self.durations {
            place.remaining = *duration;
            if *duration > 0 || segment + 1 == SEGMENTS {
                break;
            }
            segment += 1;
            self.enter(&mut motion, segment);
        }
        place.segment = segment;
        place.set(&motion, self.jerk_sixth(segment));
        progress.has_segment_end = false;
    }

    /// Advances by a time up to [`TICK`].
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a call in every tick")]
    pub fn advance(&self, progress: &mut Progress, time: u64) -> Step {
        let place = &mut progress.place;
        if time != TICK || place.remaining < TICK {
            return self.leave_segment(progress, time);
        }
        place.remaining -= TICK;
        place.whole_tick(place.segment == CRUISE);
        if place.remaining < TICK {
            self.look_ahead(progress);
        }
        Step::Within(progress.distance())
    }

    /// Advances by a time in which a segment ends, or by a fraction of a tick.
    #[cold]
    #[inline(never)]
    fn leave_segment(&self, progress: &mut Progress, time: u64) -> Step {
        progress.was_at_segment_end = true;
        let place = &mut progress.place;
        let SegmentEnd { motion, segment, time: until } = &mut progress.segment_end;
        if !core::mem::take(&mut progress.has_segment_end) || time < *until {
            *motion = place.motion(self.jerk_sixth(place.segment));
            return self.across_segments(motion, time, place);
        }
        let (next, time) = (*segment + 1, time - *until);
        let Some(duration) = self.durations.get(usize::from(next)) else {
            (place.segment, place.remaining) = (*segment, 0);
            place.set(motion, 0);
            return Step::Beyond(time);
        };
        self.enter(motion, next);
        let jerk_sixth = self.jerk_sixth(next);
        motion.advance(jerk_sixth, time);
        place.set(motion, jerk_sixth);
        (place.segment, place.remaining) = (next, duration - time);
        if next == CRUISE && place.remaining < TICK {
            // A short cruise: its end is quickly computed.
            self.look_ahead(progress);
        }
        Step::Within(progress.distance())
    }

    /// Computes the end of a segment that ends within the next tick, and of those after it that do.
    #[cold]
    #[inline(never)]
    fn look_ahead(&self, progress: &mut Progress) {
        let place = &progress.place;
        let SegmentEnd { motion, segment, time } = &mut progress.segment_end;
        let jerk_sixth = self.jerk_sixth(place.segment);
        *motion = place.motion(jerk_sixth);
        (*segment, *time) = (place.segment, place.remaining);
        #[expect(clippy::cast_possible_truncation, reason = "less than a tick remains")]
        motion.advance_by(jerk_sixth, *time as u32);
        while let Some(&duration) = self.durations.get(usize::from(*segment) + 1)
            && duration <= TICK - *time
        {
            *segment += 1;
            self.pass(motion, *segment, duration);
            *time += duration;
        }
        (progress.has_segment_end, progress.was_at_segment_end) = (true, true);
    }

    /// Advances a motion by a whole segment.
    // Not inlined: the compiler would load the rates before a loop in which they are rarely used.
    #[inline(never)]
    fn pass(&self, motion: &mut Motion, segment: u8, duration: u64) {
        self.enter(motion, segment);
        motion.advance(self.jerk_sixth(segment), duration);
    }

    /// Advances a motion at a place by a time in which segments may end, and the place with it.
    #[inline(never)]
    fn across_segments(&self, motion: &mut Motion, mut time: u64, place: &mut ProfilePosition) -> Step {
        // At most all segments end within a tick.
        for _ in 0..SEGMENTS {
            let elapsed = time.min(place.remaining);
            if elapsed > 0 {
                motion.advance(self.jerk_sixth(place.segment), elapsed);
            }
            place.remaining -= elapsed;
            time -= elapsed;
            if place.remaining > 0 {
                break;
            }
            if place.segment + 1 >= SEGMENTS {
                place.set(motion, 0);
                return Step::Beyond(time);
            }
            place.segment += 1;
            place.remaining = self.durations.get(usize::from(place.segment)).copied().unwrap_or(0);
            self.enter(motion, place.segment);
        }
        place.set(motion, self.jerk_sixth(place.segment));
        Step::Within(whole(motion.distance))
    }

    /// Sets what is known at the start of a segment.
    const fn enter(&self, motion: &mut Motion, segment: u8) {
        match segment {
            // The jerk has reached these values but for rounding; without a jerk limit they jump here.
            1 => motion.acceleration = self.up.acceleration,
            CRUISE => (motion.velocity, motion.acceleration) = (self.cruise_speed, 0),
            5 => motion.acceleration = self.down.acceleration,
            _ => {}
        }
    }

    const fn jerk_sixth(&self, segment: u8) -> i128 {
        match segment {
            0 => self.up.jerk_sixth,
            2 => -self.up.jerk_sixth,
            4 => self.down.jerk_sixth,
            6 => -self.down.jerk_sixth,
            _ => 0,
        }
    }
}

/// The rates of a ramp for a change of speed Δ with 28 fraction bits: a = Δ/(rise + hold), j = a/rise.
fn ramp_rates(change: i128, ramp: Ramp) -> RampRates {
    let steady = u128::from(ramp.rise) + u128::from(ramp.hold);
    if steady == 0 {
        return RampRates::default();
    }
    let acceleration = scaled_quotient(change.unsigned_abs() << 4, 64, steady);
    if ramp.rise == 0 {
        return RampRates { acceleration: acceleration * change.signum(), jerk_sixth: 0 };
    }
    let sixth = scaled_quotient(acceleration.unsigned_abs(), 32, 6 * u128::from(ramp.rise));
    RampRates { acceleration: acceleration * change.signum(), jerk_sixth: sixth * change.signum() }
}

/// `value`·2^`shift`/`divisor`, for divisors below 2^(127 − `shift`).
fn scaled_quotient(value: u128, shift: u32, divisor: u128) -> i128 {
    let divisor = divisor.max(1);
    let (quotient, remainder) = (value / divisor, value % divisor);
    ((quotient << shift) + (remainder << shift) / divisor).cast_signed()
}
