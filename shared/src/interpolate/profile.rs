//! Path length over time: seven pieces of constant jerk, sampled every tick.
//!
//! The curve is continuous in time: its pieces end between ticks, to 2⁻³² of one, and a block that is
//! left at speed hands the rest of the tick to the next. So the ticks see a curve that keeps its limits
//! everywhere, and no speed is lost where blocks join. Durations are chosen first; the speed in
//! the middle then follows from the length,
//!
//! ```text
//! v = (2L − entry·r₁ − exit·r₂) / (r₁ + r₂ + 2c),
//! ```
//!
//! r₁ and r₂ the durations of the ramps, c that of the cruise, and the jerk from v: the pieces close on the
//! length by construction. The state adds with 64 fraction bits.

use super::error::PathError;
use super::fraction::{speed, whole};
use super::limits::Limits;
use super::ramp::{MOST_TICKS, Ramp, TICK, peak};
use crate::integer::wide_mul_q32;

/// Acceleration up, down, at constant speed: three pieces, one, three.
const PIECES: u8 = 7;

/// The piece at constant speed.
const CRUISE: u8 = 3;

/// A planned curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Profile {
    /// Position units.
    length: i64,
    /// Ticks, 32 fraction bits.
    durations: [u64; PIECES as usize],
    /// Position units per tick, 64 fraction bits.
    entry: i128,
    top: i128,
    /// Position units per tick², 64 fraction bits: at its greatest while speeding up, and slowing down.
    speeding: i128,
    slowing: i128,
    /// A sixth of the jerk of each, 64 fraction bits.
    speeding_jerk_sixth: i128,
    slowing_jerk_sixth: i128,
}

/// How far a curve has come.
///
/// Within a piece the distance after whole ticks is a cubic of their number, so its third difference is
/// constant: three additions go one tick on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Position units, 64 fraction bits, and its differences over the next tick.
    distance: i128,
    step: i128,
    step_change: i128,
    /// The jerk.
    third_difference: i128,
    /// Of this piece, ticks with 32 fraction bits.
    left: u64,
    piece: u8,
}

/// Distance, speed and acceleration at one time, 64 fraction bits.
#[derive(Clone, Copy, Debug)]
struct Motion {
    distance: i128,
    velocity: i128,
    acceleration: i128,
}

/// Where a tick has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// At a distance along the block, position units.
    Within(i64),
    /// The block has ended, with so much of the tick left, 32 fraction bits.
    Beyond(u64),
}

impl Profile {
    /// Plans a length, entered and left at given speeds, as quickly as the limits allow.
    ///
    /// Speeds are per tick with 16 fraction bits, and must lie within reach of each other
    /// ([`super::ramp::reachable`]). Bounded: two divisions a piece, and what [`peak`] takes.
    ///
    /// # Errors
    /// [`PathError::TooLong`] where a ramp would take 2²⁹ ticks, or the rest 2³¹.
    pub fn plan(length: i64, entry: u64, exit: u64, limits: &Limits) -> Result<Self, PathError> {
        let top = peak(length, entry, exit, limits);
        let (up, down) = (Ramp::between(entry, top, limits), Ramp::between(top, exit, limits));
        let [first, last] = [(up, entry), (down, exit)]
            .map(|(ramp, speed)| (u128::from(ramp.duration()) * (u128::from(top) + u128::from(speed))) >> 17);
        // Position units with 32 fraction bits.
        let rest = (u128::from(length.unsigned_abs()) << 32).saturating_sub(first + last);
        let cruise = if top == 0 { 0 } else { (rest << 16).div_ceil(u128::from(top)) };
        Self::close(length, entry, exit, up, down, cruise)
    }

    /// A length at constant speed: what filters behind the interpolation are to smooth.
    ///
    /// # Errors
    /// [`PathError::TooLong`] where it would take 2³¹ ticks or more.
    pub fn steady(length: i64, feed: u64) -> Result<Self, PathError> {
        let cruise = (u128::from(length.unsigned_abs()) << 48).div_ceil(u128::from(feed.max(1)));
        Self::close(length, 0, 0, Ramp::default(), Ramp::default(), cruise)
    }

