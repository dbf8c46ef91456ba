//! Straightness: the guide of the other axis is bent.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings};

/// Tool += that × (table position of the source axis)².
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Straightness {
    /// µm per m².
    pub um_per_m2: f64,
    /// The axis whose guide is bent.
    pub source: String,
}

impl Straightness {
    /// Tool − table, m, for the source's table position.
    #[must_use]
    pub fn offset_m(&self, source_table_m: f64) -> f64 {
        1e-6 * self.um_per_m2 * source_table_m * source_table_m
    }
}

impl Kind for Straightness {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let start = |source: &String| Self { um_per_m2: 0.0, source: source.clone() };
        around.others.iter().map(start).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.um_per_m2, 20.0, 1e7)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { um_per_m2: x[0], ..self.clone() }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("um_per_m2", self.um_per_m2)]
    }
}
