//! One piece of a path: a line, or an arc of at most a quarter turn.

use std::f64::consts::{PI, TAU};

use super::vector::{Point, dot, minus, plus};

/// Geometry of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    /// A line in the direction of a unit vector.
    Line { direction: Point },
    /// An arc in the plane of two axes. `sense` is 1 from the first axis to the second, −1 the other way.
    Arc { plane: [usize; 2], centre: [f64; 2], radius: f64, start_rad: f64, sense: f64 },
}

/// A piece with its position on the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece {
    /// Its first point, m.
    pub from: Point,
    pub shape: Shape,
    /// Length of the path before it, m.
    pub start_m: f64,
    /// Its own length, m.
    pub length_m: f64,
    /// Index of its block.
    pub block: usize,
}

impl Piece {
    /// Length of the path up to its end, m.
    pub fn end_m(&self) -> f64 {
        self.start_m + self.length_m
    }

    /// The point at a distance along the piece, m.
    pub fn point(&self, along_m: f64) -> Point {
        match &self.shape {
            Shape::Line { direction } => plus(&self.from, along_m, direction),
            Shape::Arc { plane, centre, radius, start_rad, sense } => {
                let (sin, cos) = libm::sincos(start_rad + sense * along_m / radius);
                let mut point = self.from;
                point[plane[0]] = centre[0] + radius * cos;
                point[plane[1]] = centre[1] + radius * sin;
                point
            }
        }
    }

    /// Unit vector of the direction of travel at a distance along the piece, m.
    pub fn tangent(&self, along_m: f64) -> Point {
        match &self.shape {
            Shape::Line { direction } => *direction,
            Shape::Arc { plane, radius, start_rad, sense, .. } => {
                let (sin, cos) = libm::sincos(start_rad + sense * along_m / radius);
                let mut tangent = [0.0; 3];
                tangent[plane[0]] = -sense * sin;
                tangent[plane[1]] = sense * cos;
                tangent
            }
        }
    }

    /// Distance along the piece, between two limits, of its point nearest to `point`, m.
    pub fn nearest_along(&self, point: &Point, min_m: f64, max_m: f64) -> f64 {
        let along_m = match &self.shape {
            Shape::Line { direction } => dot(&minus(point, &self.from), direction),
            Shape::Arc { plane, centre, radius, start_rad, sense } => {
                let angle = libm::atan2(point[plane[1]] - centre[1], point[plane[0]] - centre[0]);
                // Within half a turn of the middle of the piece, so that the limits clamp to the nearer end.
                let middle = 0.5 * self.length_m / radius;
                let from_middle = (sense * (angle - start_rad) - middle + PI).rem_euclid(TAU) - PI;
                (middle + from_middle) * radius
            }
        };
        along_m.clamp(min_m, max_m)
    }
}
