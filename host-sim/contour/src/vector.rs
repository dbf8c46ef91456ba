//! Points and vectors of up to three axes; axes that a machine lacks are zero.

/// One coordinate per axis, m.
pub type Point = [f64; 3];

/// `a − b`.
pub(crate) fn minus(a: &Point, b: &Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + factor·b`.
pub(crate) fn plus(a: &Point, factor: f64, b: &Point) -> Point {
    [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]]
}

/// Scalar product.
pub(crate) fn dot(a: &Point, b: &Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Length.
pub(crate) fn length(a: &Point) -> f64 {
    dot(a, a).sqrt()
}

/// Distance of two points.
pub(crate) fn distance(a: &Point, b: &Point) -> f64 {
    length(&minus(a, b))
}

/// The unit vector in the direction of a vector; zero if the vector is zero.
pub(crate) fn unit(a: &Point) -> Point {
    let length = length(a);
    if length > 0.0 { a.map(|value| value / length) } else { [0.0; 3] }
}
