//! Squareness: x and y do not stand at a right angle.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings};

/// Tool x += that × table y. Reported on x, the machine's first axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Squareness {
    /// µm of x per m of y.
    pub um_per_m: f64,
}

impl Squareness {
    /// Tool − table, m, for the other axis's table position.
    #[must_use]
    pub fn offset_m(&self, other_table_m: f64) -> f64 {
        1e-6 * self.um_per_m * other_table_m
    }
}

impl Kind for Squareness {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        if around.first && around.others.len() == 1 { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.um_per_m, 5.0, 1e5)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { um_per_m: x[0] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("um_per_m", self.um_per_m)]
    }
}
