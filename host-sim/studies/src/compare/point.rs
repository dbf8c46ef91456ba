//! Points on the two axes of a comparison, and distances between them.

use shared::units::{PER_NM, Position};

/// Axes of all motions.
pub const AXES: usize = 2;

/// A position of each axis.
pub type Point = [Position; AXES];

/// The vector from the second point to the first, nm. Within the few tenths of a metre of the motions it is exact to
/// 1e-8 nm.
#[must_use]
pub fn difference_nm(a: Point, b: Point) -> [f64; AXES] {
    std::array::from_fn(|i| (a[i] - b[i]) as f64 / PER_NM as f64)
}

/// Length of a vector, in its unit.
#[must_use]
pub fn length([x, y]: [f64; AXES]) -> f64 {
    (x * x + y * y).sqrt()
}
