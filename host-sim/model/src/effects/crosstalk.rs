//! Cross-talk: the tool leans when the other axis accelerates.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings};

/// Tool − table per acceleration of another axis, after Nguyen, Weikert, Wegener, equations (7) to (9).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Crosstalk {
    /// µm per m/s².
    pub um_s2_per_m: f64,
    /// The axis whose table accelerates.
    pub source: String,
}

impl Crosstalk {
    /// Tool − table, m, for the source's table acceleration.
    #[must_use]
    pub fn offset_m(&self, source_acceleration_m_per_s2: f64) -> f64 {
        1e-6 * self.um_s2_per_m * source_acceleration_m_per_s2
    }
}

impl Kind for Crosstalk {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let start = |source: &String| Self { um_s2_per_m: 0.0, source: source.clone() };
        around.others.iter().map(start).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.um_s2_per_m, 0.1, 1e3)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { um_s2_per_m: x[0], ..self.clone() }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("um_s2_per_m", self.um_s2_per_m)]
    }
}
