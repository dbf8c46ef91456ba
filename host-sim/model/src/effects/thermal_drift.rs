//! Thermal drift: the tool wanders from the table while the machine warms up.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings};

/// Tool − table grows as amplitude·(1 − exp(−t/τ)), t on the clock of the session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThermalDrift {
    /// Where the drift ends.
    pub amplitude_um: f64,
    /// τ.
    pub time_constant_s: f64,
}

impl ThermalDrift {
    /// Tool − table, m, at a time of the session.
    #[must_use]
    pub fn offset_m(&self, time_s: f64) -> f64 {
        -1e-6 * self.amplitude_um * (-time_s / self.time_constant_s).exp_m1()
    }
}

impl Kind for ThermalDrift {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn starts(_around: &Surroundings<'_>) -> Vec<Self> {
        [5.0, 20.0, 80.0, 320.0].map(|time_constant_s| Self { amplitude_um: 0.0, time_constant_s }).to_vec()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            Coordinate::signed(self.amplitude_um, 0.1, 1e4),
            Coordinate::scale(self.time_constant_s, 0.5, 5e3),
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { amplitude_um: x[0], time_constant_s: x[1] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("amplitude_um", self.amplitude_um), ("time_constant_s", self.time_constant_s)]
    }
}
