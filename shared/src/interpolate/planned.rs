//! A block made ready for the tick: geometry and length over time in machine units.

use super::arc::Arc;
use super::block::{self, Block, Ramps, Shape};
use super::error::{Field, PathError};
use super::exponential::{self, Exponential};
use super::joint::{End, Joint, limits_of_ramps};
use super::limits::Limits;
use super::line::Line;
use super::profile::{self, Profile, Step};
use super::ramp::{MOST_TICKS, reachable};
use super::smooth::Rounding;
use crate::units::{self, PER_M, Position};

/// Fraction bits of speeds, accelerations and jerks.
const ONE: f64 = 65_536.0;

/// Greatest speed, position units per tick: 2 m/s at 1 kHz, 40 m/s at 20 kHz.
const MOST_FEED: f64 = 2_199_023_255_552.0;

/// A planned block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Planned<const N: usize> {
    geometry: Geometry<N>,
    time: Time,
    /// What the time was planned within: `limits` but for what the joints take.
    timed_within: Limits,
    limits: Limits,
    ramps: Kind,
    /// Position units; `None`: stop.
    tolerance: Option<u64>,
    /// Speed at which the block is entered, per tick with 16 fraction bits.
    pub entry: u64,
    /// Speed at which it is left; 0: the path stops there, and waits for the filters behind it.
    pub exit: u64,
    /// The joint with the block before.
    pub enters: Joint,
    /// The joint with the block behind.
    pub leaves: Joint,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Geometry<const N: usize> {
    Stand([Position; N]),
    Line(Line<N>),
    Arc(Arc<N>),
}

/// Length over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Time {
    Pieces(Profile),
    Lag(Exponential),
}

/// What the speeds at the ends may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Anything that is within reach.
    Ramps,
    /// Nothing but rest.
    FromRest,
    /// Nothing but the feed.
    Steady,
}

/// How far a block has come; one of the two is in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    pieces: profile::Progress,
    lag: exponential::Progress,
    lags: bool,
}

impl<const N: usize> Planned<N> {
    /// Plans a block that starts at `start`, from rest to rest, for a command every 1/`rate_hz` and filters
    /// behind the path that round as `rounding` says.
    ///
    /// # Errors
    /// The [`PathError`] that names what is wrong with the block.
    pub fn new(
        block: &Block<N>,
        start: [Position; N],
        rate_hz: f64,
        rounding: &Rounding,
    ) -> Result<Self, PathError> {
        let tolerance = match block.joint {
            block::Joint::Stop => None,
            block::Joint::Within { tolerance_m } => {
                Some(whole(tolerance_m * PER_M, 0.0, units::TRAVEL_LIMIT_M * PER_M, Field::Tolerance)?)
            }
        };
        let geometry = Geometry::plan(&block.shape, start)?;
        let rest = Self {
            geometry,
            time: Time::Pieces(Profile::default()),
            timed_within: Limits::new(0, 0, None),
            limits: Limits::new(0, 0, None),
            ramps: Kind::FromRest,
            tolerance,
            entry: 0,
            exit: 0,
            enters: Joint::default(),
            leaves: Joint::default(),
        };
        if let Shape::Dwell { seconds } = block.shape {
            let ticks = whole(seconds * rate_hz, 1.0, MOST_TICKS as f64 - 1.0, Field::Dwell)?;
            return Ok(Self { time: Time::Pieces(Profile::dwell(ticks)), tolerance: None, ..rest });
        }
        let mut limits = limits(block, rate_hz)?;
        if let Geometry::Arc(arc) = &geometry {
            limits = limits.on_radius(arc.curvature_radius()).less(arc.off_per_length());
        }
        let ramps = match block.ramps {
            Ramps::Trapezoid | Ramps::SCurve { .. } => Kind::Ramps,
            Ramps::Exponential => Kind::FromRest,
            Ramps::AfterInterpolation => {
                let stretched = (u128::from(limits.acceleration) * u128::from(rounding.stretch)) >> 16;
                limits.feed = limits.feed.min(u64::try_from(stretched).unwrap_or(u64::MAX)).max(1);
                Kind::Steady
            }
        };
        let mut planned = Self { limits, timed_within: limits, ramps, ..rest };
        planned.time = planned.timed()?;
        Ok(planned)
    }

