//! Vectors along x, y and z.

use super::component::Axis;

/// The unit vector of a direction.
#[must_use]
pub const fn unit(axis: Axis) -> [f64; 3] {
    let mut vector = [0.0; 3];
    vector[axis as usize] = 1.0;
    vector
}

/// The vector product.
#[must_use]
pub const fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The scalar product.
#[must_use]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