    /// The speed in the middle and the jerks that make the pieces end on the length.
    fn close(
        length: i64,
        entry: u64,
        exit: u64,
        up: Ramp,
        down: Ramp,
        cruise: u128,
    ) -> Result<Self, PathError> {
        if cruise >= u128::from(MOST_TICKS) << 32 || !up.is_short() || !down.is_short() {
            return Err(PathError::TooLong);
        }
        // 28 fraction bits; a ramp goes no further than the length, so entry·r₁ and exit·r₂ are at most 2L.
        let [entry, exit] = [entry, exit].map(|speed| i128::from(speed) << 12);
        let [r1, r2] = [up, down].map(|ramp| i128::from(ramp.duration()));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_possible_wrap,
            reason = "below 2⁶³, see above"
        )]
        let (cruise, whole) = (cruise as u64, (cruise as i128) * 2 + r1 + r2);
        let top = ((i128::from(length) << 61) - entry * r1 - exit * r2) / whole.max(1);
        let (speeding, speeding_jerk_sixth) = rates(top - entry, up);
        let (slowing, slowing_jerk_sixth) = rates(exit - top, down);
        Ok(Self {
            length,
            durations: [up.rise, up.stand, up.rise, cruise, down.rise, down.stand, down.rise],
            entry: entry << 36,
            top: top << 36,
            speeding,
            slowing,
            speeding_jerk_sixth,
            slowing_jerk_sixth,
        })
    }

    /// A curve that stands still for a number of ticks.
    #[must_use]
    pub const fn dwell(ticks: u64) -> Self {
        Self {
            length: 0,
            durations: [0, 0, 0, ticks << 32, 0, 0, 0],
            entry: 0,
            top: 0,
            speeding: 0,
            slowing: 0,
            speeding_jerk_sixth: 0,
            slowing_jerk_sixth: 0,
        }
    }

    /// Puts a progress at the start of the curve.
    pub fn start(&self, progress: &mut Progress) {
        let [left, ..] = self.durations;
        (progress.piece, progress.left) = (0, left);
        progress.set(&Motion { distance: 0, velocity: self.entry, acceleration: 0 }, self.jerk_sixth(0));
    }

    /// Goes on by a part of a tick, up to [`TICK`].
    pub fn advance(&self, progress: &mut Progress, time: u64) -> Step {
        if time == TICK && progress.left >= TICK {
            progress.left -= TICK;
            progress.whole_tick();
            return Step::Within(progress.distance());
        }
        self.over_pieces(progress, time)
    }

    /// Where the piece ends, or has begun, within the tick.
    #[cold]
    fn over_pieces(&self, progress: &mut Progress, mut time: u64) -> Step {
        let mut motion = progress.motion();
        // At most so many pieces end within a tick.
        for _ in 0..PIECES {
            let part = time.min(progress.left);
            motion.advance(self.jerk_sixth(progress.piece), part);
            progress.left -= part;
            time -= part;
            if progress.left > 0 {
                break;
            }
            if progress.piece + 1 >= PIECES {
                progress.set(&motion, 0);
                return Step::Beyond(time);
            }
            progress.piece += 1;
            progress.left = self.durations.get(usize::from(progress.piece)).copied().unwrap_or(0);
            match progress.piece {
                // Reached by the jerk already, but for its last bits; without a jerk limit it jumps here.
                1 => motion.acceleration = self.speeding,
                CRUISE => (motion.velocity, motion.acceleration) = (self.top, 0),
                5 => motion.acceleration = self.slowing,
                _ => {}
            }
        }
        progress.set(&motion, self.jerk_sixth(progress.piece));
        Step::Within(progress.distance())
    }

    const fn jerk_sixth(&self, piece: u8) -> i128 {
        match piece {
            0 => self.speeding_jerk_sixth,
            2 => -self.speeding_jerk_sixth,
            4 => self.slowing_jerk_sixth,
            6 => -self.slowing_jerk_sixth,
            _ => 0,
        }
    }
}

impl Progress {
    /// In no piece yet.
    pub const NONE: Self =
        Self { distance: 0, step: 0, step_change: 0, third_difference: 0, left: 0, piece: 0 };

    /// Whole position units.
    #[must_use]
    pub const fn distance(&self) -> i64 {
        whole(self.distance)
    }

    /// Position units over the next tick, 16 fraction bits.
    #[must_use]
    pub const fn speed(&self) -> u64 {
        speed(self.step)
    }

    fn whole_tick(&mut self) {
        self.distance += self.step;
        if self.piece != CRUISE {
            self.step += self.step_change;
            self.step_change += self.third_difference;
        }
    }

    /// d(t + 1) − d(t) = v + a/2 + j/6; of that, a + j; of that, j.
    fn set(&mut self, motion: &Motion, jerk_sixth: i128) {
        self.distance = motion.distance;
        self.step = motion.velocity + (motion.acceleration >> 1) + jerk_sixth;
        self.third_difference = 6 * jerk_sixth;
        self.step_change = motion.acceleration + self.third_difference;
    }

    /// The other way round.
    fn motion(&self) -> Motion {
        let acceleration = self.step_change - self.third_difference;
        // The jerk is six times a whole number: a product with 1/6 is off by less than one of them.
        let jerk_sixth = wide_mul_q32(self.third_difference, SIXTH_Q32);
        Motion {
            distance: self.distance,
            velocity: self.step - (acceleration >> 1) - jerk_sixth,
            acceleration,
        }
    }
}

