//! A path in f32 metres, to show the rounding error of such positions.
//!
//! The length of each step is that of the exact path. The position along the path is a sum of these steps in f32, and
//! the point on the path is computed from it in f32.

use shared::units::Position;

use super::point::{AXES, Point, difference_nm, length};
use motion::{PathBlock, PathShape};

/// The nearest f32 in metres.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "this rounding is the subject of the comparison")]
pub fn metres(position: Position) -> f32 {
    position.to_m() as f32
}

/// An f32 in metres as a position, exact to its unit of 1e-6 nm.
#[must_use]
pub fn position(metres: f32) -> Position {
    Position::from_m(f64::from(metres)).unwrap_or_default()
}

/// A block and the position along it.
#[derive(Clone, Copy, Debug)]
pub struct SinglePath {
    shape: Shape,
    /// Travel since the start; on a circle, since the start was last passed, m.
    distance: f32,
    /// How often the start was passed.
    turns: u32,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Stand([f32; AXES]),
    Line { start: [f32; AXES], direction: [f32; AXES] },
    Circle { centre: [f32; AXES], radius: f32, angle: f32, sense: f32, circumference: f32 },
}

impl SinglePath {
    /// No motion, at a point.
    #[must_use]
    pub fn standing(start: Point) -> Self {
        Self { shape: Shape::Stand(start.map(metres)), distance: 0.0, turns: 0 }
    }

    /// The start of a block at `start`; a positive arc turns from the first axis to the second.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "planned in f64, stored in f32")]
    pub fn new(block: &PathBlock, start: Point) -> Self {
        let from = start.map(Position::to_m);
        let shape = match &block.shape {
            PathShape::Dwell { .. } => Shape::Stand(start.map(metres)),
            PathShape::Line { to_m } => {
                let travel: [f64; AXES] = std::array::from_fn(|i| to_m[i] - from[i]);
                let direction = travel.map(|part| (part / length(travel)) as f32);
                Shape::Line { start: start.map(metres), direction }
            }
            PathShape::Arc { centre_m, turns, .. } => circle(from, *centre_m, turns.signum()),
            PathShape::ArcTo { centre_m, positive, .. } => {
                circle(from, *centre_m, if *positive { 1.0 } else { -1.0 })
            }
        };
        Self { shape, distance: 0.0, turns: 0 }
    }

    /// Distance along the path between two exact points of it, m.
    #[must_use]
    pub fn step_m(&self, from: Point, to: Point) -> f64 {
        let chord = 1e-9 * length(difference_nm(to, from));
        match self.shape {
            Shape::Circle { radius, .. } => {
                let diameter = 2.0 * f64::from(radius);
                let x = chord / diameter;
                // asin x: for the steps of a tick two terms are exact to 3/40·x⁴ < 1e-9, far below f32.
                if x < 1e-2 { chord * (1.0 + x * x / 6.0) } else { diameter * libm::asin(x) }
            }
            _ => chord,
        }
    }

    /// Travel since the start in turns of the circle; NaN on other shapes.
    #[must_use]
    pub fn turns(&self) -> f64 {
        match self.shape {
            Shape::Circle { circumference, .. } => {
                f64::from(self.turns) + f64::from(self.distance) / f64::from(circumference)
            }
            _ => f64::NAN,
        }
    }

    /// Advances by a step (m) and gives the point, m.
    #[expect(clippy::cast_possible_truncation, reason = "a sum in f32")]
    pub fn advance(&mut self, step_m: f64) -> [f32; AXES] {
        self.distance += step_m as f32;
        match self.shape {
            Shape::Stand(point) => point,
            Shape::Line { start, direction } => {
                std::array::from_fn(|i| start[i] + self.distance * direction[i])
            }
            Shape::Circle { centre, radius, angle, sense, circumference } => {
                if self.distance >= circumference {
                    self.distance -= circumference;
                    self.turns = self.turns.wrapping_add(1);
                }
                let (sine, cosine) = libm::sincosf(angle + sense * self.distance / radius);
                [centre[0] + radius * cosine, centre[1] + radius * sine]
            }
        }
    }
}

/// The circle about a centre (m) through a point (m); `sense` is 1 for a positive arc, −1 for a negative one.
#[expect(clippy::cast_possible_truncation, reason = "planned in f64, stored in f32")]
fn circle(from: [f64; AXES], centre: [f64; AXES], sense: f64) -> Shape {
    let [x, y] = [from[0] - centre[0], from[1] - centre[1]];
    let radius = length([x, y]);
    Shape::Circle {
        centre: centre.map(|m| m as f32),
        radius: radius as f32,
        angle: libm::atan2(y, x) as f32,
        sense: sense as f32,
        circumference: (std::f64::consts::TAU * radius) as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::motion::Motion;

    /// A distance (nm) from 1 m, rounded to f32.
    fn rounded(nm: f64) -> f64 {
        let point = Position::from_m(1.0).unwrap() + Position::from_m(1e-9 * nm).unwrap().0;
        1e9 * (f64::from(metres(point)) - 1.0)
    }

    /// The spacing of f32 is 2⁻²³ m = 119.2 nm above 1 m and half of that below; the error of rounding to
    /// nearest is at most half of it.
    #[test]
    fn at_1_m_a_position_is_rounded_to_119_nm_above_and_60_below() {
        let (above, below) = (1e9 * 2f64.powi(-23), 1e9 * 2f64.powi(-24));
        for (nm, expected) in [(59.5, 0.0), (59.7, above), (178.7, above), (-29.7, 0.0), (-29.9, -below)] {
            assert!((rounded(nm) - expected).abs() < 1e-6, "{nm}: {}", rounded(nm));
        }
        // Conversion to a position and back does not change it.
        let metre = metres(Position::from_m(1.0 + 1e-6).unwrap());
        assert!(metres(position(metre)).to_bits() == metre.to_bits());
    }

    /// 100 steps of a hundredth of a turn end at the start within 100 roundings of half a unit of 0.5 m (30 nm).
    #[test]
    fn a_circle_closes() {
        let start = Motion::Circle.start_m().map(|m| Position::from_m(m).unwrap());
        let block = &Motion::Circle.blocks(1)[1];
        let mut path = SinglePath::new(block, start);
        let step = std::f64::consts::TAU * 0.1 / 100.0;
        let points: Vec<[f32; AXES]> = (0..100).map(|_| path.advance(step)).collect();
        let distance =
            |[x, y]: [f32; AXES], [u, v]: [f64; AXES]| length([f64::from(x) - u, f64::from(y) - v]);
        assert!(
            distance(points[24], [0.0, 0.1]) < 100.0 * 30e-9
                && distance(points[49], [-0.1, 0.0]) < 100.0 * 30e-9
        );
        assert!(distance(points[99], [0.1, 0.0]) < 100.0 * 30e-9);
        assert!((path.turns() - 1.0).abs() < 5e-6);
    }

    /// Between two points of a circle the step is the arc, computed from its chord.
    #[test]
    fn a_step_is_the_arc() {
        let at = |angle: f64| [0.1 * angle.cos(), 0.1 * angle.sin()].map(|m| Position::from_m(m).unwrap());
        let path = SinglePath::new(&Motion::Circle.blocks(1)[1], at(0.0));
        for angle in [4e-4, 0.01, 0.019, 0.5] {
            let step = path.step_m(at(0.3), at(0.3 + angle));
            // The radius in f32 is within 3e-8 of 0.1 m; it enters through the small difference of arc and chord.
            assert!((step / (0.1 * angle) - 1.0).abs() < 1e-8, "{angle}: {step}");
        }
    }
}
