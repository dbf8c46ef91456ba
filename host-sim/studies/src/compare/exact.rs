//! Where a command should be: the exact path of a block, computed without the interpolator.
//!
//! All that is subtracted is within a few tenths of a metre, where an f64 resolves 1e-8 nm.

use shared::units::{PER_NM, Position};

use super::AXES;
use link::controller::{PathBlock, PathShape};

/// A point on the axes.
pub type Point = [Position; AXES];

/// The exact geometry of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exact {
    /// One point.
    Stand(Point),
    /// From the first point to the second.
    Line(Point, Point),
    /// Whole turns, which end where they start.
    Circle {
        /// Start.
        start: Point,
        /// Centre.
        centre: Point,
    },
}

impl Exact {
    /// The geometry of a block that starts at `start`; arcs of this module are of both axes and of whole
    /// turns.
    #[must_use]
    pub fn of(block: &PathBlock, start: Point) -> Self {
        let point = |m: &[f64]| {
            let coordinate = |i: usize| m.get(i).and_then(|&m| Position::from_m(m)).unwrap_or_default();
            std::array::from_fn(coordinate)
        };
        match &block.shape {
            PathShape::Dwell { .. } => Self::Stand(start),
            PathShape::Line { to_m } => Self::Line(start, point(to_m)),
            PathShape::Arc { centre_m, .. } | PathShape::ArcTo { centre_m, .. } => {
                Self::Circle { start, centre: point(centre_m) }
            }
        }
    }

    /// Where it ends.
    #[must_use]
    pub const fn end(&self) -> Point {
        match self {
            Self::Stand(place) | Self::Line(_, place) | Self::Circle { start: place, .. } => *place,
        }
    }

    /// From the nearest point of the path to a command, nm.
    #[must_use]
    pub fn off_nm(&self, command: Point) -> [f64; AXES] {
        match self {
            Self::Stand(place) => apart_nm(command, *place),
            Self::Line(start, end) => {
                let ([u, v], [x, y]) = (apart_nm(*end, *start), apart_nm(command, *start));
                let along = ((x * u + y * v) / (u * u + v * v)).clamp(0.0, 1.0);
                // The programmed end is exact, and is not to be lost in 1 − ε of its distance.
                if along >= 1.0 { apart_nm(command, *end) } else { [x - along * u, y - along * v] }
            }
            Self::Circle { start, centre } => {
                let radius = length(apart_nm(*start, *centre));
                let [x, y] = apart_nm(command, *centre);
                let beyond = 1.0 - radius / length([x, y]);
                [x * beyond, y * beyond]
            }
        }
    }
}

/// From the second point to the first, nm.
#[must_use]
pub fn apart_nm(a: Point, b: Point) -> [f64; AXES] {
    std::array::from_fn(|i| (a[i] - b[i]) as f64 / PER_NM as f64)
}

/// Length of a vector.
#[must_use]
pub fn length([x, y]: [f64; AXES]) -> f64 {
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::motion::Motion;

    fn at(m: [f64; AXES]) -> Point {
        m.map(|m| Position::from_m(m).unwrap())
    }

    fn within([x, y]: [f64; AXES], [u, v]: [f64; AXES], nm: f64) -> bool {
        (x - u).abs() < nm && (y - v).abs() < nm
    }

    #[test]
    fn a_point_beside_the_path_is_off_by_its_distance() {
        let circle = Exact::of(&Motion::Circle.blocks(1)[1], at([0.1, 0.0]));
        // (0.06, 0.08) lies on the circle; 5 nm further out are 3 and 4 nm. A position unit is 1e-6 nm.
        assert!(within(circle.off_nm(at([0.06 + 3e-9, 0.08 + 4e-9])), [3.0, 4.0], 1e-5));
        let line = Exact::Line(at([0.0, 0.0]), at([0.03, 0.04]));
        // Across the line, by 5 nm.
        assert!(within(line.off_nm(at([0.015 - 4e-9, 0.02 + 3e-9])), [-4.0, 3.0], 1e-5));
        // Beyond its end, by 5 nm.
        assert!(within(line.off_nm(at([0.03 + 3e-9, 0.04 + 4e-9])), [3.0, 4.0], 1e-5));
        assert!(within(Exact::Stand(at([1.0, 1.0])).off_nm(at([1.0 + 1e-9, 1.0])), [1.0, 0.0], 1e-5));
    }
}
