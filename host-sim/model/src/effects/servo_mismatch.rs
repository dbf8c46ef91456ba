//! Servo mismatch: the position gain in the drive is not the declared one.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::{Coordinate, Kind, Stage, Surroundings};
use crate::axis::Settings;

/// True Kp = declared Kp · (1 + percent/100).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServoMismatch {
    /// How far the true gain lies above the declared one.
    pub percent: f64,
}

impl ServoMismatch {
    /// True over declared gain.
    #[must_use]
    pub fn factor(&self) -> f64 {
        1.0 + 0.01 * self.percent
    }
}

impl Kind for ServoMismatch {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let sees_motor = around.stages.contains(&Stage::Motor);
        if sees_motor { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.percent, 0.2, 80.0)]
    }

    /// A quarter of a percent: how a drive steps its filters makes as much.
    fn is_material(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.percent.abs() > 0.25
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { percent: x[0] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("percent", self.percent)]
    }
}
