//! A lap through simulated points.

use contour::circular_test::Lap;

use crate::reproduce::study::ReproduceError;

/// [`Lap::from_path`].
///
/// # Errors
/// If there are no points, or a coordinate is not finite.
pub fn lap(path_m: &[[f64; 2]], radius_m: f64) -> Result<Lap, ReproduceError> {
    let no_points = || ReproduceError::Numerics("a circular path without finite points".to_owned());
    Lap::from_path(path_m, radius_m).ok_or_else(no_points)
}
