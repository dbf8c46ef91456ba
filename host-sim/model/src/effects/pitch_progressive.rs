//! Progressive pitch error: the screw's mean lead is not the nominal one.

use serde::{Deserialize, Serialize};
use shared::config::Rates;

use super::{Coordinate, Kind, Stage, Surroundings};
use crate::axis::Settings;

/// The screw moves the table (1 + slope) times the motor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PitchProgressive {
    /// Slope.
    pub slope_um_per_m: f64,
}

impl PitchProgressive {
    /// How much further than nominal the screw carries the table, m.
    #[must_use]
    #[inline]
    pub fn error_m(&self, motor_m: f64) -> f64 {
        1e-6 * self.slope_um_per_m * motor_m
    }
}

impl Kind for PitchProgressive {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let sees_table = around.stages.contains(&Stage::Table);
        if sees_table { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.slope_um_per_m, 5.0, 1e5)]
    }

    /// A twentieth of a degree makes half a micrometre of a metre of steel.
    fn is_material(&self, _declared: &Settings, _rates: Rates) -> bool {
        const LEAST_UM_PER_M: f64 = 0.5;
        self.slope_um_per_m.abs() > LEAST_UM_PER_M
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { slope_um_per_m: x[0] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("slope_um_per_m", self.slope_um_per_m)]
    }
}
