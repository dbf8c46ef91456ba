//! Wind-up: the drive train is softer than its declared tolerance allows.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::{Coordinate, Kind, Stage, Surroundings};
use crate::machine::Axis;

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

    /// The compliance, nm/N: the table is behind in proportion to it.
    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::scale(1e3 / self.stiffness_n_per_um, 1e-2, 1e6)]
    }

    /// A stiffness within the tolerance is a declared value, fitted.
    fn is_material(&self, declared: &Axis, _rates: Rates) -> bool {
        let tolerance = 0.01 * declared.plant_tolerance_percent.unwrap_or(0.0);
        declared
            .stiffness_n_per_um
            .is_some_and(|stiffness| self.stiffness_n_per_um < (1.0 - tolerance) * stiffness)
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { stiffness_n_per_um: 1e3 / x[0] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("stiffness_n_per_um", self.stiffness_n_per_um)]
    }
}
