//! Shear thinning: a lubricant's friction rises with speed, and saturates.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings};
use crate::friction_law::exponential_decay;

/// Of the declared sliding level `force_n` is what it takes to shear the lubricant, whose viscosity falls
/// with the rate of shear: at standstill it is not there, and with speed it comes as 1 − exp(−|v|/vs).
///
/// The opposite of the Stribeck effect: the level is Coulomb friction − force·exp(−|v|/vs).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShearThinning {
    /// What the level lacks at standstill.
    pub force_n: f64,
    /// vs.
    pub velocity_mm_s: f64,
}

impl Default for ShearThinning {
    fn default() -> Self {
        Self { force_n: 0.0, velocity_mm_s: 10.0 }
    }
}

impl ShearThinning {
    /// By how much (N) the sliding level lies below that at speed.
    #[must_use]
    #[inline]
    pub fn lack_n(&self, velocity_m_per_s: f64) -> f64 {
        if self.force_n == 0.0 {
            return 0.0;
        }
        self.force_n * exponential_decay(1e3 * velocity_m_per_s / self.velocity_mm_s)
    }
}

impl Kind for ShearThinning {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let speeds: &[f64] = if around.shows_friction_alone() { &[3.0, 12.0, 50.0] } else { &[] };
        speeds.iter().map(|&velocity_mm_s| Self { force_n: 0.0, velocity_mm_s }).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            Coordinate::between(self.force_n, 2.0, 0.0, 1e5),
            Coordinate::between(self.velocity_mm_s, 0.05 * self.velocity_mm_s, 0.1, 300.0),
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { force_n: x[0], velocity_mm_s: x[1] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("force_n", self.force_n), ("velocity_mm_s", self.velocity_mm_s)]
    }
}
