//! A block ready to run: its geometry over path length, and the path length over time, in machine units.

use super::arc::Arc;
use super::block::{self, Block, Ramps, Shape};
use super::error::{Field, PathError};
use super::exponential::{self, Exponential};
use super::joint::{BlockEnd, Corner, JointLimits, limits_of_ramps};
use super::limits::Limits;
use super::line::Line;
use super::profile::{self, Profile, Step};
use super::ramp::{MAX_TICKS, reachable};
use super::smooth::CornerRounding;
use crate::units::{self, PER_M, Position};

/// 1 with the 16 fraction bits of speeds, accelerations and jerks.
const ONE: f64 = 65_536.0;

/// Greatest speed, position units per tick: 2 m/s at 1 kHz, 40 m/s at 20 kHz.
const MAX_FEED: f64 = 2_199_023_255_552.0;

/// A planned block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlannedBlock<const N: usize> {
    geometry: Geometry<N>,
    timing: Timing,
    /// Limits of the block.
    limits: Limits,
    /// Limits that `timing` was planned with: those of the block without what its joints take.
    ramp_limits: Limits,
    end_speeds: EndSpeeds,
    /// Corner tolerance, position units; `None`: stop at the end.
    tolerance: Option<u64>,
    /// Entry speed, per tick with 16 fraction bits.
    pub entry: u64,
    /// Exit speed; 0: the path stops there and waits for the axis filters.
    pub exit: u64,
    /// The joint with the previous block.
    pub entry_joint: JointLimits,
    /// The joint with the next block.
    pub exit_joint: JointLimits,
}

/// Position over path length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Geometry<const N: usize> {
    Point([Position; N]),
    Line(Line<N>),
    Arc(Arc<N>),
}

/// Path length over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Timing {
    Profile(Profile),
    Exponential(Exponential),
}

/// Which speeds a block can have at its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EndSpeeds {
    /// Any speed that its ramps can reach.
    Reachable,
    /// Zero.
    Rest,
    /// The feed.
    Feed,
}

/// Progress along a block. `exponential` tells which of the two is in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    profile: profile::Progress,
    lag: exponential::Progress,
    exponential: bool,
}

impl<const N: usize> PlannedBlock<N> {
    /// Plans a block from `start`, from rest to rest, for a command every 1/`rate_hz` and axis filters with the effect
    /// `rounding`.
    ///
    /// # Errors
    /// The [`PathError`] that names what is wrong with the block.
    pub fn new(
        block: &Block<N>,
        start: [Position; N],
        rate_hz: f64,
        rounding: &CornerRounding,
    ) -> Result<Self, PathError> {
        let tolerance = match block.joint {
            block::Joint::Stop => None,
            block::Joint::Within { tolerance_m } => {
                let max = units::TRAVEL_LIMIT_M * PER_M;
                Some(integer(tolerance_m * PER_M, 0.0, max, Field::Tolerance)?)
            }
        };
        let geometry = Geometry::plan(&block.shape, start)?;
        let at_rest = Self {
            geometry,
            timing: Timing::Profile(Profile::default()),
            limits: Limits::new(0, 0, None),
            ramp_limits: Limits::new(0, 0, None),
            end_speeds: EndSpeeds::Rest,
            tolerance,
            entry: 0,
            exit: 0,
            entry_joint: JointLimits::default(),
            exit_joint: JointLimits::default(),
        };
        if let Shape::Dwell { seconds } = block.shape {
            let ticks = integer(seconds * rate_hz, 1.0, MAX_TICKS as f64 - 1.0, Field::Dwell)?;
            return Ok(Self { timing: Timing::Profile(Profile::dwell(ticks)), tolerance: None, ..at_rest });
        }
        let mut limits = block_limits(block, rate_hz)?;
        if let Geometry::Arc(arc) = &geometry {
            limits =
                limits.on_arc(arc.curvature_radius()).reduced_for_correction(arc.correction_per_length());
        }
        let end_speeds = match block.ramps {
            Ramps::Trapezoid | Ramps::SCurve { .. } => EndSpeeds::Reachable,
            Ramps::Exponential => EndSpeeds::Rest,
            Ramps::AfterInterpolation => {
                let stretched = (u128::from(limits.acceleration) * u128::from(rounding.stretch)) >> 16;
                limits.feed = limits.feed.min(u64::try_from(stretched).unwrap_or(u64::MAX)).max(1);
                EndSpeeds::Feed
            }
        };
        let mut planned = Self { limits, ramp_limits: limits, end_speeds, ..at_rest };
        planned.timing = planned.plan_timing()?;
        Ok(planned)
    }

