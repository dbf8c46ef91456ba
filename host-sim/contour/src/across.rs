//! What a displacement of the tool, or noise in its reading, adds to the mean square of the contour error.
//!
//! Only the part across the path counts: of a displacement d, P·d with P = I − t·tᵀ at the direction of travel t. Beyond an end of
//! the path and outside a corner all of it counts, P = I. With the error vectors e, which lie across the path, P·e = e, the least
//! squares of e − P·d over the path give N·d = mean e with N = mean P. In them a sample counts by the travel of the command since the last one, not
//! at all before the motion has settled: two logs of one motion begin, slow down and stand for different times at its ends, where the
//! error is another.

use nalgebra::{Matrix3, Vector3};

use super::path::Nearest;
use super::vector::{Point, dot, length, minus};

/// Largest part of an error vector along the path that is due to the samples of a bent path: beyond, the tool is outside a corner.
const MAX_ALONG: f64 = 0.05;

/// Smallest ratio of the eigenvalues of N: on a line, the displacement along it is unknown.
const MIN_EIGENVALUE_RATIO: f64 = 1e-3;

/// Running sums of error vectors and of P.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AcrossSum {
    error_m: Vector3<f64>,
    projection: Matrix3<f64>,
    path_projection: Matrix3<f64>,
    samples: u64,
}

impl AcrossSum {
    /// The tool, m, with the point of the path nearest to it, of which only the first `axes` coordinates are used, and the travel by which it
    /// counts for the displacement, m.
    pub fn add(&mut self, tool: &Point, nearest: &Nearest, (axes, travel_m): (usize, f64)) {
        let offset = minus(tool, &nearest.point);
        let is_outside = dot(&offset, &nearest.tangent).abs() > MAX_ALONG * length(&offset);
        let tangent = Vector3::from(if is_outside || axes == 1 { [0.0; 3] } else { nearest.tangent });
        let whole = Matrix3::from_diagonal(&Vector3::from_fn(|i, _| if i < axes { 1.0 } else { 0.0 }));
        let projection = whole - tangent * tangent.transpose();
        self.projection += projection;
        self.samples += 1;
        self.error_m += travel_m * Vector3::from(offset);
        self.path_projection += travel_m * projection;
    }

    /// The means over the samples.
    pub fn finish(&self) -> Across {
        let samples = self.samples.max(1) as f64;
        Across {
            error_um: 1e6 * self.error_m / samples,
            projection: self.projection / samples,
            path_projection: self.path_projection / samples,
        }
    }
}

/// The means of the error vectors and of the part of a displacement that counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Across {
    /// Mean of the vectors from the path to the tool times the travel, one coordinate per axis, µm·m.
    error_um: Vector3<f64>,
    /// N.
    projection: Matrix3<f64>,
    /// Mean of P times the travel, m.
    path_projection: Matrix3<f64>,
}

impl Across {
    /// Constant displacement of the tool that describes the errors best, one coordinate per axis, µm; zero in directions in which
    /// the path shows none.
    #[must_use]
    pub fn displacement_um(&self) -> [f64; 3] {
        let eigen = self.path_projection.symmetric_eigen();
        // Positive, so that a log without motion has no direction at all.
        let largest = eigen.eigenvalues.max().max(f64::MIN_POSITIVE);
        let terms = (0..3).filter(|&i| eigen.eigenvalues[i] > MIN_EIGENVALUE_RATIO * largest).map(|i| {
            let vector = eigen.eigenvectors.column(i).into_owned();
            vector * (vector.dot(&self.error_um) / eigen.eigenvalues[i])
        });
        terms.sum::<Vector3<f64>>().into()
    }

    /// What a displacement by `more_um` adds to the mean square if the tool is displaced by `from_um` already, µm².
    #[must_use]
    pub fn added_um2(&self, from_um: [f64; 3], more_um: [f64; 3]) -> f64 {
        let [from, more] = [from_um, more_um].map(Vector3::from);
        (2.0 * from + more).dot(&(self.projection * more))
    }

    /// Deviation across the path of noise with these deviations along the axes; all in one unit.
    #[must_use]
    pub fn deviation(&self, of_axes: [f64; 3]) -> f64 {
        let squares = Vector3::from(of_axes).map(|deviation| deviation * deviation);
        self.projection.diagonal().dot(&squares).max(0.0).sqrt()
    }

    /// The means over the samples of two parts, with the numbers of their samples.
    #[must_use]
    pub(crate) fn merged([(one, of_one), (other, of_other)]: [(&Self, u64); 2]) -> Self {
        let share = of_one as f64 / (of_one + of_other).max(1) as f64;
        Self {
            error_um: share * one.error_um + (1.0 - share) * other.error_um,
            projection: share * one.projection + (1.0 - share) * other.projection,
            path_projection: share * one.path_projection + (1.0 - share) * other.path_projection,
        }
    }
}
