//! Stribeck effect: friction rises towards standstill.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::{Coordinate, Kind, Stage, Surroundings};
use crate::friction_law::gaussian_decay;
use crate::machine::Axis;

/// Adds excess·exp(−(v/vs)²) to the sliding level of Coulomb friction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stribeck {
    /// Friction at standstill above Coulomb friction.
    pub static_excess_n: f64,
    /// vs.
    pub velocity_mm_s: f64,
}

impl Default for Stribeck {
    /// No excess; the velocity is where lubricated guides usually have theirs.
    fn default() -> Self {
        Self { static_excess_n: 0.0, velocity_mm_s: 5.0 }
    }
}

impl Stribeck {
    /// Rise of the sliding level (N, not negative for a positive excess) at a velocity.
    #[must_use]
    #[inline]
    pub fn rise_n(&self, velocity_m_per_s: f64) -> f64 {
        if self.static_excess_n == 0.0 {
            return 0.0;
        }
        let ratio = 1e3 * velocity_m_per_s / self.velocity_mm_s;
        self.static_excess_n * gaussian_decay(ratio)
    }
}

impl Kind for Stribeck {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Table, Stage::Motor]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let speeds: &[f64] = if around.axis.has_mass() { &[2.0, 8.0, 30.0] } else { &[] };
        let start = |&velocity_mm_s: &f64| Self { static_excess_n: 0.0, velocity_mm_s };
        speeds.iter().map(start).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            Coordinate::between(self.static_excess_n, 2.0, 0.0, 1e5),
            Coordinate::scale(self.velocity_mm_s, 0.1, 300.0),
        ]
    }

    /// Slower than this bristles bend and a sign is smooth: it is presliding that differs, not the sliding level.
    fn is_material(&self, _declared: &Axis, _rates: Rates) -> bool {
        self.velocity_mm_s > 0.5
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { static_excess_n: x[0], velocity_mm_s: x[1] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("static_excess_n", self.static_excess_n), ("velocity_mm_s", self.velocity_mm_s)]
    }
}
