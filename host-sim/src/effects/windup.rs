//! Wind-up: the drive train is softer than its declared tolerance allows.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings};

/// Takes the place of the declared stiffness between motor and table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Windup {
    /// The true stiffness.
    pub stiffness_n_per_um: f64,
}

impl Kind for Windup {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Force, Stage::Motor]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let declared = around.axis.stiffness_n_per_um;
        let start = |stiffness: f64| Self { stiffness_n_per_um: 0.8 * stiffness };
        declared.into_iter().map(start).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        let k = self.stiffness_n_per_um;
        vec![Coordinate::between(k, 0.02 * k, 1e-3, 1e5)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { stiffness_n_per_um: x[0] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("stiffness_n_per_um", self.stiffness_n_per_um)]
    }
}
