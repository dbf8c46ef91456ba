//! The exact path of a block, computed from its geometry without the interpolator.

use shared::units::Position;

use super::point::{AXES, Point, difference_nm, length};
use motion::{PathBlock, PathShape};

/// The exact geometry of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExactPath {
    /// A standstill.
    Stand(Point),
    /// A line from the first point to the second.
    Line(Point, Point),
    /// Whole turns of a circle.
    Circle {
        /// Start, and end.
        start: Point,
        /// Centre.
        centre: Point,
    },
}

impl ExactPath {
    /// The geometry of a block that starts at `start`; arcs are taken for whole turns in both axes.
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

    /// The end of the block.
    #[must_use]
    pub const fn end(&self) -> Point {
        match self {
            Self::Stand(end) | Self::Line(_, end) | Self::Circle { start: end, .. } => *end,
        }
    }

    /// The vector from the nearest point of the path to a command, nm.
    #[must_use]
    pub fn error_nm(&self, command: Point) -> [f64; AXES] {
        match self {
            Self::Stand(point) => difference_nm(command, *point),
            Self::Line(start, end) => {
                let ([u, v], [x, y]) = (difference_nm(*end, *start), difference_nm(command, *start));
                let along = ((x * u + y * v) / (u * u + v * v)).clamp(0.0, 1.0);
                // At the programmed end the result must be exact; it would be off by rounding of `along`.
                if along >= 1.0 { difference_nm(command, *end) } else { [x - along * u, y - along * v] }
            }
            Self::Circle { start, centre } => {
                let radius = length(difference_nm(*start, *centre));
                let [x, y] = difference_nm(command, *centre);
                let excess = 1.0 - radius / length([x, y]);
                [x * excess, y * excess]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::motion::Motion;

    fn at(m: [f64; AXES]) -> Point {
        m.map(|m| Position::from_m(m).unwrap())
    }

    fn is_near([x, y]: [f64; AXES], [u, v]: [f64; AXES], nm: f64) -> bool {
        (x - u).abs() < nm && (y - v).abs() < nm
    }

    #[test]
    fn the_error_is_the_vector_from_the_nearest_point() {
        let circle = ExactPath::of(&Motion::Circle.blocks(1)[1], at([0.1, 0.0]));
        // (0.06, 0.08) lies on the circle; 5 nm further out are 3 and 4 nm. A position unit is 1e-6 nm.
        assert!(is_near(circle.error_nm(at([0.06 + 3e-9, 0.08 + 4e-9])), [3.0, 4.0], 1e-5));
        let line = ExactPath::Line(at([0.0, 0.0]), at([0.03, 0.04]));
        // Across the line, by 5 nm.
        assert!(is_near(line.error_nm(at([0.015 - 4e-9, 0.02 + 3e-9])), [-4.0, 3.0], 1e-5));
        // Beyond its end, by 5 nm.
        assert!(is_near(line.error_nm(at([0.03 + 3e-9, 0.04 + 4e-9])), [3.0, 4.0], 1e-5));
        assert!(is_near(ExactPath::Stand(at([1.0, 1.0])).error_nm(at([1.0 + 1e-9, 1.0])), [1.0, 0.0], 1e-5));
    }
}
