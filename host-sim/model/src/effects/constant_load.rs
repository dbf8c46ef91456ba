//! Constant load: gravity, a counterbalance, or a difference of Coulomb friction while moving.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings};

/// A constant force on the table that opposes motion in the + direction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantLoad {
    /// Positive: the drive pushes harder in the + direction.
    pub force_n: f64,
}

impl Kind for ConstantLoad {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Table, Stage::Motor]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        if around.axis.has_mass() { vec![Self { force_n: 0.0 }] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.force_n, 1.0, 1e5)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { force_n: x[0] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("force_n", self.force_n)]
    }
}