    /// Plans the timing again for the entry and exit speeds that look-ahead has found.
    pub fn set_end_speeds(&mut self, entry: u64, exit: u64) {
        let limits = self.limits_of_ramps();
        if (entry, exit) == (self.entry, self.exit) && limits == self.ramp_limits {
            return;
        }
        (self.entry, self.exit, self.ramp_limits) = (entry, exit, limits);
        // Higher end speeds take less time: a block that was not too long does not become so.
        if let Ok(timing) = self.plan_timing() {
            self.timing = timing;
        }
    }

    fn plan_timing(&self) -> Result<Timing, PathError> {
        let length = self.length();
        Ok(match self.end_speeds {
            _ if length == 0 => self.timing,
            EndSpeeds::Reachable => {
                Timing::Profile(Profile::plan(length, self.entry, self.exit, &self.ramp_limits)?)
            }
            EndSpeeds::Feed => Timing::Profile(Profile::steady(length, self.limits.feed)?),
            EndSpeeds::Rest => Timing::Exponential(Exponential::plan(length, &self.limits)?),
        })
    }

    fn limits_of_ramps(&self) -> Limits {
        limits_of_ramps(&self.limits, &self.entry_joint, &self.exit_joint)
    }

    /// The joint with the next block.
    #[must_use]
    pub fn joint_with(&self, next: &Self, rounding: &CornerRounding) -> JointLimits {
        let (Some(tolerance), Some((_, from)), Some((to, _))) = (self.tolerance, self.ends(), next.ends())
        else {
            return JointLimits::default();
        };
        let limits = self.limits.intersection(&next.limits);
        let length = self.length().min(next.length()).unsigned_abs();
        let plan = |ramp_acceleration| {
            let (from, to, limits) = (&from, &to, &limits);
            JointLimits::plan(&Corner { from, to, limits, ramp_acceleration, rounding, tolerance, length })
        };
        match (self.end_speeds, next.end_speeds) {
            (EndSpeeds::Reachable, EndSpeeds::Reachable) => {
                plan(self.limits.acceleration.max(next.limits.acceleration))
            }
            // Without ramps the joint is passed at the common feed or not at all.
            (EndSpeeds::Feed, EndSpeeds::Feed) if self.limits.feed == next.limits.feed => {
                Some(plan(0)).filter(|joint| joint.speed == limits.feed).unwrap_or_default()
            }
            _ => JointLimits::default(),
        }
    }

    /// The greatest speed up to `max` at one end for a given speed at the other.
    #[must_use]
    pub fn reachable(&self, speed: u64, max: u64) -> u64 {
        match self.end_speeds {
            EndSpeeds::Reachable if max > speed => {
                reachable(self.length(), speed, max, &self.limits_of_ramps())
            }
            _ => max,
        }
    }

    /// Start and end with their directions; `None` for a dwell.
    fn ends(&self) -> Option<(BlockEnd<N>, BlockEnd<N>)> {
        match &self.geometry {
            Geometry::Point(_) => None,
            Geometry::Line(line) => {
                let end = BlockEnd { direction: line.direction(), radius: None };
                Some((end, end))
            }
            Geometry::Arc(arc) => {
                let end = |length| BlockEnd {
                    direction: arc.direction(length),
                    radius: Some(arc.curvature_radius()),
                };
                Some((end(0), end(arc.length())))
            }
        }
    }

    /// Path length, position units.
    #[must_use]
    pub const fn length(&self) -> i64 {
        match &self.geometry {
            Geometry::Point(_) => 0,
            Geometry::Line(line) => line.length(),
            Geometry::Arc(arc) => arc.length(),
        }
    }

    /// Greatest acceleration along the path, per tick² with 16 fraction bits.
    #[must_use]
    pub const fn acceleration(&self) -> u64 {
        self.limits.acceleration
    }

    /// Greatest speed along the path, per tick with 16 fraction bits.
    #[must_use]
    pub const fn feed(&self) -> u64 {
        self.limits.feed
    }

    /// End point.
    #[must_use]
    pub const fn end(&self) -> [Position; N] {
        match &self.geometry {
            Geometry::Point(position) => *position,
            Geometry::Line(line) => line.end(),
            Geometry::Arc(arc) => arc.end(),
        }
    }

