//! Friction that depends on the direction of travel.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings};

/// Viscous friction b + h for v > 0 and b − h for v < 0.
///
/// A difference of Coulomb friction is, while the axis moves, a constant load, and is called that.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionAsymmetry {
    /// h.
    pub half_difference_n_s_per_m: f64,
}

impl FrictionAsymmetry {
    /// Force (N) on top of symmetric viscous friction: h·|v|, the same way for both directions.
    #[must_use]
    #[inline]
    pub fn force_n(&self, velocity_m_per_s: f64) -> f64 {
        self.half_difference_n_s_per_m * velocity_m_per_s.abs()
    }
}

impl Kind for FrictionAsymmetry {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Table, Stage::Motor]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        if around.axis.has_mass() { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.half_difference_n_s_per_m, 5.0, 1e5)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { half_difference_n_s_per_m: x[0] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("half_difference_n_s_per_m", self.half_difference_n_s_per_m)]
    }
}
