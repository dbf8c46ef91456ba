//! A block made ready for the tick: geometry and speed profile in machine units.

use super::arc::Arc;
use super::block::{Block, Shape};
use super::line::Line;
use super::trapezoid::{Limits, Progress, Trapezoid};
use super::{Field, PathError};
use crate::units::{PER_M, Position};

/// Longest dwell, s: a day.
const LONGEST_DWELL_S: f64 = 86_400.0;

/// A planned block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Planned<const N: usize> {
    geometry: Geometry<N>,
    profile: Trapezoid,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Geometry<const N: usize> {
    Stand([Position; N]),
    Line(Line<N>),
    Arc(Arc<N>),
}

impl<const N: usize> Planned<N> {
    /// Plans a block that starts at `start`, for a command every 1/`rate_hz`.
    ///
    /// # Errors
    /// The [`PathError`] that names what is wrong with the block.
    pub fn new(block: &Block<N>, start: [Position; N], rate_hz: f64) -> Result<Self, PathError> {
        let geometry = match block.shape {
            Shape::Dwell { seconds } => {
                let ticks = whole(seconds * rate_hz, LONGEST_DWELL_S * rate_hz, Field::Dwell)?;
                return Ok(Self { geometry: Geometry::Stand(start), profile: Trapezoid::dwell(ticks) });
            }
            Shape::Line { to_m } => {
                let mut end = start;
                for (place, &m) in end.iter_mut().zip(&to_m) {
                    *place = position(m, Field::EndPoint)?;
                }
                Geometry::Line(Line::plan(start, end)?)
            }
            Shape::Arc { plane, centre_m: [x, y], turns } => {
                let centre = [position(x, Field::Centre)?, position(y, Field::Centre)?];
                Geometry::Arc(Arc::plan(start, plane.map(usize::from), centre, turns)?)
            }
        };
        let limits = Limits {
            feed: whole(block.feed_m_per_s * PER_M / rate_hz, 1e15, Field::Feed)?,
            acceleration: whole(
                block.acceleration_m_per_s2 * PER_M / (rate_hz * rate_hz),
                1e15,
                Field::Acceleration,
            )?,
        };
        let length = match &geometry {
            Geometry::Stand(_) => 0,
            Geometry::Line(line) => line.length(),
            Geometry::Arc(arc) => arc.length(),
        };
        Ok(Self { geometry, profile: Trapezoid::plan(length, limits) })
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

    /// Ticks from start to end.
    #[must_use]
    pub const fn ticks(&self) -> u64 {
        self.profile.ticks()
    }

    /// Goes one tick on. The command, and whether the block has ended with it.
    #[must_use]
    pub fn advance(&self, progress: &mut Progress) -> ([Position; N], bool) {
        let (distance, ended) = self.profile.advance(progress);
        if ended {
            return (self.end(), true);
        }
        let point = match &self.geometry {
            Geometry::Stand(place) => *place,
            Geometry::Line(line) => line.at(distance),
            Geometry::Arc(arc) => arc.at(distance),
        };
        (point, false)
    }
}

fn position(m: f64, field: Field) -> Result<Position, PathError> {
    if !m.is_finite() {
        return Err(PathError::NotFinite(field));
    }
    Position::from_m(m).ok_or(PathError::TooLarge(field))
}

/// A number that must be at least 1 and at most `most`, rounded down so that a limit is kept.
fn whole(value: f64, most: f64, field: Field) -> Result<u64, PathError> {
    if !value.is_finite() {
        return Err(PathError::NotFinite(field));
    }
    if value < 1.0 {
        return Err(PathError::NotPositive(field));
    }
    if value > most {
        return Err(PathError::TooLarge(field));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 ≤ value ≤ most")]
    Ok(value as u64)
}
