//! Wind-up: the drive train is softer than its declared tolerance allows.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings};

/// Takes the place of the declared stiffness between motor and table; on an axis without declared masses the measured
/// force winds the drive train.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Windup {
    /// The true stiffness.
    pub stiffness_n_per_um: f64,
    /// Friction that the measured force loses before it winds anything: of the motor and of what is in front of the
    /// gear. Absent where masses are declared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_n: Option<f64>,
}

impl Windup {
    /// How far the table stays behind the motor, µm, under a measured force; `way` is −1 to 1, the direction of travel.
    #[must_use]
    pub fn stretch_um(&self, force_n: f64, way: f64) -> f64 {
        (force_n - self.friction_n.unwrap_or(0.0) * way) / self.stiffness_n_per_um
    }
}

impl Kind for Windup {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Force, Stage::Motor]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let axis = around.axis;
        if !axis.has_mass() && around.stages.contains(&Stage::Table) {
            return vec![Self { stiffness_n_per_um: 1.0 / LEAST_COMPLIANCE, friction_n: Some(0.0) }];
        }
        let start = |stiffness: f64| Self { stiffness_n_per_um: 0.8 * stiffness, friction_n: None };
        axis.stiffness_n_per_um.into_iter().map(start).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        let k = self.stiffness_n_per_um;
        match self.friction_n {
            None => vec![Coordinate::between(k, 0.02 * k, 1e-3, 1e5)],
            // Compliance, and what friction keeps from the table: the model is linear in both.
            Some(friction_n) => vec![
                Coordinate::between(1.0 / k, 0.01, LEAST_COMPLIANCE, 1e3),
                Coordinate::between(friction_n / k, 0.1, 0.0, 1e4),
            ],
        }
    }

    fn at(&self, x: &[f64]) -> Self {
        match self.friction_n {
            None => Self { stiffness_n_per_um: x[0], friction_n: None },
            Some(_) => Self { stiffness_n_per_um: 1.0 / x[0], friction_n: Some(x[1] / x[0]) },
        }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        let friction = self.friction_n.map(|friction_n| ("friction_n", friction_n));
        [("stiffness_n_per_um", self.stiffness_n_per_um)].into_iter().chain(friction).collect()
    }
}

/// As good as rigid, µm/N.
const LEAST_COMPLIANCE: f64 = 1e-6;