    /// The least and the greatest position of each axis.
    #[must_use]
    pub fn bounds(&self) -> [[Position; 2]; N] {
        match &self.geometry {
            Geometry::Point(position) => position.map(|position| [position; 2]),
            Geometry::Line(line) => line.bounds(),
            Geometry::Arc(arc) => arc.bounds(),
        }
    }

    /// Sets a progress to the start of the block.
    #[cold]
    #[inline(never)]
    pub fn start(&self, progress: &mut Progress) {
        match &self.timing {
            Timing::Profile(profile) => {
                progress.exponential = false;
                profile.start(&mut progress.profile);
            }
            Timing::Exponential(_) => {
                (progress.exponential, progress.lag) = (true, exponential::Progress::NONE);
            }
        }
    }

    /// Advances by a time up to a tick, 32 fraction bits.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a call in every tick")]
    pub fn advance(&self, progress: &mut Progress, time: u64) -> Step {
        match &self.timing {
            Timing::Profile(profile) => profile.advance(&mut progress.profile, time),
            Timing::Exponential(curve) => match curve.advance(&mut progress.lag, time) {
                (_, true) => Step::Beyond(0),
                (length, false) => Step::Within(length),
            },
        }
    }

    /// Sets a point to that at a path length. Whether the block moves.
    pub fn set_to(&self, point: &mut [Position; N], length: i64) -> bool {
        match &self.geometry {
            Geometry::Point(position) => {
                *point = *position;
                return false;
            }
            Geometry::Line(line) => line.set_to(point, length),
            Geometry::Arc(arc) => arc.set_to(point, length),
        }
        true
    }
}

impl Progress {
    /// Not started.
    pub const NONE: Self =
        Self { profile: profile::Progress::NONE, lag: exponential::Progress::NONE, exponential: false };

    /// See [`profile::Progress::take_segment_end`].
    pub const fn take_segment_end(&mut self) -> bool {
        self.profile.take_segment_end()
    }

    /// Path length from the start of the block, position units.
    #[must_use]
    pub const fn distance(&self) -> i64 {
        if self.exponential { self.lag.distance() } else { self.profile.distance() }
    }

    /// Speed, per tick with 16 fraction bits.
    #[must_use]
    pub const fn speed(&self) -> u64 {
        if self.exponential { self.lag.speed() } else { self.profile.speed() }
    }
}

impl<const N: usize> Geometry<N> {
    fn plan(shape: &Shape<N>, start: [Position; N]) -> Result<Self, PathError> {
        let centre = |[x, y]: [f64; 2]| Ok([position(x, Field::Centre)?, position(y, Field::Centre)?]);
        Ok(match *shape {
            Shape::Dwell { .. } => Self::Point(start),
            Shape::Line { to_m } => {
                let mut end = start;
                for (coordinate, &m) in end.iter_mut().zip(&to_m) {
                    *coordinate = position(m, Field::EndPoint)?;
                }
                Self::Line(Line::plan(start, end)?)
            }
            Shape::Arc { plane, centre_m, turns } => {
                let plane = plane_of::<N>(plane)?;
                Self::Arc(Arc::plan(start, plane, centre(centre_m)?, turns)?)
            }
            Shape::ArcTo { plane, centre_m, to_m: [x, y], positive } => {
                let plane = plane_of::<N>(plane)?;
                let end = [position(x, Field::EndPoint)?, position(y, Field::EndPoint)?];
                Self::Arc(Arc::plan_to(start, plane, centre(centre_m)?, end, positive)?)
            }
        })
    }
}

/// The plane of an arc, checked before anything else: a machine of one axis has none.
fn plane_of<const N: usize>(plane: [u8; 2]) -> Result<[usize; 2], PathError> {
    let [first, second] = plane.map(usize::from);
    if first == second || first.max(second) >= N {
        return Err(PathError::BadPlane);
    }
    Ok([first, second])
}

/// Feed, acceleration and jerk of a block per tick with 16 fraction bits, rounded down.
fn block_limits<const N: usize>(block: &Block<N>, rate_hz: f64) -> Result<Limits, PathError> {
    let feed = block.feed_m_per_s * PER_M / rate_hz;
    let acceleration = block.acceleration_m_per_s2 * PER_M / (rate_hz * rate_hz);
    let jerk = match block.ramps {
        Ramps::SCurve { jerk_m_per_s3 } => {
            let jerk = jerk_m_per_s3 * PER_M / (rate_hz * rate_hz * rate_hz);
            Some(integer(jerk * ONE, 1.0, MAX_FEED * ONE, Field::Jerk)?)
        }
        _ => None,
    };
    // A feed below one position unit per tick would be lost in rounding.
    let feed = integer(feed * ONE, ONE, MAX_FEED * ONE, Field::Feed)?;
    let acceleration = integer(acceleration * ONE, 1.0, MAX_FEED * ONE, Field::Acceleration)?;
    // The rise time A/J has 32 fraction bits; a rise below 1/16 tick would not reach the acceleration accurately.
    let jerk = jerk.map(|jerk| jerk.min(acceleration.saturating_mul(16)));
    Ok(Limits::new(feed, acceleration, jerk))
}

