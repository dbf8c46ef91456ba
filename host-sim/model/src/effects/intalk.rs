//! In-talk: the structure leans when its own axis accelerates.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings};

/// Tool − table per acceleration of the same axis, after Nguyen, Weikert, Wegener, equations (7) to (9).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Intalk {
    /// µm per m/s².
    pub um_s2_per_m: f64,
}

impl Intalk {
    /// Tool − table, m, for the table's acceleration.
    #[must_use]
    pub fn offset_m(&self, acceleration_m_per_s2: f64) -> f64 {
        1e-6 * self.um_s2_per_m * acceleration_m_per_s2
    }
}

impl Kind for Intalk {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn starts(_around: &Surroundings<'_>) -> Vec<Self> {
        vec![Self::default()]
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.um_s2_per_m, 0.1, 1e3)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { um_s2_per_m: x[0] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("um_s2_per_m", self.um_s2_per_m)]
    }
}
