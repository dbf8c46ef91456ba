//! Wind-up: the drive train is softer than its declared tolerance allows.

use serde::{Deserialize, Serialize};
use shared::config::Rates;

use super::{Coordinate, Kind, Stage, Surroundings};
use crate::axis::Settings;

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
    /// Travel over which that friction turns round at a reversal (Dahl, 1968). Absent: at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub presliding_mm: Option<f64>,
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
            let start = |presliding_mm| Self {
                stiffness_n_per_um: 1.0 / LEAST_COMPLIANCE,
                friction_n: Some(0.0),
                presliding_mm,
            };
            return [None, Some(0.03), Some(0.3)].map(start).to_vec();
        }
        let start = |stiffness: f64| Self {
            stiffness_n_per_um: 0.8 * stiffness,
            friction_n: None,
            presliding_mm: None,
        };
        axis.mechanics.stiffness_n_per_um.into_iter().map(start).collect()
    }

    /// The compliance, nm/N: the table is behind in proportion to it.
    fn coordinates(&self) -> Vec<Coordinate> {
        let compliance = Coordinate::scale(1e3 / self.stiffness_n_per_um, 1e-2, 1e6);
        match self.friction_n {
            None => vec![compliance],
            // What friction keeps from the table, in which the model is linear as it is in the compliance.
            Some(friction_n) => {
                let per_um = 1.0 / self.stiffness_n_per_um;
                let turn = self.presliding_mm.map(|mm| Coordinate::scale(mm, 1e-3, 10.0));
                // As good as rigid is where the effect ends, not where its search does.
                let per_um = Coordinate::between(per_um, 0.01, LEAST_COMPLIANCE, MOST_COMPLIANCE);
                [
                    Coordinate { limits: [f64::NEG_INFINITY, MOST_COMPLIANCE], ..per_um },
                    Coordinate::between(friction_n * per_um.value, 0.1, 0.0, 1e4),
                ]
                .into_iter()
                .chain(turn)
                .collect()
            }
        }
    }

    /// A stiffness within the tolerance is a declared value, fitted; a drive train as good as rigid is not wound up:
    /// what remains of this effect is then friction without a force.
    fn is_material(&self, declared: &Settings, _rates: Rates) -> bool {
        if self.friction_n.is_some() {
            return 1.0 / self.stiffness_n_per_um > 10.0 * LEAST_COMPLIANCE;
        }
        let tolerance = 0.01 * declared.mechanics.plant_tolerance_percent.unwrap_or(0.0);
        declared
            .mechanics
            .stiffness_n_per_um
            .is_some_and(|stiffness| self.stiffness_n_per_um < (1.0 - tolerance) * stiffness)
    }

    fn at(&self, x: &[f64]) -> Self {
        match self.friction_n {
            None => Self { stiffness_n_per_um: 1e3 / x[0], ..self.clone() },
            Some(_) => Self {
                stiffness_n_per_um: 1.0 / x[0],
                friction_n: Some(x[1] / x[0]),
                presliding_mm: self.presliding_mm.and_then(|_| x.get(2).copied()),
            },
        }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        let friction = self.friction_n.map(|friction_n| ("friction_n", friction_n));
        let presliding = self.presliding_mm.map(|presliding_mm| ("presliding_mm", presliding_mm));
        [("stiffness_n_per_um", self.stiffness_n_per_um)]
            .into_iter()
            .chain(friction)
            .chain(presliding)
            .collect()
    }
}

/// As good as rigid, µm/N.
const LEAST_COMPLIANCE: f64 = 1e-6;

/// A millimetre a newton is no drive train, µm/N.
const MOST_COMPLIANCE: f64 = 1e3;