fn position(m: f64, field: Field) -> Result<Position, PathError> {
    if !m.is_finite() {
        return Err(PathError::NotFinite(field));
    }
    Position::from_m(m).ok_or(PathError::TooLarge(field))
}

/// A number from `min` to `max`, rounded down.
fn integer(value: f64, min: f64, max: f64, field: Field) -> Result<u64, PathError> {
    if !value.is_finite() {
        return Err(PathError::NotFinite(field));
    }
    if value < min {
        return Err(PathError::NotPositive(field));
    }
    if value > max {
        return Err(PathError::TooLarge(field));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "0 ≤ min ≤ value ≤ max < 2⁶⁴"
    )]
    Ok(value as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interpolate::smooth::{Filter, Smoothing};

    const RATE_HZ: f64 = 4000.0;

    fn planned(block: &Block<2>, start_m: [f64; 2], rounding: &CornerRounding) -> PlannedBlock<2> {
        let start = start_m.map(|m| Position::from_m(m).unwrap());
        PlannedBlock::new(block, start, RATE_HZ, rounding).unwrap()
    }

    /// What a joint takes changes the ramps also where the speeds at the ends stay.
    #[test]
    fn ramps_are_planned_again_for_what_a_joint_takes() {
        let block = planned(&Block::line([0.1, 0.0], 0.1, 2.0), [0.0; 2], &CornerRounding::NONE);
        let mut changed = block;
        changed.exit_joint.acceleration = block.limits.acceleration / 2;
        changed.set_end_speeds(0, 0);
        assert_eq!(
            changed.timing,
            planned(&Block::line([0.1, 0.0], 0.1, 1.0), [0.0; 2], &CornerRounding::NONE).timing
        );
        let mut same = block;
        same.set_end_speeds(0, 0);
        assert_eq!(same, block);
    }

    /// Without ramps the speed cannot change between blocks: a joint on a straight line is passed at the feed, if it is that of both.
    #[test]
    fn blocks_without_ramps_are_joined_at_their_common_feed() {
        let rounding = Filter::new(&Smoothing::Trapezoid { time_s: 0.1 }, RATE_HZ).unwrap().rounding();
        let line = |to: f64, feed| {
            Block::line([to, 0.0], feed, 2.0).with_ramps(Ramps::AfterInterpolation).within(1e-3)
        };
        let first = planned(&line(0.1, 0.1), [0.0; 2], &rounding);
        for (feed, passes) in [(0.1, true), (0.05, false), (0.15, false)] {
            let joint = first.joint_with(&planned(&line(0.2, feed), [0.1, 0.0], &rounding), &rounding);
            let expected = if passes { first.limits.feed } else { 0 };
            assert_eq!(joint.speed, expected, "{feed} m/s");
        }
    }

    #[test]
    fn numbers_end_at_their_limits() {
        let within = |value| integer(value, 1.0, 10.0, Field::Feed);
        assert_eq!((within(1.0), within(10.0), within(9.99)), (Ok(1), Ok(10), Ok(9)));
        assert_eq!(within(0.999), Err(PathError::NotPositive(Field::Feed)));
        assert_eq!(within(10.001), Err(PathError::TooLarge(Field::Feed)));
        assert_eq!(within(f64::NAN), Err(PathError::NotFinite(Field::Feed)));
    }

    /// The plane is checked before the numbers.
    #[test]
    fn a_plane_has_two_axes_of_the_machine() {
        for plane in [[0, 0], [1, 1], [0, 2], [2, 1]] {
            let block = Block::arc(plane, [f64::NAN, 0.0], 1.0, 0.1, 1.0);
            let error =
                PlannedBlock::new(&block, [Position(0); 2], RATE_HZ, &CornerRounding::NONE).unwrap_err();
            assert_eq!(error, PathError::BadPlane, "{plane:?}");
        }
    }
}
