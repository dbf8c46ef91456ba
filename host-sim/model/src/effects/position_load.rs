//! Position load: a force that grows along the travel, as that of a cable chain, a spring or a bellows.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Neighbours, Occurrence, Parameter,
    Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// A force slope·(x − centre) + curvature·(x − centre)² on the table against motion in the + direction.
///
/// The force at the centre is zero: a force there is a [`ConstantLoad`](super::ConstantLoad). Both together describe a
/// force of any value at any position, and each of them is determined.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionLoad {
    /// Slope; positive: the force opposes motion away from the centre, as a spring does.
    pub slope_n_per_m: f64,
    /// Position at which the force is zero. Not fitted: the zero of the axis.
    #[serde(default)]
    pub centre_mm: f64,
    /// Curvature; absent: the force grows in proportion to the distance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curvature_n_per_m2: Option<f64>,
}

impl PositionLoad {
    /// Force, N, at a position.
    #[must_use]
    #[inline]
    pub fn force_n(&self, position_m: f64) -> f64 {
        let from_centre_m = position_m - 1e-3 * self.centre_mm;
        from_centre_m * (self.slope_n_per_m + from_centre_m * self.curvature_n_per_m2.unwrap_or(0.0))
    }
}

impl EffectModel for PositionLoad {
    const NAME: &'static str = "position_load";
    const SUMMARY: &'static str = "force slope·(x − c) + curvature·(x − c)² against motion in + direction; zero at c, which is not fitted: a force there is a `constant_load`";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("slope_n_per_m", Unit::NewtonPerMetre, Range::Signed),
        Parameter::new("centre_mm", Unit::Millimetre, Range::Signed),
        Parameter::new("curvature_n_per_m2", Unit::NewtonPerSquareMetre, Range::Signed),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force, Stage::Table];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::masses(axis)
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Table, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let curvatures: &[Option<f64>] = if context.axis.has_mass() { &[None, Some(0.0)] } else { &[] };
        let guess = |&curvature_n_per_m2| Self { curvature_n_per_m2, ..Self::default() };
        curvatures.iter().map(guess).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        let slope = Coordinate::signed(self.slope_n_per_m, 5.0, 1e7);
        let curvature = self.curvature_n_per_m2.map(|value| Coordinate::signed(value, 50.0, 1e9));
        std::iter::once(slope).chain(curvature).collect()
    }

    fn at(&self, x: &[f64]) -> Self {
        let curvature_n_per_m2 = self.curvature_n_per_m2.map(|old| x.get(1).copied().unwrap_or(old));
        Self { slope_n_per_m: x[0], curvature_n_per_m2, ..self.clone() }
    }

    fn values(&self) -> Vec<f64> {
        [self.slope_n_per_m, self.centre_mm].into_iter().chain(self.curvature_n_per_m2).collect()
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::LOAD
    }

    fn sentence(&self, wording: &Wording) -> String {
        let size = match self.curvature_n_per_m2 {
            None => format!("a slope of {}", wording.value(0)),
            Some(_) => format!("a slope of {} and a curvature of {}", wording.value(0), wording.value(2)),
        };
        format!("a force on the table grows along the travel, with {size} from {}", wording.value(1))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Position
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_is_a_parabola_about_the_centre() {
        let load =
            |curvature_n_per_m2| PositionLoad { slope_n_per_m: 200.0, centre_mm: 50.0, curvature_n_per_m2 };
        // 30 mm from the centre: 200·0.03 = 6 N and 1000·0.03² = 0.9 N, of which only the first changes its sign.
        assert!((load(None).force_n(0.08) - 6.0).abs() < 1e-12);
        assert!((load(Some(1000.0)).force_n(0.08) - 6.9).abs() < 1e-12);
        assert!((load(Some(1000.0)).force_n(0.02) + 5.1).abs() < 1e-12);
    }
}