/// 1/6 with 32 fraction bits.
const SIXTH_Q32: u32 = 715_827_883;

impl Motion {
    /// d += t·(v + t·(a/2 + t·j/6)), v += t·(a + t·j/2), a += t·j.
    fn advance(&mut self, jerk_sixth: i128, time: u64) {
        let Ok(time) = u32::try_from(time) else {
            // A whole tick.
            self.distance += self.velocity + (self.acceleration >> 1) + jerk_sixth;
            self.velocity += self.acceleration + 3 * jerk_sixth;
            self.acceleration += 6 * jerk_sixth;
            return;
        };
        if time == 0 {
            return;
        }
        if self.acceleration == 0 && jerk_sixth == 0 {
            self.distance += wide_mul_q32(self.velocity, time);
            return;
        }
        let sixth = wide_mul_q32(jerk_sixth, time);
        let gained = wide_mul_q32(self.acceleration + 3 * sixth, time);
        self.distance +=
            wide_mul_q32(self.velocity + wide_mul_q32((self.acceleration >> 1) + sixth, time), time);
        self.velocity += gained;
        self.acceleration += 6 * sixth;
    }
}

/// Greatest acceleration of a ramp and a sixth of its jerk, 64 fraction bits, for a change of speed with
/// 28 fraction bits: a = Δ/(t + c), j = a/t.
fn rates(change: i128, ramp: Ramp) -> (i128, i128) {
    let steady = u128::from(ramp.rise) + u128::from(ramp.stand);
    if steady == 0 {
        return (0, 0);
    }
    let acceleration = scaled_quotient(change.unsigned_abs() << 4, 64, steady);
    if ramp.rise == 0 {
        return (acceleration * change.signum(), 0);
    }
    let sixth = scaled_quotient(acceleration.unsigned_abs(), 32, 6 * u128::from(ramp.rise));
    // The sixth is what is added up: the acceleration is what it makes of itself.
    (acceleration * change.signum(), sixth * change.signum())
}