    /// Plans the time again between speeds that look-ahead has found for its ends.
    pub fn pass(&mut self, entry: u64, exit: u64) {
        let limits = self.limits_of_ramps();
        if (entry, exit) == (self.entry, self.exit) && limits == self.timed_within {
            return;
        }
        (self.entry, self.exit, self.timed_within) = (entry, exit, limits);
        // Faster ends take less time: what was not too long does not become it.
        if let Ok(time) = self.timed() {
            self.time = time;
        }
    }

    fn timed(&self) -> Result<Time, PathError> {
        let length = self.length();
        Ok(match self.ramps {
            _ if length == 0 => self.time,
            Kind::Ramps => Time::Pieces(Profile::plan(length, self.entry, self.exit, &self.timed_within)?),
            Kind::Steady => Time::Pieces(Profile::steady(length, self.limits.feed)?),
            Kind::FromRest => Time::Lag(Exponential::plan(length, &self.limits)?),
        })
    }

    fn limits_of_ramps(&self) -> Limits {
        limits_of_ramps(&self.limits, &self.enters, &self.leaves)
    }

    /// How the path passes from this block to the next.
    #[must_use]
    pub fn joint_with(&self, next: &Self, rounding: &Rounding) -> Joint {
        let (Some(tolerance), Some((_, from)), Some((to, _))) = (self.tolerance, self.ends(), next.ends())
        else {
            return Joint::default();
        };
        let limits = self.limits.both(&next.limits);
        let length = self.length().min(next.length()).unsigned_abs();
        let between = |ramps| Joint::between(&from, &to, &limits, ramps, rounding, tolerance, length);
        match (self.ramps, next.ramps) {
            (Kind::Ramps, Kind::Ramps) => between(self.limits.acceleration.max(next.limits.acceleration)),
            // Without ramps it is the feed of both or nothing.
            (Kind::Steady, Kind::Steady) if self.limits.feed == next.limits.feed => {
                Some(between(0)).filter(|joint| joint.speed == limits.feed).unwrap_or_default()
            }
            _ => Joint::default(),
        }
    }

    /// The greatest speed up to `most` at one end for a speed at the other.
    #[must_use]
    pub fn reachable(&self, speed: u64, most: u64) -> u64 {
        match self.ramps {
            Kind::Ramps if most > speed => reachable(self.length(), speed, most, &self.limits_of_ramps()),
            _ => most,
        }
    }

    /// Direction and curvature at both ends, where there is a direction.
    fn ends(&self) -> Option<(End<N>, End<N>)> {
        match &self.geometry {
            Geometry::Stand(_) => None,
            Geometry::Line(line) => {
                let end = End { direction: line.direction(), radius: None };
                Some((end, end))
            }
            Geometry::Arc(arc) => {
                let end = |distance| End {
                    direction: arc.direction(distance),
                    radius: Some(arc.curvature_radius()),
                };
                Some((end(0), end(arc.length())))
            }
        }
    }

    /// Distance from start to end, position units.
    #[must_use]
    pub const fn length(&self) -> i64 {
        match &self.geometry {
            Geometry::Stand(_) => 0,
            Geometry::Line(line) => line.length(),
            Geometry::Arc(arc) => arc.length(),
        }
    }

    /// Greatest acceleration along the path, per tick² with 16 fraction bits.
    #[must_use]
    pub const fn acceleration(&self) -> u64 {
        self.limits.acceleration
    }

    /// Where the block ends.
    #[must_use]
    pub const fn end(&self) -> [Position; N] {
        match &self.geometry {
            Geometry::Stand(place) => *place,
            Geometry::Line(line) => line.end(),
            Geometry::Arc(arc) => arc.end(),
        }
    }

    /// The least and the greatest position of each axis on the block.
    #[must_use]
    pub fn extent(&self) -> [[Position; 2]; N] {
        match &self.geometry {
            Geometry::Stand(place) => place.map(|place| [place; 2]),
            Geometry::Line(line) => line.extent(),
            Geometry::Arc(arc) => arc.extent(),
        }
    }

    /// Puts a progress at the start of the block.
    pub fn start(&self, progress: &mut Progress) {
        match &self.time {
            Time::Pieces(profile) => {
                progress.lags = false;
                profile.start(&mut progress.pieces);
            }
            Time::Lag(_) => (progress.lags, progress.lag) = (true, exponential::Progress::NONE),
        }
    }

