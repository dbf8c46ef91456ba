//! A straight line through N axes.

use super::error::PathError;
use crate::integer::mul_62;
use crate::units::Position;

/// A line as a function of path length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line<const N: usize> {
    start: [Position; N],
    end: [Position; N],
    /// Direction cosines with 62 fraction bits.
    direction: [i64; N],
    length: i64,
}

impl<const N: usize> Line<N> {
    /// Plans the line.
    ///
    /// # Errors
    /// [`PathError::ZeroLength`] if start and end coincide.
    pub fn plan(start: [Position; N], end: [Position; N]) -> Result<Self, PathError> {
        let mut squares = 0u128;
        for (from, to) in start.iter().zip(&end) {
            let distance = u128::from((*to - *from).unsigned_abs());
            squares += distance * distance;
        }
        let length = squares.isqrt();
        if length == 0 {
            return Err(PathError::ZeroLength);
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_possible_wrap,
            reason = "|direction| ≤ 1, length < 2⁵⁹"
        )]
        let cosine = |axis: usize| {
            let distance = i128::from(end[axis] - start[axis]);
            ((distance << 62) / length as i128) as i64
        };
        #[expect(clippy::cast_possible_truncation, reason = "travel is limited to ±100 m, 2⁵⁷ units")]
        Ok(Self { start, end, direction: core::array::from_fn(cosine), length: length as i64 })
    }

    /// Length, position units.
    #[must_use]
    pub const fn length(&self) -> i64 {
        self.length
    }

    /// Direction of travel, a unit vector with 62 fraction bits.
    #[must_use]
    pub const fn direction(&self) -> [i64; N] {
        self.direction
    }

    /// End point.
    #[must_use]
    pub const fn end(&self) -> [Position; N] {
        self.end
    }

    /// The least and the greatest position of each axis.
    #[must_use]
    pub fn bounds(&self) -> [[Position; 2]; N] {
        core::array::from_fn(|i| [self.start[i].min(self.end[i]), self.start[i].max(self.end[i])])
    }

    /// Sets a point to that at a path length, each axis exact to one position unit.
    pub fn set_to(&self, point: &mut [Position; N], length: i64) {
        for ((position, start), direction) in point.iter_mut().zip(self.start).zip(&self.direction) {
            *position = start + mul_62(length, *direction);
        }
    }
}
