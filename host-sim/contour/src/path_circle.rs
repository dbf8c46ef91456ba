//! The circles of a path.

/// Arcs belong to one circle if centres and radii differ by less than this fraction of the radius.
const SAME_CIRCLE_FRACTION: f64 = 1e-3;

/// Arcs of a path about the same centre with the same radius.
#[derive(Clone, Debug, PartialEq)]
pub struct PathCircle {
    /// Indices of the two axes, in ascending order.
    pub plane: [usize; 2],
    /// Centre in these axes, m.
    pub centre: [f64; 2],
    /// Radius, m.
    pub radius: f64,
    /// The arcs, in the order of the path.
    pub arcs: Vec<PathArc>,
}

/// A part of a path on a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathArc {
    /// Length of the path at its start, m.
    pub from_m: f64,
    /// Length of the path at its end, m.
    pub to_m: f64,
    /// Seen with the first axis to the right and the second up.
    pub is_clockwise: bool,
}

impl PathCircle {
    /// Adds arcs to the same circle of a list, or as a new one.
    pub(crate) fn add(circles: &mut Vec<Self>, mut circle: Self) {
        if circle.plane[0] > circle.plane[1] {
            circle.plane.swap(0, 1);
            circle.centre.swap(0, 1);
            circle.arcs.iter_mut().for_each(|arc| arc.is_clockwise = !arc.is_clockwise);
        }
        let tolerance_m = SAME_CIRCLE_FRACTION * circle.radius;
        let is_same = |other: &&mut Self| {
            let shift = [0, 1].map(|i| other.centre[i] - circle.centre[i]);
            other.plane == circle.plane
                && libm::hypot(shift[0], shift[1]) < tolerance_m
                && (other.radius - circle.radius).abs() < tolerance_m
        };
        match circles.iter_mut().find(is_same) {
            Some(same) => same.arcs.append(&mut circle.arcs),
            None => circles.push(circle),
        }
    }
}