    /// Goes on by a part of a tick.
    pub fn advance(&self, progress: &mut Progress, time: u64) -> Step {
        match &self.time {
            Time::Pieces(profile) => profile.advance(&mut progress.pieces, time),
            Time::Lag(curve) => match curve.advance(&mut progress.lag) {
                (_, true) => Step::Beyond(0),
                (distance, false) => Step::Within(distance),
            },
        }
    }

    /// The point at a distance from the start.
    #[must_use]
    pub fn at(&self, distance: i64) -> [Position; N] {
        match &self.geometry {
            Geometry::Stand(place) => *place,
            Geometry::Line(line) => line.at(distance),
            Geometry::Arc(arc) => arc.at(distance),
        }
    }
}

impl Progress {
    /// Of a block that has not been started.
    pub const NONE: Self =
        Self { pieces: profile::Progress::NONE, lag: exponential::Progress::NONE, lags: false };

    /// Position units from the start of the block.
    #[must_use]
    pub const fn distance(&self) -> i64 {
        if self.lags { self.lag.distance() } else { self.pieces.distance() }
    }

    /// Speed, per tick with 16 fraction bits.
    #[must_use]
    pub const fn speed(&self) -> u64 {
        if self.lags { self.lag.speed() } else { self.pieces.speed() }
    }
}

impl<const N: usize> Geometry<N> {
    fn plan(shape: &Shape<N>, start: [Position; N]) -> Result<Self, PathError> {
        let centre = |[x, y]: [f64; 2]| Ok([position(x, Field::Centre)?, position(y, Field::Centre)?]);
        Ok(match *shape {
            Shape::Dwell { .. } => Self::Stand(start),
            Shape::Line { to_m } => {
                let mut end = start;
                for (place, &m) in end.iter_mut().zip(&to_m) {
                    *place = position(m, Field::EndPoint)?;
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

/// An arc's plane, refused before anything else of the block: a machine of one axis has none.
fn plane_of<const N: usize>(plane: [u8; 2]) -> Result<[usize; 2], PathError> {
    let [first, second] = plane.map(usize::from);
    if first == second || first.max(second) >= N {
        return Err(PathError::BadPlane);
    }
    Ok([first, second])
}

/// Feed, acceleration and jerk of a block per tick with 16 fraction bits, rounded down so that they are kept.
fn limits<const N: usize>(block: &Block<N>, rate_hz: f64) -> Result<Limits, PathError> {
    let feed = block.feed_m_per_s * PER_M / rate_hz;
    let acceleration = block.acceleration_m_per_s2 * PER_M / (rate_hz * rate_hz);
    let jerk = match block.ramps {
        Ramps::SCurve { jerk_m_per_s3 } => {
            let jerk = jerk_m_per_s3 * PER_M / (rate_hz * rate_hz * rate_hz);
            Some(whole(jerk * ONE, 1.0, MOST_FEED * ONE, Field::Jerk)?)
        }
        _ => None,
    };
    // A feed below one position unit a tick would be lost in rounding.
    let feed = whole(feed * ONE, ONE, MOST_FEED * ONE, Field::Feed)?;
    let acceleration = whole(acceleration * ONE, 1.0, MOST_FEED * ONE, Field::Acceleration)?;
    // The rise of a ramp is counted in parts of a tick: with a few of them its acceleration would not be met.
    let jerk = jerk.map(|jerk| jerk.min(acceleration.saturating_mul(16)));
    Ok(Limits::new(feed, acceleration, jerk))
}

fn position(m: f64, field: Field) -> Result<Position, PathError> {
    if !m.is_finite() {
        return Err(PathError::NotFinite(field));
    }
    Position::from_m(m).ok_or(PathError::TooLarge(field))
}

/// A number from `least` to `most`, rounded down.
fn whole(value: f64, least: f64, most: f64, field: Field) -> Result<u64, PathError> {
    if !value.is_finite() {
        return Err(PathError::NotFinite(field));
    }
    if value < least {
        return Err(PathError::NotPositive(field));
    }
    if value > most {
        return Err(PathError::TooLarge(field));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "0 ≤ least ≤ value ≤ most < 2⁶⁴"
    )]
    Ok(value as u64)
}