/// `value`·2^`shift`/`divisor`, for divisors below 2^(127 − `shift`).
fn scaled_quotient(value: u128, shift: u32, divisor: u128) -> i128 {
    let divisor = divisor.max(1);
    let (whole, rest) = (value / divisor, value % divisor);
    ((whole << shift) + (rest << shift) / divisor).cast_signed()
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use proptest::prelude::*;

    use super::super::ramp::reachable;
    use super::*;

    const ONE: f64 = 18_446_744_073_709_551_616.0;

    fn started(profile: &Profile) -> Progress {
        let mut progress = Progress::NONE;
        profile.start(&mut progress);
        progress
    }

    /// The distance after each tick, with all its fraction bits, started a part of a tick late.
    fn run(profile: &Profile, late: u64) -> Vec<i128> {
        let mut progress = started(profile);
        let mut distances = Vec::new();
        let mut time = TICK - late;
        while let Step::Within(_) = profile.advance(&mut progress, time) {
            distances.push(progress.distance);
            time = TICK;
        }
        distances.push(i128::from(profile.length) << 64);
        distances
    }

    /// Plans with feeds of 1 nm to 50 µm a tick (1 m/s at 20 kHz), ramps of up to some thousand ticks.
    fn plans() -> impl Strategy<Value = (i64, u64, u64, Limits)> {
        let times = (1.0..3000.0f64, 1.0..3000.0f64, any::<bool>());
        ((20.0..36.0f64), (20.0..52.0f64), times, 0.0..1.0f64, 0.0..1.0f64).prop_map(
            |(feed, length, (ramp, rise, jerky), entry, exit)| {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2⁵²")]
                let q16 = |value: f64| (value * 65_536.0) as u64;
                let feed = feed.exp2();
                let jerk = jerky.then(|| q16(feed / ramp / rise).max(1));
                let limits = Limits::new(q16(feed), q16(feed / ramp).max(1), jerk);
                #[expect(clippy::cast_possible_truncation, reason = "below 2⁵²")]
                let length = length.exp2() as i64;
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a share of the feed"
                )]
                let [entry, exit] =
                    [entry, exit].map(|share| (limits.feed as f64 * (2.0 * share - 1.0).max(0.0)) as u64);
                // What look-ahead would make of them.
                let exit = reachable(length, 0, exit, &limits);
                let entry = reachable(length, exit, entry.max(exit), &limits).min(entry);
                let exit = reachable(length, entry, exit.max(entry), &limits).min(exit);
                (length, entry, exit, limits)
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 4 } else { 512 }))]

        /// Feed, acceleration and jerk at every tick to 1e-6 relative (differences of the curve with all its
        /// bits: what a command rounded to position units keeps, but for that rounding), never backwards, the end
        /// met by the pieces themselves to 16 units, and no longer than the limits ask for.
        #[test]
        #[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
        fn keeps_its_limits_at_every_tick((length, entry, exit, limits) in plans(), late in 0..TICK) {
            prop_assume!(u128::from(length.unsigned_abs()) << 16 < u128::from(limits.feed) * 100_000);
            let profile = Profile::plan(length, entry, exit, &limits).unwrap();
            let distances = run(&profile, late);
            prop_assume!(distances.len() > 6);
            let within = &distances[..distances.len() - 1];
            let values = |differences: &[i128]| -> Vec<i128> { differences.windows(2).map(|w| w[1] - w[0]).collect() };
            let velocity = values(within);
            let limit = |q16: u64| q16 as f64 / 65_536.0;
            let most = velocity.iter().fold(0.0f64, |most, &v| most.max(v as f64 / ONE));
            prop_assert!(velocity.iter().all(|&v| v >= -(1 << 44)), "backwards");
            prop_assert!(most <= limit(limits.feed) * (1.0 + 1e-6), "feed {most}");
            let acceleration = values(&velocity);
            // Without jerk limit the very last bits of the speed jump into the cruise.
            let most = acceleration.iter().fold(0.0f64, |most, &a| most.max(a as f64 / ONE).max(-a as f64 / ONE));
            prop_assert!(most <= limit(limits.acceleration) * (1.0 + 1e-6) + 1e-3, "acceleration {most}");
            if let Some(jerk) = limits.jerk {
                let most = values(&acceleration).iter().fold(0.0f64, |most, &j| most.max((j as f64 / ONE).abs()));
                prop_assert!(most <= limit(jerk) * (1.0 + 1e-6) + 1e-3, "jerk {most} of {}", limit(jerk));
            }
            let mut progress = started(&profile);
            while let Step::Within(_) = profile.advance(&mut progress, TICK) {}
            let off = (progress.distance - (i128::from(length) << 64)) as f64 / ONE;
            prop_assert!(off.abs() < 16.0, "{off} units off the end");
        }

        /// From rest to rest the time is L/v + v/A + A/J in the limits' own terms (whichever is not reached
        /// left out), for a length that reaches the feed.
        #[test]
        fn takes_no_longer_than_it_must((_, _, _, limits) in plans(), cruise in 0.0..3.0f64) {
            let [feed, acceleration] = [limits.feed, limits.acceleration].map(|limit| limit as f64 / 65_536.0);
            let jerk = limits.jerk.map(|jerk| jerk as f64 / 65_536.0);
            let ramp = match jerk {
                None => feed / acceleration,
                Some(jerk) if feed * jerk >= acceleration * acceleration => feed / acceleration + acceleration / jerk,
                Some(jerk) => 2.0 * libm::sqrt(feed / jerk),
            };
            #[expect(clippy::cast_possible_truncation, reason = "below 2⁵²")]
            let length = (feed * ramp * (1.0 + cruise)) as i64;
            let profile = Profile::plan(length, 0, 0, &limits).unwrap();
            let ticks = profile.durations.iter().map(|&d| d as f64).sum::<f64>() / TICK as f64;
            let least = length as f64 / feed + ramp;
            // 16 fraction bits of the limits, of which the least is about 2⁻⁸.
            prop_assert!((ticks / least - 1.0).abs() < 1e-3, "{ticks} ticks, expected {least}");
        }
    }

    /// Four jerk phases of T each go 2JT³: 2·1000·100³ = 2·10⁹ units take 400 ticks where neither feed nor
    /// acceleration is reached.
    #[test]
    fn a_short_move_is_all_jerk() {
        let limits = Limits::new(1 << 60, 1 << 50, Some(1000 << 16));
        let profile = Profile::plan(2_000_000_000, 0, 0, &limits).unwrap();
        let ticks = profile.durations.iter().map(|&d| d as f64).sum::<f64>() / TICK as f64;
        assert!((ticks - 400.0).abs() < 1e-3, "{ticks}");
        assert_eq!(profile.durations[3] >> 32, 0);
    }

    #[test]
    fn refuses_what_cannot_be_counted() {
        let slow = Limits::new(1 << 16, 1 << 30, None);
        assert_eq!(Profile::plan(1 << 40, 0, 0, &slow), Err(PathError::TooLong));
        let soft = Limits::new(1 << 55, 1, None);
        assert_eq!(Profile::plan(i64::MAX / 4, 0, 0, &soft), Err(PathError::TooLong));
    }
}
