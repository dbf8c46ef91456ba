//! The figures of a contour error.

use contour::ContourError;
use schemars::JsonSchema;
use serde::Serialize;

/// How large a contour error is, µm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Sizes {
    /// Root mean square over time.
    pub rms: f64,
    /// Greatest distance from the path.
    pub max: f64,
    /// Circular deviation G of the largest full circle (ISO 230-4); `None` without a full circle.
    #[serde(rename = "G")]
    pub circular: Option<f64>,
    /// Largest deviation at a corner: overshoot or rounding; `None` without a corner.
    pub corner: Option<f64>,
}

impl Sizes {
    /// The figures of a contour error.
    #[must_use]
    pub fn of(error: &ContourError) -> Self {
        let at_corner =
            |corner: &contour::corner::CornerDeviation| corner.overshoot_um.max(corner.rounding_um);
        Self {
            rms: error.rms_um,
            max: error.max_um,
            circular: error.circular_um(),
            corner: error.corners.iter().map(at_corner).reduce(f64::max),
        }
    }

    /// Each figure from those of two sizes.
    #[must_use]
    pub fn combined(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        let both = |a: Option<f64>, b: Option<f64>| Some(of(a?, b?));
        Self {
            rms: of(self.rms, other.rms),
            max: of(self.max, other.max),
            circular: both(self.circular, other.circular),
            corner: both(self.corner, other.corner),
        }
    }
}
